//! The sphere formula: smallpt's formula loses its accuracy for small spheres far away and for huge ones nearby.

use super::{Guard, InRender, Measured, Often, Variant};
use crate::math::{Vec3, first_root, roots};
use crate::random::Random;
use crate::sphere::bulk::aimed;
use crate::sphere::exact::Exact;
use crate::sphere::formulas::{smallpt_first_root, smallpt_roots};

pub(super) const GUARD: Guard = Guard {
    name: "sphere formula",
    error: "share of roots outside the bound, spheres of 1e-6 to 1e8 up to 1e8 radii away",
    operation: "a ray against a sphere",
    in_render: InRender { scene: "cornell", often: Often::Test(1.0) },
    with: Variant {
        name: "closest approach, c/q",
        error: || error(|f, d, r| roots(f, d, 1.0, r)),
        work: |count| work(count, |f, d, r| first_root(f, d, 1.0, r)),
    },
    without: Variant {
        name: "smallpt's",
        error: || error(smallpt_roots),
        work: |count| work(count, |f, d, r| smallpt_first_root(f, d, r, 0.0)),
    },
};

fn error(roots: impl Fn(Vec3, Vec3, f64) -> (f64, f64)) -> Measured {
    let mut random = Random::new(83);
    let (mut outside, mut all) = (0, 0);
    for _ in 0..100_000 {
        let (f, d, r) = aimed(&mut random);
        let exact = Exact::of(f, d, r);
        let Some(expected) = exact.roots else { continue };
        // So near to the silhouette rounding may turn a hit into a miss, and the reverse.
        if (r - exact.line).abs() <= Exact::band(f, r) {
            continue;
        }
        let (near, far) = roots(f, d, r);
        for (found, expected) in [(near, expected[0]), (far, expected[1])] {
            all += 1;
            let within = (found - expected).abs() <= exact.bound(f, d, r, expected);
            outside += u64::from(!within);
        }
    }
    Measured::share(outside, all)
}

fn work(count: u64, first: impl Fn(Vec3, Vec3, f64) -> f64) -> f64 {
    let mut random = Random::new(84);
    let rays: [(Vec3, Vec3, f64); 64] = std::array::from_fn(|_| aimed(&mut random));
    let mut sum = 0.0;
    for k in 0..count as usize {
        let (f, d, r) = rays[k % 64];
        let t = first(f, d, r);
        sum += if t > 0.0 { t } else { 1.0 };
    }
    sum
}
