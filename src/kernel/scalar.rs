//! One path at a time, in f64: the readable kernel that every other one is measured against.

use super::{Clamp, Counts, Inspect, Kernel, Spec};
use crate::effect::EffectSet;
use crate::estimator::{Estimator, Probe, camera_ray};
use crate::film::{Piece, PixelSum, SampleSum, TileBuffer};
use crate::math::Rgb;
use crate::sampling::{SampleKey, Sampler};
use crate::scene::{SUBPIXELS, Scene, Tests, View};
use std::marker::PhantomData;
use std::sync::Arc;

/// The kernel for one estimator, sampler and effect profile.
pub(super) struct Scalar<E, S, X> {
    scene: Arc<Scene>,
    view: View,
    width: u32,
    seed: u64,
    subpixel_clamp: bool,
    estimator: E,
    sampler: S,
    profile: PhantomData<X>,
}

impl Probe for Counts {
    #[inline(always)]
    fn ray(&mut self, tests: Tests) {
        self.rays += 1;
        self.box_tests += tests.boxes;
        self.primitive_tests += tests.primitives;
    }
    fn escaped(&mut self) {
        self.escaped += 1;
    }
    fn truncated(&mut self) {
        self.truncated += 1;
    }
}

impl<E: Estimator, S: Sampler, X: EffectSet> Scalar<E, S, X> {
    pub(super) fn new(scene: Arc<Scene>, spec: &Spec, estimator: E, sampler: S) -> Self {
        Self {
            view: scene.camera.view(spec.width, spec.height),
            scene,
            width: spec.width,
            seed: spec.seed,
            subpixel_clamp: spec.clamp == Some(Clamp::Subpixel),
            estimator,
            sampler,
            profile: PhantomData,
        }
    }

    /// What the estimator makes of a sample, right or wrong.
    #[inline(always)]
    fn estimate<P: Probe>(&self, x: u32, y: u32, sample: u32, probe: &mut P) -> Rgb {
        let key = SampleKey { seed: self.seed, pixel: y * self.width + x, sample };
        let ray = camera_ray::<S, X, P>(&self.view, [x, y], key, &self.sampler, probe);
        self.estimator.sample::<S, X, P>(&self.scene, ray, key, &self.sampler, probe)
    }

    /// What a sample contributes to its pixel.
    #[inline(always)]
    fn sample(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        let radiance = self.estimate(x, y, sample, counts);
        counts.paths += 1;
        if radiance.is_valid_radiance() {
            return radiance;
        }
        counts.invalid += 1;
        Rgb::BLACK
    }

    fn pixel(&self, x: u32, y: u32, piece: &Piece, sum: &mut SampleSum, counts: &mut Counts) -> PixelSum {
        sum.clear();
        for sample in piece.samples.clone() {
            sum.add(self.sample(x, y, sample, counts));
        }
        sum.total()
    }

    /// smallpt's way: the mean of each subpixel is cut at 1 before the four are averaged. Squares are those of the unclamped samples.
    fn clamped_pixel(&self, x: u32, y: u32, piece: &Piece, sum: &mut SampleSum, counts: &mut Counts) -> PixelSum {
        let mut pixel = PixelSum::default();
        for subpixel in 0..SUBPIXELS {
            sum.clear();
            for sample in piece.samples.clone().filter(|sample| sample % SUBPIXELS == subpixel) {
                sum.add(self.sample(x, y, sample, counts));
            }
            let mut part = sum.total();
            let clamped = part.mean().map(|mean| mean.min(1.0) * f64::from(part.count));
            part.sum = clamped;
            pixel = pixel.plus(&part);
        }
        pixel
    }
}

impl<E: Estimator, S: Sampler, X: EffectSet> Kernel for Scalar<E, S, X> {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let mut counts = Counts::default();
        let mut sum = SampleSum::default();
        for y in piece.bounds.y0..piece.bounds.y1 {
            for (x, pixel) in (piece.bounds.x0..piece.bounds.x1).zip(out.row_mut(y)) {
                *pixel = if self.subpixel_clamp {
                    self.clamped_pixel(x, y, piece, &mut sum, &mut counts)
                } else {
                    self.pixel(x, y, piece, &mut sum, &mut counts)
                };
            }
        }
        counts
    }
}

impl<E: Estimator, S: Sampler, X: EffectSet> Inspect for Scalar<E, S, X> {
    fn estimate(&self, x: u32, y: u32, sample: u32, mut probe: &mut dyn Probe) -> Rgb {
        Self::estimate(self, x, y, sample, &mut probe)
    }
}
