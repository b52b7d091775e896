//! `--max-depth` in any scene: a cut removes later bounces and nothing else. Its closed forms are in the table of hard
//! cases.

use pathmark::estimator::{Bsdf, Estimator, Options, Probe, camera_ray};
use pathmark::math::Rgb;
use pathmark::sampling::{Independent, SampleKey};
use pathmark::scene::{AllEffects, load};

/// The light of a sample, by the number of bounces before it.
#[derive(Default)]
struct ByBounce(Vec<Rgb>);

impl Probe for ByBounce {
    fn light(&mut self, bounces: u16, contribution: Rgb) {
        let index = usize::from(bounces);
        if self.0.len() <= index {
            self.0.resize(index + 1, Rgb::BLACK);
        }
        self.0[index] += contribution;
    }
}

/// In any scene, a cut sample equals the whole sample minus the later light. The light of each bounce is known from
/// the whole sample.
#[test]
fn a_cut_takes_later_bounces_and_nothing_else() {
    for name in ["cornell", "cornell-fog", "sky", "report-c"] {
        let scene = load(name).unwrap();
        let view = scene.camera.view(24, 18);
        let mut later = 0.0;
        for pixel in 0..24 * 18 {
            let key = SampleKey { seed: 5, pixel, sample: pixel % 4 };
            let ray = camera_ray::<_, AllEffects, ()>(&view, [pixel % 24, pixel / 24], key, 0, &Independent, &mut ());
            let sample = |max_depth, probe: &mut ByBounce| {
                let options = Options { max_depth, ..Options::default() };
                Bsdf::new(options).sample::<_, AllEffects, _>(&scene, ray, key, &Independent, probe)
            };
            let mut whole = ByBounce::default();
            let total = sample(None, &mut whole).g;
            let mut kept = 0.0;
            for (depth, light) in (0..12).zip(whole.0.iter().map(|light| light.g).chain(std::iter::repeat(0.0))) {
                kept += light;
                let found = sample(Some(depth), &mut ByBounce::default()).g;
                assert!((found - kept).abs() <= 1e-12 * total, "{name}, depth {depth}: {found} instead of {kept}");
            }
            later += total - kept;
        }
        assert!(later >= 0.0, "{name}");
    }
}
