//! Heavy tails: a few samples dominate the estimate.

use super::draw::Draw;
use crate::Trials;
use crate::analysis::tail::tail;
use crate::exact::critical;
use crate::kernel::{Spec, inspect};
use crate::scene::{Scene, load};
use crate::stage::{diffuse, hollow};
use std::sync::Arc;

/// Samples of a small image, grouped by pixel.
fn samples(scene: Scene, spp: u32, roulette: Option<String>) -> Vec<Vec<f64>> {
    let spec = Spec { width: 8, height: 6, estimator: "bsdf".to_string(), roulette, ..Spec::default() };
    let inspector = inspect(&Arc::new(scene), &spec).expect("what looks into samples");
    let pixel = |index: u32| (0..spp).map(|k| inspector.estimate(index % 8, index / 8, k, &mut ()).g).collect();
    (0..48).map(pixel).collect()
}

fn kurtosis(groups: &[Vec<f64>]) -> f64 {
    tail(groups.iter().map(Vec::as_slice)).map_or(f64::NAN, |tail| tail.kurtosis)
}

/// The kurtosis is (q^3 + p^3)/(p q) for a light that one sample in a hundred finds, 1 for a coin, 1.8 for a uniform
/// number, 3 for a normal one, and 9.5 for the number of vertices under roulette at rho = 1/2. It is far larger in
/// smallpt's box, where paths find a small lamp through glass.
pub(super) fn heavy_tails(trials: &mut Trials) {
    let coin: Vec<f64> = (0..100).map(|k| f64::from(k % 2)).collect();
    trials.close("a coin", 1.0, kurtosis(&[coin]), 1e-12);
    let rare: Vec<f64> = (0..1000).map(|k| if k % 100 == 0 { 12.0 } else { 0.0 }).collect();
    let (p, q) = (0.01_f64, 0.99_f64);
    trials.close("one in a hundred", (q * q * q + p * p * p) / (p * q), kurtosis(std::slice::from_ref(&rare)), 1e-9);
    let share = tail([rare.as_slice()]).map_or(f64::NAN, |tail| tail.largest_share);
    trials.close("one in a hundred: share of the largest of ten", q / 10.0, share, 1e-12);

    let n = trials.times(100_000, 10_000_000);
    let mut draw = Draw::new(7);
    let normal: Vec<f64> = (0..n).map(|_| draw.normal()).collect();
    trials.deviates_below("normal", critical(), (kurtosis(&[normal]) - 3.0) / (24.0 / n as f64).sqrt());
    let uniform: Vec<f64> = (0..n).map(|_| draw.uniform()).collect();
    // The standard error follows from the moments of a uniform number up to the eighth.
    trials.deviates_below("uniform", critical(), (kurtosis(&[uniform]) - 1.8) / (0.2 / n as f64).sqrt());

    let spp = trials.times(1000, 50_000) as u32;
    let found = kurtosis(&samples(hollow(&diffuse(0.5), [1.0; 3]), spp, Some("albedo:0".to_string())));
    trials.holds("vertices up to roulette", "9.5 +- 2", format_args!("{found:.2}"), (found - 9.5).abs() < 2.0);
    let cornell = load("cornell").expect("a shipped scene");
    let found = kurtosis(&samples(cornell, spp, None));
    trials.holds("smallpt's box", "more than 20", format_args!("{found:.0}"), found > 20.0);
}
