// The search in single precision, as in lanes. The primitive on which a ray starts is hit at the distance computed beforehand. If rounding may have
// caused the hit of a triangle, the search is repeated in double precision.

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
    if (s->is_tree) return through_tree_s(s, way, &by, from, 0, so_far, t);
#endif
    u32 all = s->sphere_count + s->plane_count + s->triangle_count;
    for (u32 primitive = 0; primitive < all; primitive++)
        if (!is_tested_elsewhere(s, primitive, from))
            so_far = nearer_in_any_order_s(so_far, distance_to_s(s, primitive, way, &by), primitive);
    return so_far;
}

// The first primitive along a ray, and the data of the hit point.
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
