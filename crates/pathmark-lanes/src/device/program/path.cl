// The path that `bsdf`, `smallpt`, `nee` and `mis` share: `estimator/path.rs`. SPLITS and AIMS are constants of the program.

typedef struct { u64 rays, invalid, escaped, truncated; tests tested; } events;

typedef struct {
    ray way;
    standpoint from;
    int is_rival;  // whether the path also aimed at lights from the ray's start; `density` is that of the ray's direction
    real density;
    rgb throughput;
    u32 vertices, branch;
} part;

typedef struct {
    const scene *s;
    const sample_key *key;
    u32 max_depth, roulette_by, roulette_after;
    real roulette_chance;
    int is_weighted;
} walk;

FN int is_spent(rgb t) { return t.r < SMALLEST_NORMAL && t.g < SMALLEST_NORMAL && t.b < SMALLEST_NORMAL; }

FN pair draw(const walk *w, const part *p, u32 purpose) {
    return numbers_of(w->s->words, w->key, p->vertices + 1U, p->branch, purpose);
}

#if HAS_POINT_LIGHT
// The light from point lights that a surface scatters.
FN rgb point_light(const walk *w, const surface *of, const surface_hit *hit, const frame *around, vec wo, events *e) {
    const scene *s = w->s;
    rgb radiance = grey(0.0);
    u32 count = s->words[AT_POINT_LIGHT_COUNT];
    for (u32 k = 0; k < count; k++) {
        GLOBAL const stored *light = s->numbers + s->words[AT_POINT_LIGHTS] + POINT_LIGHT_NUMBERS * k;
        vec towards = minus(vec_at(light), hit->point);
        real far = SQUARE_ROOT(inner(towards, towards));
        if (far > (real)light[6] || !(far > 0.0)) continue;
        ray way;
        way.origin = hit->point;
        way.direction = times(towards, 1.0 / far);
        vec wi = to_local(around, way.direction);
        rgb share = scattered_light(of, wo, wi);
        if (!has_light(share)) continue;
        standpoint from = leaving(hit, wi, way.direction);
        e->rays += 1;
        if (first_hit(s, way, from, far * HIDING, &e->tested).primitive != NOTHING) continue;
        radiance = mixed(radiance, filtered(share, dimmed(rgb_at(light + 3), 1.0 / (far * far))));
    }
    return radiance;
}
#endif

FN part left_by(const walk *w, const part *p, const surface_hit *hit, const frame *around, rgb throughput,
    bsdf_sample sample, u32 branch) {
    part next = *p;
    vec towards = to_world(around, sample.wi);
    next.way.direction = sample.is_delta ? unit_vector(towards) : towards;
    next.way.origin = hit->point;
    next.from = leaving(hit, sample.wi, next.way.direction);
    next.is_rival = AIMS && !sample.is_delta;
    next.density = sample.density;
    next.throughput = filtered(throughput, sample.weight);
    next.vertices = p->vertices + 1U;
    next.branch = branch;
    return next;
}

FN rgb light_at(const walk *w, const part *p, rgb emission, const surface_hit *hit) {
#if AIMS
    if (p->is_rival && !is_black(emission)) {
        real aimed = aimed_density(w->s, p->way, p->from, hit);
        real share = w->is_weighted ? power_heuristic(p->density, aimed) : aimed > 0.0 ? 0.0 : 1.0;
        return dimmed(emission, share);
    }
#endif
    return emission;
}

#if AIMS
// The light that a shadow ray adds, before multiplication by the path's throughput.
FN rgb aimed_light(const walk *w, const part *p, const surface *of, const surface_hit *hit, const frame *around, vec wo,
    events *e, int *found) {
    standpoint from = on_nothing();
    ray way;
    *found = 0;
    from.primitive = hit->primitive;
    from.inside = hit->inside;
    aim at = aim_at(w->s, hit->point, from, w->key, p->vertices + 1U, p->branch);
    if (!at.found) return grey(0.0);
    vec wi = to_local(around, at.direction);
    rgb share = scattered_light(of, wo, wi);
    if (!has_light(share)) return grey(0.0);
    from = leaving(hit, wi, at.direction);
    way.origin = hit->point;
    way.direction = at.direction;
    e->rays += 1;
    surface_hit end = first_hit(w->s, way, from, INFINITE, &e->tested);
    if (end.primitive == NOTHING || end.primitive != at.primitive) return grey(0.0);
    surface light = surface_of(w->s, end.object);
    real weight = w->is_weighted ? power_heuristic(at.density, bsdf_density(of, wo, wi)) : 1.0;
    *found = 1;
    return dimmed(filtered(share, light.emission), weight / at.density);
}
#endif

// A path and those of its branches that are not yet followed.
typedef struct {
    part now, waiting[SPLITS + 1];
    int depth;
    rgb collected;
} path;

FN void begin(path *p, ray start) {
    p->now.way = start;
    p->now.from = on_nothing();
    p->now.is_rival = 0;
    p->now.density = 0.0;
    p->now.throughput = grey(1.0);
    p->now.vertices = p->now.branch = 0;
    p->depth = 0;
    p->collected = grey(0.0);
}

