// Camera rays, at which paths begin: `scene/camera/`.

// A camera ray of a sample. Ray number 0 begins the path.
FN ray camera_ray(const scene *s, u32 x, u32 y, const sample_key *key, u32 ray_number) {
    GLOBAL const stored *view = s->numbers;
    u32 filter = s->words[AT_FILTER], number = key->sample % 4U;
    pair film = numbers_of(s->words, key, 0U, ray_number, PURPOSE_FILM);
    real dx = 0.5, dy = 0.5;
    if (filter == FILTER_TENT) {
        dx = ((real)(number % 2U) + 0.5 + tent(film.u)) / 2.0;
        dy = ((real)(number / 2U) + 0.5 + tent(film.v)) / 2.0;
    } else if (filter == FILTER_BOX) {
        dx = film.u;
        dy = film.v;
    }
    real row = (real)(view[VIEW_HEIGHT] - 1) - (real)y;
    real along_row = (dx + (real)x) / (real)view[VIEW_WIDTH] - 0.5;
    real upward = (dy + row) / (real)view[VIEW_HEIGHT] - 0.5;
    vec towards = plus(plus(times(vec_at(view + VIEW_RIGHT), along_row), times(vec_at(view + VIEW_UP), upward)),
        vec_at(view + VIEW_DIRECTION));
    vec position = vec_at(view + VIEW_POSITION);
    ray start;
#if HAS_LENS
    if (view[VIEW_LENS_RADIUS] > 0) {
        pair lens = concentric_disk(numbers_of(s->words, key, 0U, ray_number, PURPOSE_LENS));
        real radius = (real)view[VIEW_LENS_RADIUS];
        vec offset = plus(times(vec_at(view + VIEW_LENS_RIGHT), lens.u * radius),
            times(vec_at(view + VIEW_LENS_UP), lens.v * radius));
        start.direction = unit_vector(minus(times(towards, (real)view[VIEW_LENS_FOCUS]), offset));
        start.origin = plus(plus(position, offset), times(start.direction, (real)view[VIEW_ADVANCE]));
        return start;
    }
#endif
    start.direction = unit_vector(towards);
    start.origin = plus(position, times(start.direction, (real)view[VIEW_ADVANCE]));
    return start;
}
