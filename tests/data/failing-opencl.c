// An OpenCL loader that hands every call to the one that PATHMARK_TEST_OPENCL names, until it fails on purpose: a launch after
// PATHMARK_TEST_LAUNCHES of them, as if the device were lost, and a buffer of more than PATHMARK_TEST_BYTES, as if its memory were full.
#include <dlfcn.h>
#include <stdlib.h>

typedef unsigned u;
typedef unsigned long ul;
typedef void *h;

static void *found(const char *name) {
    static void *library;
    if (!library) library = dlopen(getenv("PATHMARK_TEST_OPENCL"), RTLD_NOW);
    return library ? dlsym(library, name) : 0;
}
static ul limit(const char *name) { return getenv(name) ? strtoul(getenv(name), 0, 10) : ~0UL; }

#define HAND_ON(result, name, parameters, arguments, refusal)              \
    result name parameters {                                               \
        static result(*next) parameters;                                   \
        if (!next) next = (result(*) parameters)found(#name);              \
        refusal;                                                           \
        return next arguments;                                             \
    }

static ul launches;

HAND_ON(int, clGetPlatformIDs, (u a, h *b, u *c), (a, b, c), )
HAND_ON(int, clGetDeviceIDs, (h a, ul b, u c, h *d, u *e), (a, b, c, d, e), )
HAND_ON(int, clGetDeviceInfo, (h a, u b, ul c, h d, ul *e), (a, b, c, d, e), )
HAND_ON(h, clCreateContext, (h a, u b, h c, h d, h e, int *f), (a, b, c, d, e, f), )
HAND_ON(h, clCreateCommandQueue, (h a, h b, ul c, int *d), (a, b, c, d), )
HAND_ON(h, clCreateProgramWithSource, (h a, u b, h c, h d, int *e), (a, b, c, d, e), )
HAND_ON(int, clBuildProgram, (h a, u b, h c, h d, h e, h f), (a, b, c, d, e, f), )
HAND_ON(int, clGetProgramBuildInfo, (h a, h b, u c, ul d, h e, ul *f), (a, b, c, d, e, f), )
HAND_ON(h, clCreateKernel, (h a, h b, int *c), (a, b, c), )
HAND_ON(h, clCreateBuffer, (h a, ul b, ul c, h d, int *e), (a, b, c, d, e),
    if (c > limit("PATHMARK_TEST_BYTES")) { *e = -4; return 0; })
HAND_ON(int, clSetKernelArg, (h a, u b, ul c, h d), (a, b, c, d), )
HAND_ON(int, clEnqueueNDRangeKernel, (h a, h b, u c, h d, h e, h f, u g, h i, h j), (a, b, c, d, e, f, g, i, j),
    if (launches++ >= limit("PATHMARK_TEST_LAUNCHES")) return -36)
HAND_ON(int, clEnqueueWriteBuffer, (h a, h b, u c, ul d, ul e, h f, u g, h i, h j), (a, b, c, d, e, f, g, i, j), )
HAND_ON(int, clEnqueueReadBuffer, (h a, h b, u c, ul d, ul e, h f, u g, h i, h j), (a, b, c, d, e, f, g, i, j), )
HAND_ON(int, clReleaseMemObject, (h a), (a), )
HAND_ON(int, clReleaseKernel, (h a), (a), )
