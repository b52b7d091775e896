// Rays against spheres, planes and triangles, and the search for the nearest: `scene/shape/`.

#define NOTHING 0xFFFFFFFFU

typedef struct {
    GLOBAL const stored *numbers;
    GLOBAL const u32 *words;
    GLOBAL const stored *spheres, *planes, *triangles, *boxes;
    GLOBAL const u32 *nodes, *order;
    u32 sphere_count, plane_count, triangle_count, is_tree;
} scene;

typedef struct { u32 primitive; int inside; } standpoint;  // `primitive` is NOTHING if the ray starts on no primitive
typedef struct { real t; u32 primitive; } nearest;
typedef struct { u64 boxes, primitives; } tests;
typedef struct {
    real t;
    u32 primitive, object;
    vec point, normal;
    int inside;
} surface_hit;

FN nearest nothing_nearer_than(real t) { nearest n; n.t = t; n.primitive = NOTHING; return n; }

// For primitives in the order of their numbers. A distance that is not above zero is no hit.
FN nearest nearer(nearest so_far, real distance, u32 primitive) {
    real ahead = distance > 0.0 ? distance : INFINITE;
    if (ahead < so_far.t) {
        so_far.t = ahead;
        so_far.primitive = primitive;
    }
    return so_far;
}
FN nearest nearer_in_any_order(nearest so_far, real distance, u32 primitive) {
    real ahead = distance > 0.0 ? distance : INFINITE;
    int comes_first = primitive < so_far.primitive && so_far.primitive != NOTHING;
    if (ahead < so_far.t || (ahead == so_far.t && comes_first)) {
        so_far.t = ahead;
        so_far.primitive = primitive;
    }
    return so_far;
}

FN real sphere_first_root(GLOBAL const stored *sphere, ray way) {
    return first_root(minus(way.origin, vec_at(sphere)), way.direction, sphere[3]);
}
FN real sphere_leave(GLOBAL const stored *sphere, ray way, int inside) {
    return inside ? other_root(minus(vec_at(sphere), way.origin), way.direction) : -1.0;
}
FN real plane_meet(GLOBAL const stored *plane, ray way) {
    return plane_root(minus(vec_at(plane), way.origin), way.direction, vec_at(plane + 3));
}
FN shear shear_of(vec d) {
    shear by = axes_of(d);
    real inverse = 1.0 / component(d, by.z);
    by.sx = component(d, by.x) * inverse;
    by.sy = component(d, by.y) * inverse;
    by.sz = inverse;
    return by;
}
FN real triangle_meet(GLOBAL const stored *corners, ray way, const shear *by) {
    return triangle_root(sheared(minus(vec_at(corners), way.origin), by),
        sheared(minus(vec_at(corners + 3), way.origin), by), sheared(minus(vec_at(corners + 6), way.origin), by));
}
FN vec triangle_normal(GLOBAL const stored *corners) {
    vec a = vec_at(corners);
    vec e = minus(vec_at(corners + 3), a), f = minus(vec_at(corners + 6), a);
    return unit_vector(outer(times(e, 1.0 / largest_of(e)), times(f, 1.0 / largest_of(f))));
}

FN vec normal_of(const scene *s, u32 primitive, vec point) {
    if (primitive < s->sphere_count) return unit_vector(minus(point, vec_at(s->spheres + 4 * primitive)));
    primitive -= s->sphere_count;
#if HAS_PLANE
    if (primitive < s->plane_count) return vec_at(s->planes + 6 * primitive + 3);
#endif
    primitive -= s->plane_count;
#if HAS_TRIANGLE
    return triangle_normal(s->triangles + 9 * primitive);
#else
    return vec_of(0.0, 0.0, 0.0);
#endif
}

// Distance to one primitive. The ray may start on that primitive.
FN real distance_to(const scene *s, u32 primitive, ray way, const shear *by, standpoint from) {
    int own = from.primitive == primitive;
    u32 index = primitive;
    if (index < s->sphere_count) {
        GLOBAL const stored *sphere = s->spheres + 4 * index;
        return own ? sphere_leave(sphere, way, from.inside) : sphere_first_root(sphere, way);
    }
    index -= s->sphere_count;
    if (own) return -1.0;
#if HAS_PLANE
    if (index < s->plane_count) return plane_meet(s->planes + 6 * index, way);
#endif
    index -= s->plane_count;
#if HAS_TRIANGLE
    return triangle_meet(s->triangles + 9 * index, way, by);
#else
    return -1.0;
#endif
}

#if HAS_TRIANGLE
typedef struct { int near, inside; } looks;

