// Rays against primitives in single precision, as in lanes. Large spheres use curvatures, everything else uses the formulas of double precision.

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

// Tests the large spheres; those that enclose the whole scene come first. `sphere` points to a normal, a curvature and an offset.
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

// Distance to a primitive that is neither a plane nor a large sphere nor the primitive on which the ray starts.
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
FN nearest_s in_leaf_s(const scene *s, u32 first, u32 count, ray_s way, const shear_s *by, standpoint_s from, int only_sure,
    nearest_s so_far) {
    for (u32 entry = first; entry < first + count; entry++) {
        u32 primitive = s->order[entry];
        if (!is_tested_elsewhere(s, primitive, from))
            so_far = nearer_in_any_order_s(so_far, distance_to_s(s, primitive, way, by), primitive);
    }
    return so_far;
}
#if HAS_HIERARCHY
FN slabs slabs_along_s(ray_s way) { return slabs_of(widened_ray(way)); }
#endif
