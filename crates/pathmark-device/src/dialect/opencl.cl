// OpenCL C 1.2.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
typedef double real;
typedef uint u32;
typedef ulong u64;
#define GLOBAL __global
#define FN static
#define SQUARE_ROOT(x) sqrt((real)(x))
#define MAGNITUDE(x) fabs((real)(x))
#define WITH_SIGN(x, sign) copysign((real)(x), (real)(sign))
#define COUNT_ONES(x) popcount((u32)(x))
#define SINGLE_SQUARE_ROOT(x) sqrt((float)(x))
#define SINGLE_MAGNITUDE(x) fabs((float)(x))
#define SINGLE_WITH_SIGN(x, sign) copysign((float)(x), (float)(sign))
#define FUSED(a, factor, addend) fma((float)(a), (float)(factor), (float)(addend))
#define INFINITE ((real)INFINITY)