FN void extend(real *low, real *high, real x) {
    if (x < *low) *low = x;
    if (x > *high) *high = x;
}
// Returns the largest coordinate of a triangle's box, and writes the box to `low` and `high`.
FN real triangle_box(GLOBAL const stored *corners, real *low, real *high) {
    real largest = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITE;
        high[axis] = -INFINITE;
        for (int corner = 0; corner < 3; corner++) extend(low + axis, high + axis, corners[3 * corner + axis]);
        largest = larger(larger(largest, MAGNITUDE(low[axis])), MAGNITUDE(high[axis]));
    }
    return largest;
}
FN looks looks_of(GLOBAL const stored *corners, ray way, real t, vec normal, real nearness) {
    looks of;
    real low[3], high[3];
    real reach = triangle_box(corners, low, high) + largest_of(way.origin);
    real by = HALF_PADDING * reach;
    vec point = along(way, t);
    of.near = t * MAGNITUDE(inner(normal, way.direction)) <= nearness * reach;
    of.inside = low[0] - by <= point.x && point.x <= high[0] + by && low[1] - by <= point.y
        && point.y <= high[1] + by && low[2] - by <= point.z && point.z <= high[2] + by;
    return of;
}
FN int can_reach(GLOBAL const stored *own, GLOBAL const stored *other, vec direction) {
    real low[3], high[3];
    vec own_normal = triangle_normal(own), normal = triangle_normal(other);
    real largest = triangle_box(own, low, high);
    real slack = HALF_PADDING * (largest + triangle_box(other, low, high));
    vec ahead = inner(direction, own_normal) < 0.0 ? negated(own_normal) : own_normal;
    int rises = 0, above = 0, below = 0;
    for (int corner = 0; corner < 3; corner++) {
        real height = inner(minus(vec_at(other + 3 * corner), vec_at(own)), ahead);
        if (height > slack) rises = 1;
        height = inner(minus(vec_at(own + 3 * corner), vec_at(other)), normal);
        if (height > slack) above = 1;
        if (height < -slack) below = 1;
    }
    real towards = inner(direction, normal);
    return rises && ((above && (below || towards < 0.0)) || (below && towards > 0.0));
}
FN GLOBAL const stored *triangle_of(const scene *s, u32 primitive) {
    return s->triangles + 9 * (primitive - s->sphere_count - s->plane_count);
}
FN int is_triangle(const scene *s, u32 primitive) {
    return primitive != NOTHING && primitive >= s->sphere_count + s->plane_count;
}
#endif

// Distance to one primitive. With `only_sure`, triangles that the ray does not surely hit count as missed.
FN real wanted_distance(const scene *s, u32 primitive, ray way, const shear *by, standpoint from, int only_sure) {
    real t = distance_to(s, primitive, way, by, from);
#if HAS_TRIANGLE
    if (only_sure && is_triangle(s, primitive)) {
        GLOBAL const stored *corners = triangle_of(s, primitive);
        looks of = looks_of(corners, way, t, triangle_normal(corners), NEARNESS);
        int is_sure = of.inside
            && (!of.near || !is_triangle(s, from.primitive)
                || can_reach(triangle_of(s, from.primitive), corners, way.direction));
        if (!is_sure) return -1.0;
    }
#endif
    return t;
}

#if HAS_HIERARCHY
typedef struct { real near[3], far[3], inverse[3]; int backward[3]; } slabs;

FN slabs slabs_of(ray way) {
    slabs of;
    real origin[3], direction[3];
    origin[0] = way.origin.x; origin[1] = way.origin.y; origin[2] = way.origin.z;
    direction[0] = way.direction.x; direction[1] = way.direction.y; direction[2] = way.direction.z;
    real padding = PADDING * largest_of(way.origin);
    for (int axis = 0; axis < 3; axis++) {
        of.backward[axis] = direction[axis] < 0.0;
        real outwards = of.backward[axis] ? -padding : padding;
        of.near[axis] = origin[axis] + outwards;
        of.far[axis] = origin[axis] - outwards;
        of.inverse[axis] = 1.0 / (direction[axis] + 0.0);
    }
    return of;
}
// Distance at which the ray enters a box; below zero if the ray misses the box or enters it beyond `limit`.
FN real enter(const slabs *of, GLOBAL const stored *faces, real limit) {
    real first_in = 0.0, last_in = limit;
    for (int axis = 0; axis < 3; axis++) {
        int backward = of->backward[axis];
        real first = (faces[3 * backward + axis] - of->near[axis]) * of->inverse[axis];
        real last = (faces[3 * (1 - backward) + axis] - of->far[axis]) * of->inverse[axis];
        first_in = first > first_in ? first : first_in;
        last_in = last < last_in ? last : last_in;
    }
    return first_in <= last_in ? first_in : -1.0;
}
FN slabs slabs_along(ray way) { return slabs_of(way); }
#endif

// Tests the primitives of a leaf.
FN nearest in_leaf(const scene *s, u32 first, u32 count, ray way, const shear *by, standpoint from, int only_sure,
    nearest so_far) {
    for (u32 entry = first; entry < first + count; entry++) {
        u32 primitive = s->order[entry];
        so_far = nearer_in_any_order(so_far, wanted_distance(s, primitive, way, by, from, only_sure), primitive);
    }
    return so_far;
}
