// The first of all primitives along a ray: `scene/shape/mod.rs`.

// Tests planes, which are in no tree.
FN nearest all_planes(const scene *s, ray way, standpoint from, nearest so_far) {
#if HAS_PLANE
    for (u32 k = 0; k < s->plane_count; k++) {
        u32 primitive = s->sphere_count + k;
        real t = from.primitive == primitive ? -1.0 : plane_meet(s->planes + 6 * k, way);
        so_far = nearer(so_far, t, primitive);
    }
#endif
    return so_far;
}

FN nearest search(const scene *s, ray way, standpoint from, real limit, int only_sure, tests *t) {
    nearest so_far = nothing_nearer_than(limit);
#if HAS_HIERARCHY
    if (s->is_tree) {
        shear by;
#if HAS_TRIANGLE
        by = shear_of(way.direction);
#endif
        so_far = all_planes(s, way, from, so_far);
        if (from.primitive != NOTHING && from.inside) {
            // The start may be rounded to outside the box of its own primitive.
            real own = wanted_distance(s, from.primitive, way, &by, from, only_sure);
            so_far = nearer_in_any_order(so_far, own, from.primitive);
        }
        return through_tree(s, way, &by, from, only_sure, so_far, t);
    }
#endif
    if (only_sure) {
        u32 all = s->sphere_count + s->plane_count + s->triangle_count;
        shear by = shear_of(way.direction);
        for (u32 primitive = 0; primitive < all; primitive++) {
            real distance = wanted_distance(s, primitive, way, &by, from, 1);
            so_far = nearer_in_any_order(so_far, distance, primitive);
        }
        return so_far;
    }
    for (u32 k = 0; k < s->sphere_count; k++) {
        GLOBAL const stored *sphere = s->spheres + 4 * k;
        real distance = from.primitive == k ? sphere_leave(sphere, way, from.inside) : sphere_first_root(sphere, way);
        so_far = nearer(so_far, distance, k);
    }
    so_far = all_planes(s, way, from, so_far);
#if HAS_TRIANGLE
    {
        shear by = shear_of(way.direction);
        u32 first = s->sphere_count + s->plane_count;
        for (u32 k = 0; k < s->triangle_count; k++) {
            real distance = from.primitive == first + k ? -1.0 : triangle_meet(s->triangles + 9 * k, way, &by);
            so_far = nearer(so_far, distance, first + k);
        }
    }
#endif
    return so_far;
}

FN surface_hit hit_of(const scene *s, ray way, nearest found) {
    surface_hit hit;
    hit.t = found.t;
    hit.primitive = found.primitive;
    if (found.primitive == NOTHING) return hit;
    hit.object = s->words[s->words[AT_OWNERS] + found.primitive];
    hit.point = along(way, found.t);
    hit.normal = normal_of(s, found.primitive, hit.point);
    hit.inside = inner(hit.normal, way.direction) > 0.0;
    return hit;
}

// The first primitive along a ray; its number is NOTHING if no primitive is nearer than `limit`.
FN surface_hit first_hit(const scene *s, ray way, standpoint from, real limit, tests *t) {
    surface_hit hit = hit_of(s, way, search(s, way, from, limit, 0, t));
#if HAS_TRIANGLE
    if (is_triangle(s, hit.primitive)) {
        looks of = looks_of(triangle_of(s, hit.primitive), way, hit.t, hit.normal, NEARNESS);
        if (of.near || !of.inside) return hit_of(s, way, search(s, way, from, limit, 1, t));
    }
#endif
    return hit;
}

// The start of a ray that leaves a surface along the local direction `wi`.
FN standpoint leaving(const surface_hit *hit, vec wi, vec direction) {
    standpoint from;
    from.primitive = hit->primitive;
    from.inside = (wi.z < 0.0) != hit->inside;
    return from;
}
FN standpoint on_nothing(void) {
    standpoint from;
    from.primitive = NOTHING;
    from.inside = 0;
    return from;
}

FN scene scene_of(GLOBAL const stored *numbers, GLOBAL const u32 *words) {
    scene s;
    s.numbers = numbers;
    s.words = words;
    s.spheres = numbers + words[AT_SPHERES];
    s.planes = numbers + words[AT_PLANES];
    s.triangles = numbers + words[AT_TRIANGLES];
    s.boxes = numbers + words[AT_BOXES];
    s.nodes = words + words[AT_NODES];
    s.order = words + words[AT_ORDER];
    s.sphere_count = words[AT_SPHERE_COUNT];
    s.plane_count = words[AT_PLANE_COUNT];
    s.triangle_count = words[AT_TRIANGLE_COUNT];
    s.is_tree = words[AT_NODE_COUNT] > 0U;
    return s;
}
