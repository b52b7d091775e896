// Sums of samples: `film/sum.rs`. An item is a pixel and a run of its samples, whose sum is a subtree of the film's.

typedef struct { exact sum[3], square[3]; } pixel_sum;

FN void clear_sum(pixel_sum *p) {
    for (int channel = 0; channel < 3; channel++) p->sum[channel] = p->square[channel] = 0;
}
FN void add_sample(pixel_sum *p, rgb c) {
    exact channels[3];
    channels[0] = c.r;
    channels[1] = c.g;
    channels[2] = c.b;
    for (int channel = 0; channel < 3; channel++) {
        p->sum[channel] += channels[channel];
        p->square[channel] += channels[channel] * channels[channel];
    }
}
// `earlier` and `later` in this order.
FN void add_later(const pixel_sum *earlier, pixel_sum *later) {
    for (int channel = 0; channel < 3; channel++) {
        later->sum[channel] = earlier->sum[channel] + later->sum[channel];
        later->square[channel] = earlier->square[channel] + later->square[channel];
    }
}

FN void run_item(u32 item, GLOBAL const stored *numbers, GLOBAL const u32 *words, GLOBAL const u32 *task, GLOBAL u64 *out) {
    scene s = scene_of(numbers, words);
    u32 place = task[TASK_FIRST_PART] + item;
    u32 pixel = task[TASK_FIRST_PIXEL] + place / task[TASK_PARTS];
    u32 x = task[TASK_X] + pixel % task[TASK_COLUMNS], y = task[TASK_Y] + pixel / task[TASK_COLUMNS];
    u32 sample = task[TASK_FIRST_SAMPLE] + place % task[TASK_PARTS] * task[TASK_PART_SAMPLES];
    u32 end = task[TASK_END_SAMPLE];
    if (end - sample > task[TASK_PART_SAMPLES]) end = sample + task[TASK_PART_SAMPLES];
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
    for (; sample < end; sample++) {
        sample_key key = key_of(words, y * words[AT_WIDTH] + x, sample);
        w.key = &key;
        rgb radiance = sample_radiance(&w, camera_ray(&s, x, y, &key), &e);
        if (!(is_finite_from_zero(radiance.r) && is_finite_from_zero(radiance.g) && is_finite_from_zero(radiance.b))) {
            radiance = grey(0.0);
            e.invalid += 1;
        }
        add_sample(&block, radiance);
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
