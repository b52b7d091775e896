// Random numbers by address, as in `sampling/`.

typedef struct {
    u64 pixel_key;  // the key that all numbers of a pixel or of a path share, depending on the sampler
    u64 seed_key;
    u32 pixel, sample;
} sample_key;

FN u64 mix64(u64 x) {
    u64 z = x + 0x9E3779B97F4A7C15UL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9UL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBUL;
    return z ^ (z >> 31);
}
FN u64 reversed64(u64 x) {
    x = ((x >> 1) & 0x5555555555555555UL) | ((x & 0x5555555555555555UL) << 1);
    x = ((x >> 2) & 0x3333333333333333UL) | ((x & 0x3333333333333333UL) << 2);
    x = ((x >> 4) & 0x0F0F0F0F0F0F0F0FUL) | ((x & 0x0F0F0F0F0F0F0F0FUL) << 4);
    x = ((x >> 8) & 0x00FF00FF00FF00FFUL) | ((x & 0x00FF00FF00FF00FFUL) << 8);
    x = ((x >> 16) & 0x0000FFFF0000FFFFUL) | ((x & 0x0000FFFF0000FFFFUL) << 16);
    return (x >> 32) | (x << 32);
}
FN u64 own_prefix(u64 seed_key, u64 place) { return mix64(mix64(place) ^ seed_key); }

// Owen scrambling by 64-bit products, `sampling/owen.rs`.
FN u64 scramble(u64 digits, u64 a, u64 b) {
    digits ^= digits * (b << 1);
    digits = (digits + a) * ((b << 32) | (b >> 32) | 1UL);
    digits ^= digits * (((a << 32) | (a >> 32)) << 1);
    return digits + ((b << 16) | (b >> 48));
}
FN u64 shuffle64(u64 index, u64 a, u64 b) { return reversed64(scramble(reversed64(index) >> 32, a, b) << 32); }

FN u64 pascal_of_elements(u64 e) {
    e ^= (e >> 2) & 0x33333333UL;
    e ^= (e >> 4) & 0x0F0F0F0FUL;
    e ^= (e >> 8) & 0x00FF00FFUL;
    return e ^ (e >> 16);
}
FN u64 pascal(u64 index) { return pascal_of_elements(index ^ ((index >> 1) & 0x55555555UL)); }
FN u32 times_omega(u32 elements) {
    u32 higher = elements >> 1;
    return (higher & 0x55555555U) | (((elements ^ higher) & 0x55555555U) << 1);
}
FN u32 pascal_to_omega(u32 index) {
    u32 once = times_omega(index);
    u32 powers = (index & EACH_THIRD_0) | (once & EACH_THIRD_1) | ((index ^ once) & EACH_THIRD_2);
    u32 elements = (u32)pascal_of_elements((u64)powers);
    once = times_omega(elements);
    return (elements & EACH_THIRD_0) | ((elements ^ once) & EACH_THIRD_1) | (once & EACH_THIRD_2);
}
FN u32 leading_place(u32 sample, u64 a, u64 b, GLOBAL const u32 *orders) {
    u32 fours = (u32)shuffle64((u64)(sample >> 2), a, b) << 2;
    u32 order = orders[((a >> 32) * 24UL) >> 32];
    u32 subpixel = (order >> (2 * (sample & 3U))) & 3U;
    u32 lower = COUNT_ONES(fours & SUBPIXEL_LOWER) & 1U;
    u32 higher = COUNT_ONES(fours & SUBPIXEL_HIGHER) & 1U;
    return fours | (subpixel ^ lower ^ (higher << 1));
}

// Vegdahl's hash, `sampling/burley.rs`.
FN u64 low_product(u64 a, u64 b) { return (a & 0xFFFFFFFFUL) * (b & 0xFFFFFFFFUL); }
FN u64 burley(u64 digits, u64 seed) {
    digits ^= low_product(digits, 0x3D20ADEAUL);
    digits = low_product(digits + seed, (seed >> 16) | 1UL);
    digits ^= low_product(digits, 0x05526C56UL);
    return digits ^ low_product(digits, 0x53A22864UL);
}

