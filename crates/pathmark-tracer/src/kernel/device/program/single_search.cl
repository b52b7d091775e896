// The search in single precision, as lanes have it: large spheres by curvature, what a ray starts on by where it meets that again, everything else by
// the formulas of double precision, in single. A hit of a triangle that rounding may have made is looked for again in double precision.

typedef struct { u32 primitive; int inside; single own_root; } standpoint_s;
typedef struct { single t; u32 primitive; } nearest_s;
typedef struct {
    single t;
    u32 primitive, object;
    vec_s point, normal, from_center;
    int inside, is_round;
} surface_hit_s;

FN vec widened(vec_s v) { return vec_of((real)v.x, (real)v.y, (real)v.z); }
FN ray widened_ray(ray_s way) {
    ray wide;
    wide.origin = widened(way.origin);
    wide.direction = widened(way.direction);
    return wide;
}

FN nearest_s nearer_s(nearest_s so_far, single distance, u32 primitive) {
    if (0.0f < distance && distance < so_far.t) {
        so_far.t = distance;
        so_far.primitive = primitive;
    }
    return so_far;
}
FN nearest_s nearer_in_any_order_s(nearest_s so_far, single distance, u32 primitive) {
    int comes_first = distance == so_far.t && so_far.primitive != NOTHING && primitive < so_far.primitive;
    if (0.0f < distance && (distance < so_far.t || comes_first)) {
        so_far.t = distance;
        so_far.primitive = primitive;
    }
    return so_far;
}

// The large spheres, those that enclose everything first; `GLOBAL const stored *sphere` has a normal, a curvature and an offset.
FN nearest_s all_large(const scene *s, ray_s way, standpoint_s from) {
    nearest_s so_far;
    so_far.t = INFINITE_S;
    so_far.primitive = NOTHING;
    vec_s o = way.origin, d = way.direction;
    single square = inner_s(o, o), along_ray = inner_s(o, d);
    u32 enclosing = s->words[AT_ENCLOSING_COUNT], count = s->words[AT_LARGE_COUNT];
    for (u32 index = 0; index < count; index++) {
        u32 number = s->words[s->words[AT_LARGE_NUMBERS] + index];
        GLOBAL const stored *sphere = s->numbers + s->words[AT_LARGE] + 5 * index;
        vec_s normal = vec_at_s(sphere);
        single k = (single)sphere[3], offset = (single)sphere[4];
        single c = FUSED(2.0f, inner_s(normal, o), FUSED(k, square, offset));
        single b = FUSED(k, along_ray, inner_s(normal, d));
        single q = b + WITH_SIGN_S(SQUARE_ROOT_S(FUSED(b, b, -(k * c))), b);
        int is_enclosing = index < enclosing;
        int far = q < 0.0f && (is_enclosing || c <= 0.0f);
        single root = -((far ? q : c) / (far ? k : q));
        if (from.primitive == number) root = from.own_root;
        if (is_enclosing && !(0.0f < root)) root = SMALLEST_NORMAL_S;
        so_far = nearer_s(so_far, root, number);
    }
    return so_far;
}

// Distance to a primitive that is no plane, no large sphere and not what the ray starts on.
FN single distance_to_s(const scene *s, u32 primitive, ray_s way, const shear_s *by) {
    if (primitive < s->sphere_count) {
        GLOBAL const stored *sphere = s->spheres + 4 * primitive;
        return first_root_s(minus_s(way.origin, vec_at_s(sphere)), way.direction, (single)sphere[3]);
    }
#if HAS_TRIANGLE
    GLOBAL const stored *corners = triangle_of(s, primitive);
    return triangle_root_s(sheared_s(minus_s(vec_at_s(corners), way.origin), by),
        sheared_s(minus_s(vec_at_s(corners + 3), way.origin), by),
        sheared_s(minus_s(vec_at_s(corners + 6), way.origin), by));
#else
    return -1.0f;
#endif
}
FN int is_tested_elsewhere(const scene *s, u32 primitive, standpoint_s from) {
    if (primitive == from.primitive) return 1;
    if (primitive < s->sphere_count) return s->words[s->words[AT_IS_LARGE] + primitive] != 0U;
    return primitive < s->sphere_count + s->plane_count;
}

