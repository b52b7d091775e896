//! Numbers at the ends of [0, 1): through every consumer, and the conversion of bits to numbers below 1: R09, R10, R11.

use super::unguarded::{unit_in_f32, unit_of_all_bits};
use super::{first, keyed};
use crate::bare_scene::every_accelerated_scene;
use crate::estimator::{AnyEstimator, ESTIMATORS, Options, Probe, any_estimator, camera_ray};
use crate::math::{Ray, Rgb, dot};
use crate::sampling::{Address, Independent, Purpose, SampleKey, Sampler, concentric_disk, mix, tent, unit};
use crate::scene::{AllEffects, CAMERA_EXAMPLES, Fog, Scene, SurfaceOrigin};
use crate::stage::{DIFFUSE, named, scene, sphere};
use crate::{Trials, U, critical};

const LAST: f64 = 1.0 - U;
const PAIRS: [[f64; 2]; 9] =
    [[0.0, 0.0], [0.0, LAST], [LAST, 0.0], [LAST, LAST], [0.0, 0.5], [0.5, 0.0], [0.5, LAST], [LAST, 0.5], [U, U]];

/// A sampler that returns extreme pairs.
enum Stub {
    /// The same pair for every use.
    Always([f64; 2]),
    /// A pair by pixel, bounce and purpose, out of all.
    Turns,
    /// The pair at one bounce, and ordinary random numbers at the others.
    Once([f64; 2], u16),
}

impl Sampler for Stub {
    fn pair(&self, at: Address) -> [f64; 2] {
        match self {
            Self::Always(pair) => *pair,
            Self::Turns => {
                let place = u64::from(at.key.pixel) << 24 | u64::from(at.bounce) << 8 | at.purpose as u64;
                PAIRS[mix(place) as usize % PAIRS.len()]
            }
            Self::Once(pair, bounce) if *bounce == at.bounce => *pair,
            Self::Once(..) => Independent.pair(at),
        }
    }
}

pub(super) fn consumers(trials: &mut Trials) {
    cameras_and_lights(trials);
    materials(trials);
    estimators(trials);
}

/// A glowing sphere around everything that the camera sees.
fn room(camera: &str) -> Scene {
    scene(&[camera.to_string(), named("room", &sphere([50.0, 40.0, 60.0], 1e3), DIFFUSE, 1.0)])
}

/// Checks that rays have length 1 and a finite origin, and that each aim has a direction of length 1 and a positive
/// density, or is none.
fn cameras_and_lights(trials: &mut Trials) {
    let (mut rays, mut bad_rays, mut aims, mut bad_aims) = (0, 0, 0, 0);
    for scene in every_accelerated_scene().chain(CAMERA_EXAMPLES.iter().map(|camera| room(camera))) {
        let view = scene.camera.view(16, 12);
        let scene = scene.lit(&view);
        for film in PAIRS {
            for lens in PAIRS {
                for (x, y) in [(0, 0), (15, 0), (0, 11), (15, 11), (8, 6)] {
                    let ray = view.ray::<AllEffects>(x, y, 3, film, || lens);
                    rays += 1;
                    let is_fine = (dot(ray.direction, ray.direction) - 1.0).abs() < 1e-14;
                    bad_rays += u64::from(!is_fine || !dot(ray.origin, ray.origin).is_finite());
                    let (tried, bad) = aimed(&scene, &ray, lens);
                    aims += tried;
                    bad_aims += bad;
                }
            }
        }
    }
    trials.never("cameras", "rays that are not of length 1 or start nowhere", bad_rays, rays);
    trials.never("lights", "aims without a direction of length 1 or a density", bad_aims, aims);
    let inside = PAIRS.iter().flatten().all(|u| (-1.0..=1.0).contains(&tent(*u)));
    trials.holds("pixel filter", "-1 to 1", inside, inside);
    let on_disk = PAIRS.iter().map(|pair| concentric_disk(*pair)).map(|[x, y]| x * x + y * y).fold(0.0, f64::max);
    trials.at_most("place on the lens: square of the radius", 1.0 + 8.0 * U, on_disk);
}

