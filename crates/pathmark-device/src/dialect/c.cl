// C of 1999: for the host's compiler.
#include <stdint.h>
#include <string.h>
typedef double real;
typedef uint32_t u32;
typedef uint64_t u64;
#define GLOBAL
#define FN static inline
#define SQUARE_ROOT(x) __builtin_sqrt(x)
#define MAGNITUDE(x) __builtin_fabs(x)
#define WITH_SIGN(x, sign) __builtin_copysign(x, sign)
#define COUNT_ONES(x) ((u32)__builtin_popcount(x))
#define INFINITE ((real)__builtin_inf())
