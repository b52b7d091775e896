// Lights at which paths aim: `scene/light/`. A light has LIGHT_NUMBERS numbers and two words, its kind and its primitive.

typedef struct { vec direction; u32 primitive; real density; int found; } aim;

// 1 - cos of the half angle under which a sphere is seen.
FN real one_minus_cosine(real radius, real distance_to_center) {
    real sine = radius / distance_to_center;
    real cos2 = (distance_to_center - radius) / distance_to_center * ((distance_to_center + radius) / distance_to_center);
    return sine * sine / (1.0 + SQUARE_ROOT(cos2));
}
FN vec towards_cap(vec axis, real height, pair p) {
    real z = p.v * height, sine, cosine;
    turn(p.u, &sine, &cosine);
    real r = SQUARE_ROOT(z * (2.0 - z));
    frame around = frame_around(axis);
    return to_world(&around, vec_of(r * cosine, r * sine, 1.0 - z));
}
FN real per_steradian(real square, vec direction, vec normal, real area) {
    return square / (MAGNITUDE(inner(direction, normal)) * area);
}

// The methods of sampling directions from a point to a sphere.
#define WAY_NONE 0
#define WAY_EVERYWHERE 1
#define WAY_AREA 2
#define WAY_CONE 3
FN int way_to_sphere(GLOBAL const stored *light, u32 kind, vec point, int is_own, int own_inside, vec *axis, real *cap) {
    real radius = (real)light[6], height = (real)light[10];
    vec offset = minus(vec_at(light + 3), point);
    real square = inner(offset, offset);
    if (is_own ? own_inside : square <= radius * radius) return WAY_EVERYWHERE;
    real far = SQUARE_ROOT(square);
    if (is_own || far <= radius) return WAY_NONE;
    if (kind == LIGHT_CAP && height * far < radius * (far - radius)) return WAY_AREA;
    *axis = times(offset, 1.0 / far);
    *cap = one_minus_cosine(radius, far);
    return WAY_CONE;
}

FN aim aim_at(const scene *s, vec point, standpoint from, const sample_key *key, u32 bounce, u32 branch) {
    aim at;
    at.found = 0;
    u32 count = s->words[AT_LIGHT_COUNT];
    if (count == 0U) return at;
    GLOBAL const stored *lights = s->numbers + s->words[AT_LIGHTS];
    GLOBAL const u32 *kinds = s->words + s->words[AT_LIGHT_KINDS];
    u32 chosen = 0;
    if (count > 1U) {
        real number = numbers_of(s->words, key, bounce, branch, PURPOSE_LIGHT_CHOICE).u;
        u32 after = count;
        while (chosen < after) {
            u32 middle = chosen + (after - chosen) / 2U;
            if (lights[LIGHT_NUMBERS * middle + 1] <= number) chosen = middle + 1U;
            else after = middle;
        }
        if (chosen > count - 1U) chosen = count - 1U;
    }
    GLOBAL const stored *light = lights + LIGHT_NUMBERS * chosen;
    u32 kind = kinds[2 * chosen];
    pair place = numbers_of(s->words, key, bounce, branch, PURPOSE_LIGHT);
    at.primitive = kinds[2 * chosen + 1];
    int is_own = from.primitive == at.primitive;
    real density;
    if (kind == LIGHT_TRIANGLE) {
        real root = SQUARE_ROOT(place.u);
        vec on = plus(plus(vec_at(light + 3), times(vec_at(light + 6), root * (1.0 - place.v))),
            times(vec_at(light + 9), root * place.v));
        vec towards = minus(on, point);
        real square = inner(towards, towards);
        at.direction = times(towards, 1.0 / SQUARE_ROOT(square));
        if (is_own || !(square > 0.0)) return at;
        density = per_steradian(square, at.direction, vec_at(light + 12), (real)light[2]);
    } else {
        vec axis;
        real cap;
        int way = way_to_sphere(light, kind, point, is_own, from.inside, &axis, &cap);
        if (way == WAY_NONE) return at;
        if (way == WAY_EVERYWHERE) {
            at.direction = uniform_sphere(place);
            density = UNIFORM_SPHERE_DENSITY;
        } else if (way == WAY_CONE) {
            at.direction = towards_cap(axis, cap, place);
            density = 0.5 / (PI * cap);
        } else {
            vec normal = towards_cap(vec_at(light + 7), (real)light[10] / (real)light[6], place);
            vec towards = minus(plus(vec_at(light + 3), times(normal, (real)light[6])), point);
            real square = inner(towards, towards);
            at.direction = times(towards, 1.0 / SQUARE_ROOT(square));
            real cosine = -inner(at.direction, normal);
            if (!(cosine > 0.0)) return at;
            density = square / (cosine * (real)light[2]);
        }
    }
    at.density = (real)light[0] * density;
    at.found = at.density > 0.0 && at.density < INFINITE;
    return at;
}

// The density with which `aim_at` chooses the direction of a ray that met `hit`; 0 if paths do not aim at that primitive.
FN real aimed_density(const scene *s, ray way, standpoint from, const surface_hit *hit) {
    u32 chosen = s->words[s->words[AT_LIGHT_OF] + hit->primitive];
    if (chosen == NOTHING) return 0.0;
    GLOBAL const stored *light = s->numbers + s->words[AT_LIGHTS] + LIGHT_NUMBERS * chosen;
    GLOBAL const u32 *kinds = s->words + s->words[AT_LIGHT_KINDS];
    u32 kind = kinds[2 * chosen];
    int is_own = from.primitive == kinds[2 * chosen + 1];
    real density;
    if (kind == LIGHT_TRIANGLE) {
        density = per_steradian(hit->t * hit->t, way.direction, vec_at(light + 12), (real)light[2]);
    } else {
        vec axis;
        real cap;
        int by = way_to_sphere(light, kind, way.origin, is_own, from.inside, &axis, &cap);
        if (by == WAY_NONE) {
            density = 0.0;
        } else if (by == WAY_EVERYWHERE) {
            density = UNIFORM_SPHERE_DENSITY;
        } else if (by == WAY_CONE) {
            density = 0.5 / (PI * cap);
        } else {
            vec off = minus(hit->normal, vec_at(light + 7));
            density = inner(off, off) * (real)light[6] > 2.0 * (real)light[10]
                ? 0.0
                : hit->t * hit->t / (MAGNITUDE(inner(way.direction, hit->normal)) * (real)light[2]);
        }
    }
    return (real)light[0] * density;
}