/// The number of aims and of wrong aims, from the point that a ray hits and from half way.
fn aimed(scene: &Scene, ray: &Ray, u: [f64; 2]) -> (u64, u64) {
    let Some(lights) = &scene.lights else { return (0, 0) };
    let Some(hit) = scene.first_of_any(ray, None) else { return (0, 0) };
    let on = SurfaceOrigin { primitive: hit.primitive, inside: hit.inside };
    let (mut tried, mut wrong) = (0, 0);
    for (point, from) in [(hit.point, Some(on)), (ray.at(0.5 * hit.t), None)] {
        for choice in [0.0, LAST] {
            tried += 1;
            wrong += u64::from(lights.aim(point, from, || choice, u).is_some_and(|aim| {
                let is_unit = (dot(aim.direction, aim.direction) - 1.0).abs() < 1e-12;
                !(is_unit && aim.density > 0.0 && aim.density.is_finite())
            }));
        }
    }
    (tried, wrong)
}

/// Tries every material of every scene, for directions from the normal down to grazing, from both sides.
fn materials(trials: &mut Trials) {
    let (mut tried, mut wrong) = (0, 0);
    for object in every_accelerated_scene().flat_map(|scene| scene.objects.into_iter().take(100)) {
        for cos in [1.0, 0.5, 1e-8, 0.0] {
            let wo = crate::math::Vec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
            for (u, inside) in PAIRS.into_iter().flat_map(|u| [(u, false), (u, true)]) {
                tried += 1;
                wrong += u64::from(object.material.sample::<AllEffects>(wo, inside, u).is_some_and(|sample| {
                    let is_unit = (dot(sample.wi, sample.wi) - 1.0).abs() < 1e-14;
                    !is_unit || !sample.weight.is_valid_radiance()
                }));
            }
        }
    }
    trials.never("materials of every scene", "directions not of length 1 or weights that are not finite", wrong, tried);
}

/// Number of rays that hit nothing.
#[derive(Default)]
struct Escapes(u64);

impl Probe for Escapes {
    fn escaped(&mut self) {
        self.0 += 1;
    }
}

/// A sample of a pixel, to be taken by an estimator.
struct Sample<'a> {
    scene: &'a Scene,
    pixel: u32,
    sampler: &'a Stub,
    escapes: &'a mut Escapes,
}

impl Sample<'_> {
    fn by(self, estimator: &dyn AnyEstimator) -> Rgb {
        let Self { scene, pixel, sampler, escapes } = self;
        let view = scene.camera.view(SIZE[0], SIZE[1]);
        let key = SampleKey { seed: 0, pixel, sample: pixel % 4 };
        let place = [pixel % SIZE[0], pixel / SIZE[0]];
        let ray = camera_ray::<Stub, AllEffects, ()>(&view, place, key, 0, sampler, &mut ());
        estimator.estimate(scene, ray, key, sampler, escapes)
    }
}

const SIZE: [u32; 2] = [8, 6];

/// Every path ends and returns valid radiance. A path with an extreme at one bounce does not leave a closed scene. A
/// path with extremes at every vertex may: it creeps into an edge, where the side of a point is undecided.
fn estimators(trials: &mut Trials) {
    let step = trials.times(5, 1) as usize;
    for entry in ESTIMATORS {
        // Numbers of 0 survive every roulette, so paths end at this maximum depth.
        let depth = entry.max_depth.unwrap_or(trials.times(20, 1000) as u16);
        let options = Options { max_depth: Some(depth), ..Options::default() };
        let (mut tried, mut wrong, mut closed, mut leaks) = (0, 0, 0, 0);
        let estimator = any_estimator(entry.name, options).expect("an estimator of the table");
        for scene in every_accelerated_scene() {
            let is_closed = scene.background.is_none() && scene.fog.is_none();
            let lit = scene.lit(&scene.camera.view(SIZE[0], SIZE[1]));
            let scene = if entry.aims { &lit } else { &scene };
            let mut samples = |sampler: &Stub| {
                let mut escapes = Escapes::default();
                for pixel in (0..SIZE[0] * SIZE[1]).step_by(step) {
                    let sample = Sample { scene, pixel, sampler, escapes: &mut escapes };
                    tried += 1;
                    wrong += u64::from(!sample.by(&*estimator).is_valid_radiance());
                }
                escapes.0
            };
            PAIRS.map(Stub::Always).iter().chain([&Stub::Turns]).for_each(|stub| {
                samples(stub);
            });
            for bounce in 0..4 {
                let found: u64 = PAIRS.iter().map(|pair| samples(&Stub::Once(*pair, bounce))).sum();
                closed += u64::from(is_closed);
                leaks += if is_closed { found } else { 0 };
            }
        }
        trials.never(
            format!("{}, every scene", entry.name),
            "samples that are NaN, infinite or negative",
            wrong,
            tried,
        );
        trials.never(format!("{}, closed scenes", entry.name), "rays that got out", leaks, closed);
    }
}

