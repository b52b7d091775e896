//! Every shipped scene has one image, with every strategy, every accelerator and every effect profile.

use pathmark::kernel::{Counts, Spec, choose};
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::scene::{ACCELERATORS, HIERARCHY, PROFILES, SCENES, Scene, load};
use pathmark::strategy::STRATEGIES;
use std::sync::Arc;

const SERIAL: &str = "serial";

fn scenes() -> impl Iterator<Item = Arc<Scene>> {
    SCENES.iter().map(|(name, _)| Arc::new(load(name).unwrap()))
}

/// The scene's default estimator on 10 x 6 pixels, which no tile divides.
fn spec(scene: &Scene) -> Spec {
    let estimator = scene.default_estimator.clone().unwrap_or_else(|| "bsdf".to_string());
    Spec { width: 10, height: 6, seed: 5, estimator, ..Spec::default() }
}

fn render(scene: &Arc<Scene>, spec: Spec, strategy: &str) -> Outcome {
    let (decomposition, strategy) = ("tiles:4x4".into(), strategy.into());
    let settings = Settings { spp: 4, spec, decomposition, strategy, threads: 3, ..Settings::default() };
    Setup::for_scene(Arc::clone(scene), settings).unwrap().run(None).unwrap()
}

/// The checksum and the counts, without the tests of the hierarchy.
fn image(outcome: &Outcome) -> (&str, Counts) {
    let checksum = outcome.checksum.as_deref().expect("a checksum");
    (checksum, Counts { box_tests: 0, primitive_tests: 0, ..outcome.counts })
}

#[test]
fn every_strategy_gives_the_same_image() {
    assert!(SCENES.len() >= 19, "only {} scenes", SCENES.len());
    for scene in scenes() {
        let expected = render(&scene, spec(&scene), SERIAL);
        assert_eq!((expected.counts.paths, expected.counts.invalid), (240, 0), "{}", scene.name);
        for strategy in STRATEGIES {
            let found = render(&scene, spec(&scene), strategy.name);
            assert_eq!(image(&found), image(&expected), "{}, {}", scene.name, strategy.name);
        }
    }
}

#[test]
fn every_accelerator_and_profile_gives_the_same_image() {
    let mut compared = 0;
    for scene in scenes() {
        let expected = render(&scene, Spec { accelerator: Some("none".into()), ..spec(&scene) }, SERIAL);
        assert_eq!(expected.counts.box_tests, 0, "{}", scene.name);
        for accelerator in ACCELERATORS {
            let needed = if accelerator.is_hierarchy() { scene.effects().and(HIERARCHY) } else { scene.effects() };
            let profiles: Vec<_> = PROFILES.iter().filter(|profile| profile.effects.cover(needed)).collect();
            assert!(!profiles.is_empty(), "{}", scene.name);
            for profile in profiles {
                let (effects, accelerator) = (Some(profile.name.to_string()), Some(accelerator.name.to_string()));
                let what = format!("{}, {effects:?}, {accelerator:?}", scene.name);
                let spec = Spec { effects, accelerator, ..spec(&scene) };
                // Not every estimator is compiled for every profile.
                let Ok(chosen) = choose(&scene, &spec) else { continue };
                assert_eq!(chosen.effects(), profile.name, "{what}");
                let found = render(&scene, spec, SERIAL);
                assert_eq!(image(&found), image(&expected), "{what}");
                compared += 1;
            }
        }
    }
    assert!(compared > 4 * SCENES.len(), "{compared}");
}
