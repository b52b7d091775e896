//! The double-double oracle compared with exact integers, on 1e4 of the rays that it judges.

use super::bulk::aimed;
use super::exact::Exact;
use crate::U;
use crate::fixed_point_tests::{UNIT, cross, dot, fixed, fixed_vector};
use crate::random::Random;
use num_bigint::{BigInt, Sign};

/// Checks hit or miss by the exact sign of a r² - |f x d|². Checks each root t to within a rounding: |a t² - 2 b t +
/// c| = a |t - t0| |t - t1| is so small that one of the exact roots is that near, and the two roots are near different
/// ones.
#[test]
fn ten_thousand_answers_are_right() {
    let mut random = Random::new(0x5EED);
    let (mut hits, mut misses) = (0, 0);
    for k in 0..10_000 {
        let (f, unit, r) = aimed(&mut random);
        let d = if k % 4 == 3 { unit * random.scale(-3.0, 3.0) } else { unit };
        let length = crate::math::dot(d, d).sqrt();
        let found = Exact::of(f, d, r);
        let (f, d, radius) = (fixed_vector(f), fixed_vector(d), fixed(r));
        let (a, b, c) = (dot(&d, &d), -dot(&f, &d), dot(&f, &f) - &radius * &radius);
        let moment = cross(&f, &d);
        let moment = dot(&moment, &moment);
        let discriminant = &a * &radius * &radius - &moment;
        assert_eq!(found.roots.is_some(), discriminant.sign() != Sign::Minus, "ray {k}");

        let line = fixed(found.line);
        let off = (&line * &line * &a - &moment).magnitude().clone();
        assert!(BigInt::from(off) << 50 <= moment, "ray {k}: the line's distance");

        let Some(roots) = found.roots else {
            misses += 1;
            continue;
        };
        hits += 1;
        let apart = roots[1] - roots[0];
        for root in roots {
            let t = fixed(root);
            let polynomial: BigInt = &a * &t * &t - ((2 * &b * &t) << UNIT) + (&c << (2 * UNIT));
            let near = 1.25 * U * root.abs() + U / 16.0 * r / length;
            let allowed: BigInt = (&a * fixed(near * apart.max(near))) << UNIT;
            assert!(polynomial.magnitude() <= allowed.magnitude(), "ray {k}: {root:e} of {roots:?}");
        }
    }
    assert!(hits > 5000 && misses > 500, "{hits} {misses}");
}
