//! Gain from aiming at light and from spreading samples, measured by the variance of images over seeds.

use pathmark::analysis::fit::log_log;
use pathmark::check::stage::{diffuse, object, plane, scene, sphere, view};
use pathmark::film::Film;
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};
use pathmark::scene::{Scene, load};
use std::sync::Arc;

fn film(scene: &Arc<Scene>, (width, height): (u32, u32), estimator: &str, sampler: &str, spp: u32, seed: u64) -> Film {
    let (estimator, sampler) = (estimator.into(), sampler.into());
    let spec = Spec { width, height, seed, estimator, sampler, ..Spec::default() };
    let (decomposition, strategy) = ("rows".into(), "shared-counter".into());
    let settings = Settings { spp, spec, decomposition, strategy, threads: 2, ..Settings::default() };
    Setup::for_scene(Arc::clone(scene), settings).unwrap().run(None).unwrap().film
}

/// The variance of a pixel's estimate over so many seeds, averaged over pixels and channels.
fn variance(scene: &Arc<Scene>, size: (u32, u32), estimator: &str, sampler: &str, spp: u32, seeds: u64) -> f64 {
    let images: Vec<_> =
        (0..seeds).map(|seed| film(scene, size, estimator, sampler, spp, 100 + seed).image().pixels).collect();
    let n = seeds as f64;
    let mut total = 0.0;
    for pixel in 0..images[0].len() {
        for channel in 0..3 {
            let values: Vec<f64> = images.iter().map(|image| image[pixel][channel]).collect();
            let mean = values.iter().sum::<f64>() / n;
            total += values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0);
        }
    }
    total / (3 * images[0].len()) as f64
}

/// A6: a lamp over a plane, aimed at by its cone of directions. The light is smooth in all four numbers of a sample,
/// film and light. Sobol points over all four together give far steeper slopes than over each pair separately, which
/// gives about -0.65. Weighting against directions that miss the lamp (`mis`) makes the light less smooth. Independent
/// samples have the slope -1/2.
#[test]
fn sobol_is_steep_where_light_is_smooth() {
    let floor = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    let lamp = object(&sphere([0.0, 2.0, 0.0], 0.5), &diffuse(0.0), [1.0; 3]);
    let view = view([3.0, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 16.0);
    let scene = Arc::new(scene(&[view, floor, lamp]));
    let spps = [16_u32, 32, 64, 128, 256, 512, 1024];
    let slope = |estimator: &str, sampler: &str| {
        let points = spps.map(|spp| (f64::from(spp), variance(&scene, (4, 4), estimator, sampler, spp, 16).sqrt()));
        log_log(&points, 0.95).unwrap().slope.value
    };
    let (nee, mis, independent) = (slope("nee", "sobol"), slope("mis", "sobol"), slope("mis", "independent"));
    println!("slopes: nee {nee:.3}, mis {mis:.3}, independent {independent:.3}");
    assert!(nee < -1.1, "{nee}");
    assert!(mis < -0.7, "{mis}");
    assert!((independent + 0.5).abs() < 0.1, "{independent}");
}

/// On smallpt's box, aiming at the visible part of the lamp is worth several times as many samples. Some paths through
/// glass carry much light, so the ratios vary with the seeds, and the limits are below the ratios of longer runs.
#[test]
fn aiming_pays_on_smallpts_box() {
    let scene = Arc::new(load("cornell").unwrap());
    let of = |estimator, sampler| variance(&scene, (48, 36), estimator, sampler, 64, 8);
    let (smallpt, mis, sobol) = (of("smallpt", "independent"), of("mis", "independent"), of("mis", "sobol"));
    println!("variance of smallpt is {:.2} times that of mis, {:.2} times with sobol", smallpt / mis, smallpt / sobol);
    assert!(smallpt > 2.5 * mis && smallpt > 5.0 * sobol, "{smallpt} {mis} {sobol}");
}
