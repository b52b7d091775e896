//! Noisy references do not inflate the measured error.

use pathmark::experiment::reference_seed;
use pathmark::image_io::Image;
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup, available_threads};
use pathmark::metric::cross_mse;

fn render(spp: u32, seed: u64) -> Image {
    let settings = Settings {
        scene: "cornell".to_string(),
        spp,
        spec: Spec { width: 48, height: 36, seed, estimator: "bsdf".to_string(), ..Spec::default() },
        decomposition: "tiles:8x8".to_string(),
        strategy: "work-stealing".to_string(),
        threads: available_threads(),
        ..Settings::default()
    };
    Setup::prepare(settings).unwrap().run(None).unwrap().film.image()
}

/// With a reference of as many samples, a plain squared error is twice the image's own. The cross form of two such
/// halves agrees within 10 % with the cross form of halves with a hundred times the samples.
#[test]
fn noisy_references_do_not_inflate_the_error() {
    let halves = [0, 1].map(|half| render(20, reference_seed(half)));
    let good = [2, 3].map(|half| render(2000, reference_seed(half)));
    let mean = |references: &[Image; 2]| {
        let seeds = 1..=12_u64;
        let count = seeds.clone().count() as f64;
        seeds.map(|seed| cross_mse(&render(20, seed), &references[0], &references[1]).unwrap()).sum::<f64>() / count
    };
    let ratio = mean(&halves) / mean(&good);
    assert!((0.9..1.1).contains(&ratio), "cross form against noisy and good references: {ratio}");
}
