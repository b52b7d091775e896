//! One path at a time, in f64: the readable kernel that every other one is measured against.

use super::clamp::{Clamp, Clamped};
use super::options::RenderOptions;
use super::render::{Counts, Kernel};
use crate::effect::EffectSet;
use crate::estimator::{Estimator, Probe, camera_ray, extra_camera_rays};
use crate::film::{Piece, PixelSum, SampleSum, TileBuffer};
use crate::math::Rgb;
use crate::sampling::{SampleKey, Sampler};
use crate::scene::{SUBPIXELS, Scene, Tests, View};
use std::marker::PhantomData;
use std::sync::Arc;

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

/// A source of samples: the radiance of each, and the counts of its rays.
pub(super) trait Samples: Send + Sync {
    /// The radiance of a sample of the pixel in column `x` of row `y`, as it is estimated, valid or not.
    fn radiance(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb;
}

/// Samples of an estimator that is compiled for one sampler and one effect profile.
pub(super) struct Compiled<E, S, X> {
    scene: Arc<Scene>,
    view: View,
    width: u32,
    seed: u64,
    camera_rays: u16,
    estimator: E,
    sampler: S,
    profile: PhantomData<X>,
}

impl<E, S, X> Compiled<E, S, X> {
    /// The samples of an image of a prepared scene.
    pub(super) fn new(scene: Arc<Scene>, options: &RenderOptions, estimator: E, sampler: S) -> Self {
        Self {
            view: options.view(&scene),
            scene,
            width: options.width,
            seed: options.seed,
            camera_rays: options.options.camera_rays(),
            estimator,
            sampler,
            profile: PhantomData,
        }
    }
}

impl<E: Estimator, S: Sampler, X: EffectSet> Samples for Compiled<E, S, X> {
    #[inline(always)]
    fn radiance(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        let key = SampleKey { seed: self.seed, pixel: y * self.width + x, sample };
        let ray = camera_ray::<S, X, Counts>(&self.view, [x, y], key, 0, &self.sampler, counts);
        let mut radiance = self.estimator.sample::<S, X, Counts>(&self.scene, ray, key, &self.sampler, counts);
        if self.camera_rays > 1 {
            radiance +=
                extra_camera_rays(&self.scene, &self.view, [x, y], key, self.camera_rays, &self.sampler, counts);
        }
        radiance
    }
}

/// The kernel: sums of samples over pixels.
pub(super) struct Scalar<R> {
    samples: R,
    subpixel_limit: Option<f64>,
}

impl<R: Samples> Scalar<R> {
    /// The kernel of these samples.
    pub(super) fn new(samples: R, options: &RenderOptions) -> Self {
        let clamp = options.clamp.filter(|clamp| clamp.what == Clamped::Subpixel);
        Self { samples, subpixel_limit: clamp.map(|clamp: Clamp| clamp.limit) }
    }

    /// The contribution of a sample to its pixel.
    #[inline(always)]
    fn sample(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        let radiance = self.samples.radiance(x, y, sample, counts);
        counts.paths += 1;
        if radiance.is_valid_radiance() {
            return radiance;
        }
        counts.invalid += 1;
        Rgb::BLACK
    }

    /// Sums the samples of a pixel. If subpixels are clamped, each subpixel is one pass over its own samples, and its
    /// mean is cut at the limit before the four means are averaged; smallpt's limit is 1. Squares are taken of the
    /// unclamped samples. One loop serves both cases, because the compiler inlines a whole path at every call.
    fn pixel(&self, x: u32, y: u32, piece: &Piece, sum: &mut SampleSum, counts: &mut Counts) -> PixelSum {
        let passes = if self.subpixel_limit.is_some() { SUBPIXELS } else { 1 };
        let mut pixel = PixelSum::default();
        for pass in 0..passes {
            sum.clear();
            for sample in piece.samples.clone().filter(|sample| sample % passes == pass) {
                sum.add(self.sample(x, y, sample, counts));
            }
            let mut part = sum.total();
            let Some(limit) = self.subpixel_limit else { return part };
            part.sum = part.mean().map(|mean| mean.min(limit) * f64::from(part.count));
            pixel = pixel.plus(&part);
        }
        pixel
    }
}

impl<R: Samples> Kernel for Scalar<R> {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let mut counts = Counts::default();
        let mut sum = SampleSum::default();
        for y in piece.bounds.y0..piece.bounds.y1 {
            for (x, pixel) in (piece.bounds.x0..piece.bounds.x1).zip(out.row_mut(y)) {
                *pixel = self.pixel(x, y, piece, &mut sum, &mut counts);
            }
        }
        counts
    }
}
