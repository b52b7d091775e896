// Sums of samples: `film/sum.rs`. An item is a pixel and a run of its samples; their sum is a subtree of the film's sum.

typedef struct { exact sum[3], square[3]; } pixel_sum;

FN void clear_sum(pixel_sum *p) {
    for (int channel = 0; channel < 3; channel++) p->sum[channel] = p->square[channel] = 0;
}
FN int is_valid_radiance(const exact *channels) {
    for (int channel = 0; channel < 3; channel++)
        if (!(channels[channel] >= 0 && channels[channel] < INFINITE)) return 0;
    return 1;
}
FN void add_sample(pixel_sum *p, const exact *channels) {
    for (int channel = 0; channel < 3; channel++) {
        p->sum[channel] += channels[channel];
        p->square[channel] += channels[channel] * channels[channel];
    }
}
// Adds `earlier` and `later`, in this order.
FN void add_later(const pixel_sum *earlier, pixel_sum *later) {
    for (int channel = 0; channel < 3; channel++) {
        later->sum[channel] = earlier->sum[channel] + later->sum[channel];
        later->square[channel] = earlier->square[channel] + later->square[channel];
    }
}

FN u64 first_item(GLOBAL const u32 *piece) {
    return ((u64)piece[PIECE_FIRST_ITEM + 1] << 32) | (u64)piece[PIECE_FIRST_ITEM];
}

FN void run_item(u32 item, GLOBAL const stored *numbers, GLOBAL const u32 *words, GLOBAL const u32 *task, GLOBAL u64 *out) {
    scene s = scene_of(numbers, words);
    u64 place = (((u64)task[TASK_FIRST_ITEM + 1] << 32) | (u64)task[TASK_FIRST_ITEM]) + (u64)item;
    // Finds the last piece that begins at or before `place`.
    GLOBAL const u32 *piece = task + TASK_TABLE;
    u32 low = 0, high = task[TASK_PIECES];
    while (high - low > 1U) {
        u32 middle = low + (high - low) / 2U;
        if (first_item(piece + PIECE_WORDS * middle) <= place) low = middle;
        else high = middle;
    }
    piece += PIECE_WORDS * low;
    place -= first_item(piece);
    u32 pixel = (u32)(place / (u64)piece[PIECE_PARTS]), part_samples = task[TASK_PART_SAMPLES];
    u32 x = piece[PIECE_X] + pixel % piece[PIECE_COLUMNS], y = piece[PIECE_Y] + pixel / piece[PIECE_COLUMNS];
    u32 sample = piece[PIECE_FIRST_SAMPLE] + (u32)(place % (u64)piece[PIECE_PARTS]) * part_samples;
    u32 end = piece[PIECE_END_SAMPLE];
    if (end - sample > part_samples) end = sample + part_samples;
    walk w;
    w.s = &s;
    w.max_depth = words[AT_MAX_DEPTH];
    w.roulette_by = words[AT_ROULETTE];
    w.roulette_after = words[AT_ROULETTE + 1];
    w.roulette_chance = (real)numbers[VIEW_ROULETTE];
    w.is_weighted = words[AT_IS_WEIGHTED] != 0U;
    events e;
    e.rays = e.invalid = e.escaped = e.truncated = e.tested.boxes = e.tested.primitives = 0UL;
    pixel_sum block, subtrees[LEVELS];
    clear_sum(&block);
    u32 in_block = 0, blocks = 0;
    // Neighbours take the same step at the same time. If an item's path ends, it begins its next sample and does not wait for longer paths.
    sample_key key;
    w.key = &key;
    path p;
    exact channels[3];
#if HAS_CAMERA_RAYS
    rgb seen = grey(0.0);
#endif
    int goes_on = 0;
    for (;;) {
        if (!goes_on) {
            if (sample == end) break;
            key = key_of(words, y * words[AT_WIDTH] + x, sample);
            begin(&p, camera_ray(&s, x, y, &key, 0U));
#if HAS_CAMERA_RAYS
            seen = extra_camera_rays(&s, x, y, &key, &e);
#endif
        }
        goes_on = follow(&w, &p, &e);
        if (goes_on) continue;
        channels[0] = p.collected.r;
        channels[1] = p.collected.g;
        channels[2] = p.collected.b;
#if HAS_CAMERA_RAYS
        channels[0] += (exact)seen.r;
        channels[1] += (exact)seen.g;
        channels[2] += (exact)seen.b;
#endif
        if (!is_valid_radiance(channels)) {
            channels[0] = channels[1] = channels[2] = 0;
            e.invalid += 1;
        }
        add_sample(&block, channels);
        sample++;
        if (++in_block == SAMPLE_BLOCK) {
            u32 level = 0;
            for (; blocks & (1U << level); level++) add_later(&subtrees[level], &block);
            subtrees[level] = block;
            blocks++;
            in_block = 0;
            clear_sum(&block);
        }
    }
    for (u32 level = 0; level < LEVELS; level++)
        if (blocks & (1U << level)) add_later(&subtrees[level], &block);
    GLOBAL exact *sums = (GLOBAL exact *)(out + OUT_WORDS * (u64)item);
    GLOBAL u64 *counts = out + OUT_WORDS * (u64)item + 6;
    for (int channel = 0; channel < 3; channel++) {
        sums[channel] = block.sum[channel];
        sums[3 + channel] = block.square[channel];
    }
    counts[0] = e.rays;
    counts[1] = e.invalid;
    counts[2] = e.escaped;
    counts[3] = e.truncated;
    counts[4] = e.tested.boxes;
    counts[5] = e.tested.primitives;
}
