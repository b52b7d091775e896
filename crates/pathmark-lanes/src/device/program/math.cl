// Vectors, colours and the leaf formulas of a path. They repeat `math/` operation by operation, so the results have the same bits. TIMES_PLUS rounds
// once in single precision and twice in double precision.

typedef struct { real x, y, z; } vec;
typedef struct { real r, g, b; } rgb;
typedef struct { vec origin, direction; } ray;
typedef struct { vec s, t, n; } frame;
typedef struct { real u, v; } pair;

// Compares like Rust's `f64::max`: of a number and NaN, returns the number.
FN real larger(real a, real b) { return (a < b || a != a) ? b : a; }

FN vec vec_of(real x, real y, real z) { vec v; v.x = x; v.y = y; v.z = z; return v; }
FN vec plus(vec a, vec b) { return vec_of(a.x + b.x, a.y + b.y, a.z + b.z); }
FN vec minus(vec a, vec b) { return vec_of(a.x - b.x, a.y - b.y, a.z - b.z); }
FN vec times(vec a, real s) { return vec_of(a.x * s, a.y * s, a.z * s); }
FN vec negated(vec a) { return vec_of(-a.x, -a.y, -a.z); }
FN vec times_plus(vec a, real s, vec b) {
    return vec_of(TIMES_PLUS(a.x, s, b.x), TIMES_PLUS(a.y, s, b.y), TIMES_PLUS(a.z, s, b.z));
}
FN real inner(vec a, vec b) { return TIMES_PLUS(a.z, b.z, TIMES_PLUS(a.y, b.y, a.x * b.x)); }
FN vec outer(vec a, vec b) {
    return vec_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
FN vec unit_vector(vec a) { return times(a, 1.0 / SQUARE_ROOT(inner(a, a))); }
FN real largest_of(vec a) { return larger(larger(MAGNITUDE(a.x), MAGNITUDE(a.y)), MAGNITUDE(a.z)); }
FN vec vec_at(GLOBAL const stored *p) { return vec_of((real)p[0], (real)p[1], (real)p[2]); }

FN rgb rgb_of(real r, real g, real b) { rgb c; c.r = r; c.g = g; c.b = b; return c; }
FN rgb grey(real x) { return rgb_of(x, x, x); }
FN rgb mixed(rgb a, rgb b) { return rgb_of(a.r + b.r, a.g + b.g, a.b + b.b); }
FN rgb filtered(rgb a, rgb b) { return rgb_of(a.r * b.r, a.g * b.g, a.b * b.b); }
FN rgb dimmed(rgb a, real s) { return rgb_of(a.r * s, a.g * s, a.b * s); }
FN int is_black(rgb c) { return c.r == 0.0 && c.g == 0.0 && c.b == 0.0; }
FN int has_light(rgb c) { return c.r > 0.0 || c.g > 0.0 || c.b > 0.0; }
FN rgb rgb_at(GLOBAL const stored *p) { return rgb_of((real)p[0], (real)p[1], (real)p[2]); }
FN real max_channel(rgb c) { return larger(larger(c.r, c.g), c.b); }
FN real largest_channel(rgb c) {
    real larger_of_two = c.r < c.g ? c.g : c.r;
    return larger_of_two < c.b ? c.b : larger_of_two;
}

FN vec along(ray way, real t) { return times_plus(way.direction, t, way.origin); }

// Duff et al. 2017.
FN frame frame_around(vec n) {
    frame f;
    real sign_of_z = WITH_SIGN(1.0, n.z);
    real a = -1.0 / (sign_of_z + n.z);
    real b = n.x * n.y * a;
    f.s = vec_of(TIMES_PLUS(sign_of_z * n.x * n.x, a, 1.0), sign_of_z * b, -(sign_of_z * n.x));
    f.t = vec_of(b, TIMES_PLUS(n.y * n.y, a, sign_of_z), -n.y);
    f.n = n;
    return f;
}
FN vec to_local(const frame *f, vec v) { return vec_of(inner(v, f->s), inner(v, f->t), inner(v, f->n)); }
FN vec to_world(const frame *f, vec v) { return times_plus(f->n, v.z, times_plus(f->t, v.y, times(f->s, v.x))); }

FN vec reflected(vec wo) { return vec_of(-wo.x, -wo.y, wo.z); }
FN vec refracted(vec wo, real eta, real *cos2) {
    *cos2 = TIMES_PLUS(-(eta * eta), 1.0 - wo.z * wo.z, 1.0);
    return vec_of(-(wo.x * eta), -(wo.y * eta), -SQUARE_ROOT(*cos2));
}
FN real schlick(real cosine, real r0) {
    real c = 1.0 - cosine;
    return r0 + (1.0 - r0) * c * c * c * c * c;
}
FN real fresnel(real cosine, real eta) {
    real c = MAGNITUDE(cosine);
    real g2 = (eta - 1.0) * (eta + 1.0) + c * c;
    real g = SQUARE_ROOT(g2 < 0.0 ? 0.0 : g2);
    real sum = g + c, difference = g - c;
    real perpendicular = sum <= 0.0 ? 0.0 : difference / sum;
    real ratio = (c * sum - 1.0) / (c * difference + 1.0);
    real reflectance = 0.5 * perpendicular * perpendicular * (1.0 + ratio * ratio);
    return g2 < 0.0 ? 1.0 : reflectance;
}

// Sine and cosine of u turns.
FN void turn(real u, real *sine, real *cosine) {
    real quarter = (u * 4.0 + TURN_SHIFT) - TURN_SHIFT;
    real x = TIMES_PLUS(quarter, -0.25, u) * TAU;
    real x2 = x * x;
    real s = x * polynomial(SINE_COEFFICIENTS, x2);
    real c = polynomial(COSINE_COEFFICIENTS, x2);
    int first = MAGNITUDE(quarter - 1.0) < 0.5, second = MAGNITUDE(quarter - 2.0) < 0.5;
    int third = MAGNITUDE(quarter - 3.0) < 0.5;
    int odd = first || third;
    real a = odd ? c : s, b = odd ? s : c;
    *sine = (second || third) ? -a : a;
    *cosine = (first || second) ? -b : b;
}

FN vec cosine_hemisphere(pair p) {
    real sine, cosine;
    turn(p.u, &sine, &cosine);
    real r = SQUARE_ROOT(p.v);
    return vec_of(cosine * r, sine * r, SQUARE_ROOT(1.0 - p.v));
}
FN vec uniform_sphere(pair p) {
    real z = 1.0 - 2.0 * p.v;
    real square = 1.0 - z * z;
    real r = SQUARE_ROOT(square < 0.0 ? 0.0 : square);
    real sine, cosine;
    turn(p.u, &sine, &cosine);
    return vec_of(r * cosine, r * sine, z);
}
FN real tent(real u) {
    real r = u * 2.0;
    return r < 1.0 ? SQUARE_ROOT(r) - 1.0 : 1.0 - SQUARE_ROOT(2.0 - r);
}
FN pair concentric_disk(pair p) {
    real x = 2.0 * p.u - 1.0, y = 2.0 * p.v - 1.0, r, turns, sine, cosine;
    pair at;
    if (x == 0.0 && y == 0.0) {
        at.u = at.v = 0.0;
        return at;
    }
    if (MAGNITUDE(x) > MAGNITUDE(y)) {
        r = x;
        turns = 0.125 * (y / x);
    } else {
        r = y;
        turns = 0.25 - 0.125 * (x / y);
    }
    turn(turns, &sine, &cosine);
    at.u = r * cosine;
    at.v = r * sine;
    return at;
}

// Distance at which a ray that starts on a sphere and goes inside meets it again; `f` is the ray's start relative to the centre.
FN real other_root(vec f, vec direction) { return 2.0 * MAGNITUDE(inner(f, direction)); }
FN real first_root(vec f, vec direction, real r) {
    real b = -inner(f, direction);
    vec closest = times_plus(direction, b, f);
    real discriminant = r * r - inner(closest, closest);
    real q = b + WITH_SIGN(SQUARE_ROOT(discriminant), b);
    real c = inner(f, f) - r * r;
    return (0.0 < q && c <= 0.0) ? q : c / q;
}
// Distance to a plane; not above zero if the ray misses it.
FN real plane_root(vec to_plane, vec direction, vec normal) {
    real t = inner(to_plane, normal) / inner(direction, normal);
    return t < INFINITE ? t : -1.0;
}
// Distance along the z axis to a triangle; below zero if it misses.
FN real triangle_root(vec a, vec b, vec c) {
    real u = across(c.x, c.y, b.x, b.y), v = across(a.x, a.y, c.x, c.y), w = across(b.x, b.y, a.x, a.y);
    int front = 0.0 <= u && 0.0 <= v && 0.0 <= w;
    int back = u <= 0.0 && v <= 0.0 && w <= 0.0;
    real determinant = u + v + w;
    real t = (u * a.z + v * b.z + w * c.z) / determinant;
    int has_area = determinant < 0.0 || 0.0 < determinant;
    return (front || back) && has_area ? t : -1.0;
}
FN real power_heuristic(real a, real b) {
    real ratio = b / a;
    return 1.0 / (1.0 + ratio * ratio);
}

// The ray's own axes: the components that become x, y and z, and the shear.
typedef struct { int x, y, z; real sx, sy, sz; } shear;
FN real component(vec v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
FN shear axes_of(vec d) {
    shear by;
    real x = MAGNITUDE(d.x), y = MAGNITUDE(d.y), z = MAGNITUDE(d.z);
    if (x > y && x > z) {
        by.x = 1; by.y = 2; by.z = 0;
    } else if (y > z) {
        by.x = 2; by.y = 0; by.z = 1;
    } else {
        by.x = 0; by.y = 1; by.z = 2;
    }
    return by;
}
FN vec sheared(vec v, const shear *by) {
    real x = component(v, by->x), y = component(v, by->y), z = component(v, by->z);
    return vec_of(x - by->sx * z, y - by->sy * z, by->sz * z);
}