FN u64 pcg_output(u64 state) {
    u64 x = (((state >> 18) ^ state) >> 27) & 0xFFFFFFFFUL;
    return ((x | (x << 32)) >> (state >> 59)) & 0xFFFFFFFFUL;
}

FN sample_key key_of(GLOBAL const u32 *words, u32 pixel, u32 sample) {
    sample_key key;
    key.seed_key = (u64)words[AT_SEED_KEY] | ((u64)words[AT_SEED_KEY + 1] << 32);
    key.pixel = pixel;
    key.sample = sample;
    u32 kind = words[AT_SAMPLER];
    if (kind == SAMPLER_SOBOL)
        key.pixel_key = own_prefix(key.seed_key, (u64)pixel);
    else if (kind == SAMPLER_STRATIFIED)
        key.pixel_key = own_prefix(key.seed_key, ((u64)pixel << 32) | (u64)(sample / 16U));
    else
        key.pixel_key = own_prefix(key.seed_key, ((u64)pixel << 32) | (u64)sample);
    return key;
}

FN u64 inside_cell(u32 cell, u64 bits) { return ((u64)cell << 62) | (bits >> 2); }

typedef struct { u64 first, second; } word_pair;

// The two random words of one use; the numbers take their leading digits.
FN word_pair words_of(GLOBAL const u32 *words, const sample_key *key, u32 bounce, u32 branch, u32 purpose) {
    u64 dimension = ((u64)(bounce & 0xFFFFU) << 32) | ((u64)branch << 16) | (u64)purpose;
    u64 word = mix64(key->pixel_key ^ dimension);
    u32 kind = words[AT_SAMPLER];
    word_pair result;
    if (kind == SAMPLER_HASH) {
        result.first = word;
        result.second = (word << 32) | (word >> 32);
        return result;
    }
    if (kind == SAMPLER_INDEPENDENT) {
        u64 multiplier = 0x5851F42D4C957F2DUL, increment = (dimension << 1) | 1UL;
        u64 first = (word + increment) * multiplier + increment;
        u64 second = first * multiplier + increment;
        u64 third = second * multiplier + increment;
        u64 fourth = third * multiplier + increment;
        result.first = pcg_output(first) | (pcg_output(second) << 32);
        result.second = pcg_output(third) | (pcg_output(fourth) << 32);
        return result;
    }
    if (kind == SAMPLER_STRATIFIED) {
        u64 table_key = mix64(word);
        u32 column = key->sample % 4U, row = key->sample / 4U % 4U;
        for (u32 round = 0; round < 4U; round++) {
            u32 table = (u32)(table_key >> (16U * round));
            column ^= (table >> (2U * row)) & 3U;
            row ^= (table >> (8U + 2U * column)) & 3U;
        }
        u64 place = ((u64)(key->sample % 16U) << 1) | 1UL;
        result.first = inside_cell(column, mix64(word ^ place));
        result.second = inside_cell(row, mix64(word ^ (place + 1UL)));
        return result;
    }
    u64 place;
    int leads = (bounce == 0U && purpose == PURPOSE_FILM)
        || (bounce == 1U && branch == 0U && (purpose == PURPOSE_BSDF || purpose == PURPOSE_LIGHT));
    if (leads) {
        u32 common = leading_place(key->sample, mix64(~key->pixel_key), mix64(key->pixel_key ^ ~1UL), words + AT_ORDERS);
        place = (u64)(bounce == 0U ? common : pascal_to_omega(common));
    } else {
        place = reversed64(burley(reversed64((u64)key->sample) >> 32, mix64(word ^ 1UL)) << 32);
    }
    result.first = reversed64(burley(place, word));
    result.second = reversed64(burley(pascal(place), word >> 32));
    return result;
}
