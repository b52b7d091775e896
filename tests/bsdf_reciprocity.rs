//! H26: light that goes back the way it came is worth the same, to 1e-12, for 1e6 pairs of directions each, where the model says so; and the
//! one model that does not say so, `kd-ks`, is what its documentation says.

#[path = "support/materials.rs"]
mod materials;

use materials::{every_material, material};
use pathmark::math::{Vec3, fresnel_dielectric};
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler, uniform_sphere};
use pathmark::scene::AllEffects;

fn directions(sample: u32) -> [Vec3; 2] {
    [Purpose::Bsdf, Purpose::Film].map(|purpose| {
        let key = SampleKey { seed: 5, pixel: 0, sample };
        let d = uniform_sphere(Independent.pair(Address { key, bounce: 1, branch: 0, purpose })).normalized();
        Vec3 { z: d.z.abs(), ..d }
    })
}

#[test]
fn directions_may_change_places() {
    let mut tested = 0;
    for (name, material) in every_material().into_iter().filter(|(name, _)| !name.contains("kd-ks")) {
        tested += 1;
        for sample in 0..1_000_000 {
            let [a, b] = directions(sample);
            let there = material.eval::<AllEffects>(a, b).channels();
            let back = material.eval::<AllEffects>(b, a).channels();
            for (there, back) in there.into_iter().zip(back) {
                assert!((there - back).abs() <= 1e-12 * there, "{name}: {there} and {back} between {a:?} and {b:?}");
            }
        }
    }
    assert!(tested >= 11, "only {tested} materials");
}

/// f(a, b) differs from f(b, a) just as F(a) differs from F(b): with a black body the ratio of the two is that of the reflectances.
#[test]
fn kd_ks_is_not_reciprocal() {
    let facets = material("{ kd-ks = { kd = [0.0, 0.0, 0.0], eta = 12.85, roughness = 0.5 } }");
    let mut widest: f64 = 1.0;
    for sample in 0..100_000 {
        let [a, b] = directions(sample);
        let ratio = facets.eval::<AllEffects>(a, b).r / facets.eval::<AllEffects>(b, a).r;
        let expected = fresnel_dielectric(a.z, 12.85) / fresnel_dielectric(b.z, 12.85);
        assert!((ratio / expected - 1.0).abs() < 1e-12, "{ratio}, not {expected}");
        widest = widest.max(ratio);
    }
    assert!(widest > 1.3, "{widest}");
}
