//! Unused effects cost a scene nothing: their code does not run, even if it is compiled in, and no random number is
//! drawn for them.

use pathmark::effect::Effects;
use pathmark::estimator::{AnyEstimator, ESTIMATORS, Options, Probe, any_estimator, camera_ray};
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler};
use pathmark::scene::{
    AllEffects, BACKGROUND, COMPOUND, FAULTS, FOG, HIERARCHY, LENS, PRIMITIVES, SCENES, Scene, effect_names, load,
};
use std::sync::atomic::{AtomicU64, Ordering};

const SIDE: u32 = 12;

/// The effects whose code ran.
#[derive(Default)]
struct Used(Effects);

impl Probe for Used {
    fn used(&mut self, effect: Effects) {
        self.0 = self.0.and(effect);
    }
}

/// Counts the random numbers drawn for lenses and for media.
#[derive(Default)]
struct Drawn {
    lens: AtomicU64,
    medium: AtomicU64,
}

impl Sampler for Drawn {
    fn pair(&self, at: Address) -> [f64; 2] {
        match at.purpose {
            Purpose::Lens => self.lens.fetch_add(1, Ordering::Relaxed),
            Purpose::Medium => self.medium.fetch_add(1, Ordering::Relaxed),
            _ => 0,
        };
        Independent.pair(at)
    }
}

/// Takes a few samples of a scene with every effect compiled in.
fn look(scene: &Scene, estimator: &dyn AnyEstimator) -> (Effects, [u64; 2]) {
    let view = scene.camera.view(SIDE, SIDE);
    let (mut used, drawn) = (Used::default(), Drawn::default());
    for pixel in 0..SIDE * SIDE {
        let key = SampleKey { seed: 11, pixel, sample: pixel % 4 };
        let at = [pixel % SIDE, pixel / SIDE];
        let ray = camera_ray::<_, AllEffects, _>(&view, at, key, 0, &drawn, &mut used);
        estimator.estimate(scene, ray, key, &drawn, &mut used);
    }
    (used.0, [drawn.lens.into_inner(), drawn.medium.into_inner()])
}

#[test]
fn no_scene_enters_an_effect_that_it_does_not_call_for() {
    let mut seen = Effects::NONE;
    for (name, _) in SCENES {
        let scene = load(name).unwrap();
        let called = scene.effects();
        for entry in ESTIMATORS {
            let estimator = any_estimator(entry.name, Options::default()).unwrap();
            let (used, [lens, medium]) = look(&scene, &*estimator);
            let (used_names, called_names) = (effect_names(used), effect_names(called));
            assert!(called.cover(used), "{name}, {}: {used_names} for {called_names}", entry.name);
            assert_eq!(lens > 0, called.cover(LENS), "{name}, {}: {lens} numbers for a lens", entry.name);
            assert!(medium == 0 || called.cover(FOG), "{name}, {}: {medium} numbers for fog", entry.name);
            assert_eq!(used.cover(LENS), called.cover(LENS), "{name}, {}: lens", entry.name);
            assert_eq!(used.cover(FOG), called.cover(FOG), "{name}, {}: fog", entry.name);
            assert!(medium > 0 || !called.cover(FOG) || entry.name == "whitted", "{name}, {}", entry.name);
            seen = seen.and(used);
        }
    }
    // The probe hears of every effect that the scenes use, except shapes, their faults and hierarchies, which make no such call.
    let silent = PRIMITIVES.iter().fold(HIERARCHY.and(COMPOUND).and(FAULTS), |all, entry| all.and(entry.effect));
    for (name, _) in SCENES {
        let called = load(name).unwrap().effects();
        assert!(seen.and(silent).cover(called), "{name}: {} of {}", effect_names(seen), effect_names(called));
    }
    assert!(seen.cover(BACKGROUND) && seen.cover(LENS) && seen.cover(FOG), "{}", effect_names(seen));
}
