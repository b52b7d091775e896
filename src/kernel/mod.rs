//! How an estimator is executed over a piece of the film. A kernel never sees a thread.

mod scalar;

use crate::error::{InputError, Result};
use crate::estimator::{ESTIMATORS, Estimator, EstimatorVisitor, with_estimator};
use crate::film::{Piece, TileBuffer};
use crate::material::EffectSet;
use crate::sampling::{SAMPLERS, Sampler, SamplerVisitor, with_sampler};
use crate::scene::{PROFILES, ProfileVisitor, Scene, smallest_profile, with_profile};
use scalar::Scalar;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Version of the arithmetic. It changes when the same settings give other bits than before, and films of the old ones are no longer used.
pub const REVISION: u32 = 1;

/// What happened while a piece was rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Samples that were NaN, infinite or negative; they contribute nothing.
    pub invalid: u64,
    /// Rays that met nothing.
    pub escaped: u64,
    /// Paths cut at the bounce limit.
    pub truncated: u64,
}

impl Counts {
    /// Adds another piece's.
    pub fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.invalid += other.invalid;
        self.escaped += other.escaped;
        self.truncated += other.truncated;
    }
}

/// Renders pieces. The same piece gives the same bits, whoever asks, if the sampler is deterministic.
pub trait Kernel: Send + Sync {
    /// Renders the samples of the piece into the buffer, which has the piece's columns and at least its rows.
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts;
}

/// Which kernel to build: the *what* of a render.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spec {
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// Seed of the image.
    pub seed: u64,
    /// Estimator by name.
    pub estimator: String,
    /// Sampler by name.
    pub sampler: String,
    /// Kernel by name.
    pub kernel: String,
    /// Effect profile by name; the smallest that covers the scene if `None`.
    pub effects: Option<String>,
    /// Whether each subpixel's mean is clamped to 1 before averaging, as smallpt does: biased.
    pub subpixel_clamp: bool,
}

impl Default for Spec {
    fn default() -> Self {
        Self {
            width: 256,
            height: 192,
            seed: 1,
            estimator: "smallpt".to_string(),
            sampler: "independent".to_string(),
            kernel: "scalar".to_string(),
            effects: None,
            subpixel_clamp: false,
        }
    }
}

/// One line of the table of kernels.
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
}

/// The kernels, in the order in which they are listed.
pub const KERNELS: &[Entry] = &[Entry { name: "scalar", about: "one path at a time in f64" }];

/// A kernel and the name of the profile that it was compiled for.
pub struct Built {
    /// The kernel.
    pub kernel: Box<dyn Kernel>,
    /// The profile's name.
    pub effects: &'static str,
}

/// Builds the kernel for a scene.
pub fn build(scene: &Arc<Scene>, spec: &Spec) -> Result<Built> {
    let unknown = |field: &str, value: &str, names: Vec<&str>| {
        InputError::new(field, value, "there is none of that name").allowed(names.join(", "))
    };
    let wanted = spec.effects.as_deref().unwrap_or_else(|| smallest_profile(scene.effects));
    let Some(profile) = PROFILES.iter().find(|entry| entry.name == wanted) else {
        return Err(unknown("effects", wanted, PROFILES.iter().map(|entry| entry.name).collect()).into());
    };
    if !profile.effects.cover(scene.effects) {
        let calls_for = scene.effects.names();
        return Err(InputError::new(
            "effects",
            wanted,
            format!("does not cover the scene, which calls for {calls_for}"),
        )
        .allowed(smallest_profile(scene.effects))
        .into());
    }
    let with_names = ByProfile { scene: Arc::clone(scene), spec: spec.clone() };
    let by_sampler = with_profile(profile.name, with_names)
        .ok_or_else(|| unknown("effects", wanted, PROFILES.iter().map(|entry| entry.name).collect()))?;
    let by_estimator = by_sampler
        .ok_or_else(|| unknown("sampler", &spec.sampler, SAMPLERS.iter().map(|entry| entry.name).collect()))?;
    let kernel = by_estimator
        .ok_or_else(|| unknown("estimator", &spec.estimator, ESTIMATORS.iter().map(|entry| entry.name).collect()))?;
    Ok(Built { kernel, effects: profile.name })
}

/// From the profile's name to a type, then from the sampler's.
struct ByProfile {
    scene: Arc<Scene>,
    spec: Spec,
}

impl ProfileVisitor for ByProfile {
    type Output = Option<Option<Box<dyn Kernel>>>;
    fn visit<X: EffectSet>(self) -> Self::Output {
        let (name, seed) = (self.spec.sampler.clone(), self.spec.seed);
        with_sampler(
            &name,
            seed,
            BySampler::<X> { scene: self.scene, spec: self.spec, profile: std::marker::PhantomData },
        )
    }
}

/// From the sampler's name to a type, then from the estimator's.
struct BySampler<X> {
    scene: Arc<Scene>,
    spec: Spec,
    profile: std::marker::PhantomData<X>,
}

impl<X: EffectSet> SamplerVisitor for BySampler<X> {
    type Output = Option<Box<dyn Kernel>>;
    fn visit<S: Sampler + 'static>(self, sampler: S) -> Self::Output {
        let name = self.spec.estimator.clone();
        with_estimator(
            &name,
            ByEstimator::<S, X> { scene: self.scene, spec: self.spec, sampler, profile: self.profile },
        )
    }
}

/// From the estimator's name to a type, then to a kernel.
struct ByEstimator<S, X> {
    scene: Arc<Scene>,
    spec: Spec,
    sampler: S,
    profile: std::marker::PhantomData<X>,
}

impl<S: Sampler + 'static, X: EffectSet> EstimatorVisitor for ByEstimator<S, X> {
    type Output = Box<dyn Kernel>;
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
        Box::new(Scalar::<E, S, X>::new(self.scene, &self.spec, estimator, self.sampler))
    }
}
