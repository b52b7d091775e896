// Functions that differ in single precision. The other formulas are those of double precision, with names that end in _s.

typedef float single;
#define SQUARE_ROOT_S(x) SINGLE_SQUARE_ROOT(x)
#define MAGNITUDE_S(x) SINGLE_MAGNITUDE(x)
#define WITH_SIGN_S(x, sign) SINGLE_WITH_SIGN(x, sign)
#define INFINITE_S ((single)INFINITE)
#define TIMES_PLUS_S(a, factor, addend) FUSED(a, factor, addend)
#define UNIT_S(bits) ((single)((bits) >> 40) * UNIT_STEP_S)

FN single linear_s(single a, single b, single x) { return FUSED(b, x, a); }
// The first term left out is below 3e-8.
FN single polynomial_s(single c0, single c1, single c2, single c3, single c4, single x) {
    single x2 = x * x, x4 = x2 * x2;
    single low = FUSED(linear_s(c2, c3, x), x2, linear_s(c0, c1, x));
    return FUSED(c4, x4, low);
}
// Twice an area, correct except for the last digit.
FN single across_s(single px, single py, single qx, single qy) {
    single product = py * qx;
    single lost = FUSED(-py, qx, product);
    return FUSED(px, qy, -product) + lost;
}