/// -ln(u) is unbounded at 0, -ln(1 - u) at 1. With u < 1 the latter is at most 53 ln 2, and it is exact where u is
/// small.
pub(super) fn free_paths(trials: &mut Trials) {
    trials.same("-ln(u) at 0", &f64::INFINITY, &(-libm::log(0.0)));
    let fog = |scattering: f64| Fog { absorption: Rgb::BLACK, scattering, emission: Rgb::BLACK };
    for scattering in [1e-100, 1e-3, 1.0, 1e100] {
        let path = |u: f64| fog(scattering).free_path(|| u) * scattering;
        trials.close(format!("scattering {scattering:e}: at 0"), 0.0, path(0.0), 0.0);
        trials.close(format!("scattering {scattering:e}: at 2^-53"), U, path(U), 1e-30);
        trials.close(format!("scattering {scattering:e}: at 1/2"), std::f64::consts::LN_2, path(0.5), 4.0 * U);
        trials.close(format!("scattering {scattering:e}: at 1 - 2^-53"), 36.736_800_569_677_1, path(LAST), 1e-13);
    }
    trials.same("no scattering, no number drawn", &f64::INFINITY, &fog(0.0).free_path(|| f64::NAN));
    for (name, sampler) in keyed() {
        let n = trials.times(100_000, 10_000_000) as u32;
        let paths = (0..n).map(|pixel| fog(2.0).free_path(|| first(&*sampler, 1, pixel, 0, (1, Purpose::Medium))[0]));
        let (mut sum, mut wrong) = (0.0, 0);
        for path in paths {
            sum += path;
            wrong += u64::from(!(path >= 0.0 && path.is_finite()));
        }
        trials.never(name, "free paths that are negative or endless", wrong, n.into());
        // An exponential distribution with mean 1/2 has standard deviation 1/2.
        let z = (sum / f64::from(n) - 0.5) / (0.5 / f64::from(n).sqrt());
        trials.deviates_below(format!("{name}: mean free path"), critical(3), z);
    }
    let by_unit = (0..1000).map(|k| fog(1.0).free_path(|| unit(u64::MAX - (k << 11)))).all(f64::is_finite);
    trials.holds("the largest 1000 numbers", "finite", by_unit, by_unit);
}

/// Multiplying all 64 bits, or 32 bits in single precision, rounds the largest integers up to 1. The top 53 bits as a
/// multiple of 2^-53 stay below.
pub(super) fn below_one(trials: &mut Trials) {
    let n = trials.times(1 << 20, 1 << 26);
    let outside =
        (0..n).filter(|k| !(0.0..1.0).contains(&unit(*k)) || !(0.0..1.0).contains(&unit(u64::MAX - k))).count();
    trials.never("53 bits, both ends", "numbers outside of [0, 1)", outside as u64, 2 * n);
    trials.close("53 bits, the largest", 1.0 - 0.5 * f64::EPSILON, unit(u64::MAX), 0.0);
    trials.close("53 bits, the smallest above 0", 0.5 * f64::EPSILON, unit(1 << 11), 0.0);
    let ones = (0..1 << 20).filter(|k| unit_in_f32(u32::MAX - k) >= 1.0).count();
    trials.same("32 bits in f32: integers that become 1", &128, &ones);
    trials.same(
        "32 bits in f32: the first of them",
        &(true, false),
        &(unit_in_f32(0xFFFF_FF80) == 1.0, unit_in_f32(0xFFFF_FF7F) == 1.0),
    );
    let ones = (0..1 << 20).filter(|k| unit_of_all_bits(u64::MAX - k) >= 1.0).count();
    trials.same("64 bits in f64: integers that become 1", &1024, &ones);
    trials.same("0.99999999 in f32", &1.0, &(0.999_999_99_f64 as f32));
    for (name, sampler) in keyed() {
        let mut outside = 0;
        let tried = trials.times(50_000, 5_000_000) as u32;
        for k in 0..tried {
            for (sample, purpose) in [(k, Purpose::Film), (u32::MAX - k, Purpose::Bsdf)] {
                let numbers = first(&*sampler, u64::from(k), !k, sample, (k as u16, purpose));
                outside += u64::from(!numbers.iter().all(|u| (0.0..1.0).contains(u)));
            }
        }
        trials.never(
            format!("{name}, first and last samples"),
            "numbers outside of [0, 1)",
            outside,
            2 * u64::from(tried),
        );
    }
}
