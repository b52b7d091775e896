//! Samplers that are wrong on purpose: what the images of experiments/mistakes.toml have in common with their closed form.

use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};

const HEIGHT: u32 = 12;

/// The rows of an image of the scene `hollow`, all of whose pixels have the same integrand, as sums.
fn rows(sampler: &str, strategy: &str, threads: usize) -> Vec<Vec<[f64; 3]>> {
    let (sampler, kernel, roulette) = (sampler.into(), "scalar".into(), Some("albedo:0".into()));
    let estimator = "bsdf".into();
    let spec = Spec { width: 8, height: HEIGHT, seed: 3, estimator, sampler, kernel, roulette, ..Spec::default() };
    let (scene, strategy, decomposition) = ("hollow".into(), strategy.into(), "rows".into());
    let settings = Settings { scene, spp: 4, spec, strategy, threads, decomposition, ..Settings::default() };
    let outcome = Setup::prepare(settings).unwrap().run(None).unwrap();
    let sums: Vec<[f64; 3]> = outcome.film.pixels().iter().map(|pixel| pixel.sum).collect();
    sums.chunks_exact(8).map(<[_]>::to_vec).collect()
}

/// With the same seed in T threads, the image is T copies of its first share, which one thread renders, too: the variance of
/// its mean is T times that of independent threads, and no pixel is noisier than before. Other samplers have no copies.
#[test]
fn the_same_seed_in_every_thread_makes_copies() {
    let alone = rows("same-seed", "serial", 1);
    for threads in [1, 2, 3, 4] {
        let found = rows("same-seed", "static-blocks", threads);
        let share = HEIGHT as usize / threads;
        for own in found.chunks_exact(share) {
            assert_eq!(own, &alone[..share], "{threads} threads");
        }
        for sampler in ["per-thread", "padded", "unpadded"] {
            let found = rows(sampler, "static-blocks", threads);
            let copies = found.chunks_exact(share).skip(1).filter(|own| **own == found[..share]);
            assert_eq!(copies.count(), 0, "{sampler}, {threads} threads");
        }
    }
}
