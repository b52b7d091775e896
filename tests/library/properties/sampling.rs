//! Samplers, warps, materials and sums.

use super::{cases, pair};
use pathmark::check::materials::every_material;
use pathmark::film::{PixelSum, SAMPLE_BLOCK, SampleSum};
use pathmark::material::Density;
use pathmark::math::{Rgb, Vec3, dot, sin_cos_turns};
use pathmark::sampling::{
    Address, Purpose, SAMPLERS, SampleKey, Sampler, concentric_disk, cosine_hemisphere, keyed_sampler, tent,
    uniform_sphere,
};
use pathmark::scene::AllEffects;
use proptest::prelude::*;

fn address() -> impl Strategy<Value = Address> {
    let key =
        (any::<u64>(), any::<u32>(), any::<u32>()).prop_map(|(seed, pixel, sample)| SampleKey { seed, pixel, sample });
    let place = (any::<u16>(), any::<u16>(), prop::sample::select(&Purpose::ALL));
    (key, place).prop_map(|(key, (bounce, branch, purpose))| Address { key, bounce, branch, purpose })
}

fn length(v: Vec3) -> f64 {
    dot(v, v).sqrt()
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn samplers_are_functions_into_the_unit_square(at in address()) {
        for entry in SAMPLERS.iter().filter(|entry| entry.deterministic) {
            let sampler = keyed_sampler(entry.name).expect("a sampler of the table");
            let [first, second] = [sampler.pair(at), sampler.pair(at)];
            prop_assert!(first.iter().all(|u| (0.0..1.0).contains(u)), "{}: {first:?}", entry.name);
            prop_assert_eq!(first.map(f64::to_bits), second.map(f64::to_bits), "{}", entry.name);
        }
    }

    #[test]
    fn warps_stay_where_they_belong(u in pair()) {
        let hemisphere = cosine_hemisphere(u);
        prop_assert!(hemisphere.z >= 0.0 && (length(hemisphere) - 1.0).abs() < 1e-14, "{hemisphere:?}");
        prop_assert!((length(uniform_sphere(u)) - 1.0).abs() < 1e-14);
        let [x, y] = concentric_disk(u);
        prop_assert!(x * x + y * y <= 1.0 + 1e-14);
        prop_assert!((-1.0..=1.0).contains(&tent(u[0])));
    }

    /// Adding half a turn gives the opposite side, at the same height.
    #[test]
    fn half_a_turn_further_is_opposite([u, v] in pair()) {
        let (here, there) = (cosine_hemisphere([0.5 * u, v]), cosine_hemisphere([0.5 * u + 0.5, v]));
        prop_assert!((here.x + there.x).abs() < 1e-14 && (here.y + there.y).abs() < 1e-14);
        prop_assert_eq!(here.z.to_bits(), there.z.to_bits());
    }
}

proptest! {
    #![proptest_config(cases(600))]

    /// Every sampled direction has length 1 and lies on the right side, and its weight is finite and at least zero in
    /// each channel.
    #[test]
    fn materials_choose_directions(cos in 1e-3..=1.0_f64, turns in 0.0..1.0_f64, inside in any::<bool>(), u in pair()) {
        let (s, c) = sin_cos_turns(turns);
        let rim = (1.0 - cos * cos).max(0.0).sqrt();
        let wo = Vec3::new(rim * c, rim * s, cos);
        for (name, material) in every_material() {
            let Some(sample) = material.sample::<AllEffects>(wo, inside, u) else { continue };
            prop_assert!((length(sample.wi) - 1.0).abs() < 1e-12, "{name}: {sample:?}");
            prop_assert!(sample.weight.channels().iter().all(|w| w.is_finite() && *w >= 0.0), "{name}: {sample:?}");
            if let Density::PerSolidAngle(density) = sample.density {
                let (pdf, value) = (material.pdf::<AllEffects>(wo, sample.wi), material.eval::<AllEffects>(wo, sample.wi));
                prop_assert!(density > 0.0 && density.is_finite() && sample.wi.z > 0.0, "{name}: {sample:?}");
                prop_assert!(pdf >= 0.0 && value.channels().iter().all(|f| *f >= 0.0 && f.is_finite()), "{name}: {pdf} {value:?}");
            }
        }
    }
}

fn sum(values: &[[f64; 3]]) -> PixelSum {
    let mut sum = SampleSum::default();
    for value in values {
        sum.add(Rgb::from(*value));
    }
    sum.total()
}

proptest! {
    #![proptest_config(cases(300))]

    /// A pixel's samples may be divided into parts of 2^k blocks each: the sum has the same bits, and is right.
    #[test]
    fn sums_do_not_depend_on_who_adds_them(
        values in prop::collection::vec(prop::array::uniform3(0.0..1e6_f64), 1..300), level in 0..5_u32,
    ) {
        let part = (SAMPLE_BLOCK << level) as usize;
        let whole = sum(&values);
        // Parts are combined like the digits of a binary counter, as the sum of single blocks is.
        let mut trees: Vec<(usize, PixelSum)> = Vec::new();
        for chunk in values.chunks(part) {
            let mut tree = (1, sum(chunk));
            while chunk.len() == part && let Some((_, left)) = trees.pop_if(|(leaves, _)| *leaves == tree.0) {
                tree = (2 * tree.0, left.plus(&tree.1));
            }
            trees.push(tree);
        }
        let found = trees.into_iter().map(|(_, tree)| tree).rev().reduce(|later, tree| tree.plus(&later)).expect("a part");
        prop_assert_eq!(found, whole);
        for channel in 0..3 {
            let exact: f64 = values.iter().map(|value| value[channel]).sum();
            prop_assert!((whole.sum[channel] - exact).abs() <= 1e-13 * exact, "{} {exact}", whole.sum[channel]);
        }
        prop_assert_eq!(whole.count as usize, values.len());
    }
}
