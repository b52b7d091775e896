
void pathmark_run(const void *const *inputs, const u32 *task, u32 items, u64 *out) {
    for (u32 item = 0; item < items; item++)
        run_item(item, (const real *)inputs[0], (const u32 *)inputs[1], task, out);
}
