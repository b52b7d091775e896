
__kernel void pathmark_run(__global const real *numbers, __global const u32 *words, __global const u32 *task, u32 items,
    __global u64 *out) {
    u32 item = (u32)get_global_id(0);
    if (item < items) run_item(item, numbers, words, task, out);
}
