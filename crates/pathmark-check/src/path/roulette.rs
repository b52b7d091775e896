//! Russian roulette: when it ends paths, that it keeps the mean, and the variance that it adds.

use crate::Trials;
use crate::estimator::{ESTIMATORS, Options, Roulette, any_estimator};
use crate::exact::{Bench, arriving_estimators, critical, every_estimator, full_estimators, with_kernels};
use crate::kernel::Spec;
use crate::math::{Ray, Vec3};
use crate::measure::Outcome;
use crate::rendering::{Moments, run, spec};
use crate::sampling::{Address, SampleKey, Sampler};
use crate::scene::Scene;
use crate::stage::hollow;

fn diffuse(albedo: [f64; 3]) -> String {
    format!("{{ diffuse = {{ albedo = {albedo:?} }} }}")
}

/// A sampler that always returns one number.
struct Always(f64);

impl Sampler for Always {
    fn pair(&self, _at: Address) -> [f64; 2] {
        [self.0; 2]
    }
}

/// A sample of a scene, with `u` as every random number.
fn sample(estimator: &str, options: Options, scene: &Scene, u: f64) -> f64 {
    let ray = Ray { origin: Vec3::new(0.1, 0.2, 0.3), direction: Vec3::new(1.0, 0.0, 0.0) };
    let key = SampleKey { seed: 1, pixel: 0, sample: 0 };
    let found = any_estimator(estimator, options).map(|any| any.estimate(scene, ray, key, &Always(u), &mut ()).r);
    found.unwrap_or(f64::NAN)
}

/// A path survives if the random number is below the survival probability, but not if both are equal, so no path
/// survives black. With roulette from the first vertex on and a cut after 3 bounces, a path that always survives finds
/// 4 vertices of weight 1.
pub(super) fn at_the_chance(trials: &mut Trials) {
    let largest = 1.0 - f64::EPSILON / 2.0;
    let below_half = 0.5 - f64::EPSILON / 4.0;
    let roulette = Roulette::parse("albedo:0").ok();
    for (albedo, u, exact) in [
        (0.0, 0.0, 1.0),
        (0.0, largest, 1.0),
        (0.5, 0.0, 4.0),
        (0.5, below_half, 4.0),
        (0.5, 0.5, 1.0),
        (0.5, largest, 1.0),
        (1.0, largest, 4.0),
        (1.0, 0.0, 4.0),
    ] {
        let scene = hollow(&diffuse([albedo; 3]), [1.0; 3]);
        for entry in ESTIMATORS.iter().filter(|entry| entry.roulette.is_some()) {
            let options = Options { max_depth: Some(3), roulette, ..Options::default() };
            let found = sample(entry.name, options, &scene, u);
            trials.close(format!("rho {albedo}, u {u:?}, {}", entry.name), exact, found, 1e-14);
        }
    }
}

/// One ray per path, and exactly the emission of the surface, also by estimators that aim at light or have no roulette.
pub(super) fn black(trials: &mut Trials) {
    let scene = hollow(&diffuse([0.0; 3]), [3.0, 0.0, 0.5]);
    for (estimator, kernel) in with_kernels(every_estimator()) {
        let rules = [None, Some("albedo:5"), Some("albedo:0"), Some("throughput:0"), Some("never")];
        let has_roulette = full_estimators().any(|name| name == estimator);
        for rule in rules.into_iter().filter(|rule| has_roulette || rule.is_none()) {
            let what = format!("{}, {estimator}, {kernel}", rule.unwrap_or("its own rule"));
            let spec = Spec { roulette: rule.map(str::to_string), ..spec(estimator, kernel, [8, 6], 1) };
            let Outcome { film, counts, .. } = run(&scene, spec, 4);
            let others = film.pixels().iter().filter(|pixel| pixel.mean() != [3.0, 0.0, 0.5]).count();
            trials.never(&what, "other pixels", others as u64, 48);
            trials.same(format!("{what}: rays, invalid"), (counts.paths, 0), (counts.rays, counts.invalid));
        }
    }
}

/// Channels of different albedo share one roulette: each keeps its own mean, Le/(1 - rho).
pub(super) fn fair(trials: &mut Trials) {
    let scene = hollow(&diffuse([0.5, 0.9, 0.2]), [1.0, 2.0, 3.0]);
    let mut bench = Bench::new(trials);
    bench.widest = [5e-2, 1e-3];
    for rule in
        ["never", "albedo:0", "albedo:1", "albedo:3", "albedo:5", "throughput:0", "throughput:5", "constant:0.95"]
    {
        bench.roulette = Some(rule.to_string());
        // Without roulette a path of this albedo ends only at the cut, which removes 1e-18 of the light.
        bench.max_depth = (rule == "never").then_some(400);
        bench.each(rule, &scene, arriving_estimators(), &[2.0, 20.0, 3.75]);
    }
}

/// With roulette from the first vertex on, the number of vertices is geometric: deviation sqrt(rho)/(1 - rho). With
/// smallpt's rule, five vertices are certain and the rest has the weight rho^5. The kurtosis of a geometric variate, 9
/// + (1 - rho)^2/rho, gives the standard error of the variance.
pub(super) fn spread(trials: &mut Trials) {
    for (rho, deviation, quick) in [
        (0.1, 0.351_364_184_463_153_4, 128),
        (0.5, std::f64::consts::SQRT_2, 128),
        (0.75, 3.464_101_615_137_754_6, 128),
        (0.9, 9.486_832_980_505_138, 64),
        (0.99, 99.498_743_710_661_99, 16),
        (0.999, 999.499_874_937_460_9, 4),
    ] {
        let rho: f64 = rho;
        let scene = hollow(&diffuse([rho; 3]), [1.0; 3]);
        let spp = trials.times(quick, 128 * quick) as u32;
        let rho5 = rho * rho * rho * rho * rho;
        for (rule, weight) in [("albedo:0", 1.0), ("albedo:5", rho5)] {
            for (estimator, kernel) in with_kernels(arriving_estimators()) {
                let what = format!("rho {rho}, {rule}, {estimator}, {kernel}");
                let roulette = Some(rule.to_string());
                let spec = Spec { roulette, ..spec(estimator, kernel, [32; 2], 22) };
                let Moments { mean, variance, n } = Moments::of(&run(&scene, spec, spp).film, 0);
                let exact = weight * weight * deviation * deviation;
                let z_mean = (mean - 1.0 / (1.0 - rho)) / (exact / n).sqrt();
                let z_variance = (variance / exact - 1.0) / ((8.0 + (1.0 - rho) * (1.0 - rho) / rho) / n).sqrt();
                trials.deviates_below(format!("{what}: mean"), critical(), z_mean);
                trials.deviates_below(format!("{what}: variance"), critical(), z_variance);
            }
        }
    }
}
