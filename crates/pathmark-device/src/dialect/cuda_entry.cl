
// Four groups of 128 items fit on a multiprocessor: each item has 128 registers.
extern "C" __global__ void __launch_bounds__(128, 4) pathmark_run(const real *numbers, const u32 *words, const u32 *task, u32 items, u64 *out) {
    u32 item = blockIdx.x * blockDim.x + threadIdx.x;
    if (item < items) run_item(item, numbers, words, task, out);
}
