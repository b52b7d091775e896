// CUDA C++ without headers, as NVRTC compiles it.
typedef double real;
typedef unsigned int u32;
typedef unsigned long long u64;
#define GLOBAL
#define FN static __device__
#define SQUARE_ROOT(x) __dsqrt_rn(x)
#define MAGNITUDE(x) fabs((real)(x))
#define WITH_SIGN(x, sign) copysign((real)(x), (real)(sign))
#define COUNT_ONES(x) ((u32)__popc(x))
#define SINGLE_SQUARE_ROOT(x) __fsqrt_rn(x)
#define SINGLE_MAGNITUDE(x) fabsf(x)
#define SINGLE_WITH_SIGN(x, sign) copysignf(x, sign)
#define FUSED(a, factor, addend) __fmaf_rn(a, factor, addend)
#define INFINITE __longlong_as_double(0x7FF0000000000000LL)
