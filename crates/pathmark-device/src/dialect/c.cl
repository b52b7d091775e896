// C99, for the host's compiler.
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
#define SINGLE_SQUARE_ROOT(x) __builtin_sqrtf(x)
#define SINGLE_MAGNITUDE(x) __builtin_fabsf(x)
#define SINGLE_WITH_SIGN(x, sign) __builtin_copysignf(x, sign)
#define FUSED(a, factor, addend) __builtin_fmaf(a, factor, addend)
#define INFINITE ((real)__builtin_inf())