FN int next_branch(path *p) {
    if (p->depth == 0) return 0;
    p->depth--;
    p->now = p->waiting[p->depth];
    return 1;
}

FN void collect(path *p, rgb radiance) {
    p->collected = mixed(p->collected, filtered(p->now.throughput, radiance));
}

// Like `collect`, for light that the path hits. Light that a camera ray sees directly is multiplied by the camera ray's share.
FN void collect_arrived(const walk *w, path *p, rgb radiance) {
#if HAS_CAMERA_RAYS
    if (p->now.vertices == 0U) radiance = dimmed(radiance, (real)w->s->numbers[VIEW_CAMERA_SHARE]);
#endif
    collect(p, radiance);
}

#if HAS_CAMERA_RAYS
// The light that a sample's other camera rays see.
FN rgb extra_camera_rays(const scene *s, u32 x, u32 y, const sample_key *key, events *e) {
    rgb seen = grey(0.0);
    for (u32 number = 1U; number < s->words[AT_CAMERA_RAYS]; number++) {
        e->rays += 1;
        surface_hit hit = first_hit(s, camera_ray(s, x, y, key, number), on_nothing(), INFINITE, &e->tested);
        if (hit.primitive != NOTHING) seen = mixed(seen, surface_of(s, hit.object).emission);
#if HAS_BACKGROUND
        else seen = mixed(seen, rgb_at(s->numbers + VIEW_BACKGROUND));
#endif
    }
    return dimmed(seen, (real)s->numbers[VIEW_CAMERA_SHARE]);
}
#endif

// Follows the path to its next vertex. Returns whether the path or one of its branches continues.
FN int follow(const walk *w, path *p, events *e) {
    const scene *s = w->s;
    e->rays += 1;
    surface_hit hit = first_hit(s, p->now.way, p->now.from, INFINITE, &e->tested);
    if (hit.primitive == NOTHING) {
#if HAS_BACKGROUND
        rgb background = rgb_at(s->numbers + VIEW_BACKGROUND);
        if (!is_black(background)) collect_arrived(w, p, background);
#endif
        e->escaped += 1;
        return next_branch(p);
    }
    surface of = surface_of(s, hit.object);
    collect_arrived(w, p, light_at(w, &p->now, of.emission, &hit));
    if (p->now.vertices == w->max_depth) {
        e->truncated += 1;
        return next_branch(p);
    }
    u32 vertices = p->now.vertices + 1U;
    frame around = frame_around(hit.inside ? negated(hit.normal) : hit.normal);
    vec wo = to_local(&around, negated(p->now.way.direction));
#if HAS_POINT_LIGHT
    if (s->words[AT_POINT_LIGHT_COUNT] > 0U) collect(p, point_light(w, &of, &hit, &around, wo, e));
#endif
#if AIMS
    int found;
    rgb aimed = aimed_light(w, &p->now, &of, &hit, &around, wo, e, &found);
    if (found) collect(p, aimed);
#endif
    rgb throughput = p->now.throughput;
    if (vertices > w->roulette_after) {
        real chance = w->roulette_chance;
        if (w->roulette_by == ROULETTE_ALBEDO) {
            chance = largest_channel(of.albedo);
        } else if (w->roulette_by == ROULETTE_THROUGHPUT) {
            real carried = largest_channel(filtered(throughput, of.albedo));
            chance = carried < 1.0 ? carried : 1.0;
        }
        if (draw(w, &p->now, PURPOSE_ROULETTE).u >= chance) return next_branch(p);
        throughput = dimmed(throughput, 1.0 / chance);
    }
    bsdf_sample first, second;
#if SPLITS > 0
    if (vertices <= SPLITS && two_lobes(&of, wo, hit.inside, &first, &second)) {
        p->waiting[p->depth] = left_by(w, &p->now, &hit, &around, throughput, second,
            p->now.branch | (1U << (vertices - 1U)));
        p->depth++;
        p->now = left_by(w, &p->now, &hit, &around, throughput, first, p->now.branch);
        return 1;
    }
#endif
    pair numbers = draw(w, &p->now, PURPOSE_BSDF);
#if AIMS
    if (two_lobes(&of, wo, hit.inside, &first, &second)) {
        real one = max_channel(first.weight), other = max_channel(second.weight);
        real both = one + other;
        real chance = both > 0.0 ? one / both : 0.5;
        if (!(numbers.u < chance)) {
            first = second;
            chance = 1.0 - chance;
        }
        first.weight = dimmed(first.weight, 1.0 / chance);
    } else {
        first = sample_bsdf(&of, wo, hit.inside, numbers);
    }
#else
    first = sample_bsdf(&of, wo, hit.inside, numbers);
#endif
    if (!first.found) return next_branch(p);
    p->now = left_by(w, &p->now, &hit, &around, throughput, first, p->now.branch);
    return is_spent(p->now.throughput) ? next_branch(p) : 1;
}
