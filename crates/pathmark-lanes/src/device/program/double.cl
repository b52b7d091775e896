// Functions that differ in double precision.

typedef double stored;  // numbers in tables, in either precision of the path
typedef double exact;   // sums of samples
#define UNIT(bits) ((real)((bits) >> 11) * UNIT_STEP)
#define TIMES_PLUS(a, factor, addend) ((a) * (factor) + (addend))

FN real linear(real a, real b, real x) { return b * x + a; }
FN real polynomial(real c0, real c1, real c2, real c3, real c4, real c5, real c6, real c7, real c8, real x) {
    real x2 = x * x, x4 = x2 * x2;
    real low = linear(c2, c3, x) * x2 + linear(c0, c1, x);
    real high = linear(c6, c7, x) * x2 + linear(c4, c5, x);
    return (c8 * x4 + high) * x4 + low;
}
FN real across(real px, real py, real qx, real qy) { return px * qy - py * qx; }