#if HAS_HIERARCHY
FN nearest_s through_tree_s(const scene *s, ray_s way, standpoint_s from, nearest_s so_far, const shear_s *by, tests *t) {
    slabs of = slabs_of(widened_ray(way));
    u32 waiting[DEEPEST];
    real distances[DEEPEST];
    int count = 0;
    u32 index = 0;
    t->boxes += 1;
    if (enter(&of, s->boxes, so_far.t) < 0.0) return so_far;
    for (;;) {
        u32 at = s->nodes[2 * index], entries = s->nodes[2 * index + 1];
        if (entries == 0U) {
            t->boxes += 2;
            real a = enter(&of, s->boxes + 6 * at, so_far.t);
            real b = enter(&of, s->boxes + 6 * (at + 1), so_far.t);
            if (a >= 0.0 && b >= 0.0) {
                int second_first = b < a;
                waiting[count] = second_first ? at : at + 1;
                distances[count] = second_first ? a : b;
                count++;
                index = second_first ? at + 1 : at;
                continue;
            }
            if (a >= 0.0) { index = at; continue; }
            if (b >= 0.0) { index = at + 1; continue; }
        } else {
            t->primitives += (u64)entries;
            for (u32 entry = at; entry < at + entries; entry++) {
                u32 primitive = s->order[entry];
                if (!is_tested_elsewhere(s, primitive, from))
                    so_far = nearer_in_any_order_s(so_far, distance_to_s(s, primitive, way, by), primitive);
            }
        }
        do {
            if (count == 0) return so_far;
            count--;
        } while (!(distances[count] <= so_far.t));
        index = waiting[count];
    }
}
#endif

FN nearest_s search_s(const scene *s, ray_s way, standpoint_s from, tests *t) {
    nearest_s so_far = all_large(s, way, from);
    shear_s by = axes_of_s(way.direction);
    if (from.primitive != NOTHING) so_far = nearer_in_any_order_s(so_far, from.own_root, from.primitive);
#if HAS_PLANE
    for (u32 k = 0; k < s->plane_count; k++) {
        GLOBAL const stored *plane = s->planes + 6 * k;
        u32 primitive = s->sphere_count + k;
        if (primitive != from.primitive)
            so_far = nearer_s(so_far,
                plane_root_s(minus_s(vec_at_s(plane), way.origin), way.direction, vec_at_s(plane + 3)), primitive);
    }
#endif
#if HAS_TRIANGLE
    {
        real inverse = 1.0 / (real)component_s(way.direction, by.z);
        by.sx = (single)((real)component_s(way.direction, by.x) * inverse);
        by.sy = (single)((real)component_s(way.direction, by.y) * inverse);
        by.sz = (single)inverse;
    }
#endif
#if HAS_HIERARCHY
    if (s->is_tree) return through_tree_s(s, way, from, so_far, &by, t);
#endif
    u32 all = s->sphere_count + s->plane_count + s->triangle_count;
    for (u32 primitive = 0; primitive < all; primitive++)
        if (!is_tested_elsewhere(s, primitive, from))
            so_far = nearer_in_any_order_s(so_far, distance_to_s(s, primitive, way, &by), primitive);
    return so_far;
}

// The first primitive along a ray, and what there is to know of the point.
FN surface_hit_s first_hit_s(const scene *s, ray_s way, standpoint_s from, single limit, tests *t) {
    surface_hit_s hit;
    nearest_s found = search_s(s, way, from, t);
#if HAS_TRIANGLE
    if (is_triangle(s, found.primitive)) {
        GLOBAL const stored *flat = s->numbers + s->words[AT_SURFACES] + 4 * found.primitive;
        single reach = largest_of_s(way.origin) - (single)flat[3];
        single height = found.t * MAGNITUDE_S(inner_s(vec_at_s(flat), way.direction));
        if (height <= reach * NEARNESS_S) {
            standpoint wide;
            wide.primitive = from.primitive;
            wide.inside = from.own_root == from.own_root;
            nearest again = search(s, widened_ray(way), wide, INFINITE, 1, t);
            found.t = (single)again.t;
            found.primitive = again.primitive;
        }
    }
#endif
    hit.t = found.t;
    hit.primitive = found.primitive;
    if (found.primitive == NOTHING) return hit;
    GLOBAL const stored *row = s->numbers + s->words[AT_SURFACES] + 4 * found.primitive;
    vec_s anchor = vec_at_s(row);
    single curvature = (single)row[3];
    hit.object = s->words[s->words[AT_OWNERS] + found.primitive];
    hit.point = along_s(way, found.t);
    hit.is_round = 0.0f < curvature;
    hit.normal = anchor;
    if (hit.is_round) {
        hit.normal = unit_vector_s(times_plus_s(hit.point, curvature, anchor));
        hit.from_center = times_s(hit.normal, 1.0f / curvature);
    }
    hit.inside = 0.0f < inner_s(hit.normal, way.direction);
    return hit;
}

FN standpoint_s leaving_s(const surface_hit_s *hit, vec_s wi, vec_s direction) {
    standpoint_s from;
    from.primitive = hit->primitive;
    from.inside = (wi.z < 0.0f) != hit->inside;
    from.own_root = INFINITE_S - INFINITE_S;
    if (hit->is_round && from.inside) from.own_root = other_root_s(hit->from_center, direction);
    return from;
}
FN standpoint_s on_nothing_s(void) {
    standpoint_s from;
    from.primitive = NOTHING;
    from.inside = 0;
    from.own_root = INFINITE_S - INFINITE_S;
    return from;
}
