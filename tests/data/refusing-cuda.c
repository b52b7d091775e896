// A driver of CUDA whose start is refused, as where a process may not open the device's files.
#define STUB(name) int name(void) { return 304; }

STUB(cuInit) STUB(cuDeviceGetCount) STUB(cuDeviceGet) STUB(cuDeviceGetName) STUB(cuDeviceGetAttribute)
STUB(cuDevicePrimaryCtxRetain) STUB(cuCtxSetCurrent) STUB(cuModuleLoadData) STUB(cuModuleGetFunction)
STUB(cuMemAlloc_v2) STUB(cuMemFree_v2) STUB(cuMemcpyHtoD_v2) STUB(cuMemcpyDtoH_v2) STUB(cuLaunchKernel)
int cuGetErrorString(int code, const char **text) {
    *text = "OS call failed or operation not supported on this OS";
    return 0;
}
