//! Identity of images and schedules: one key for each, whether they are requested or measured.
//!
//! Cells, rows, references and figures compare by these keys. A new axis is a field of one of the two; the tests compare them with the table of axes.

use super::{AXES, Axis, Record, Setup};
use crate::film_file::FilmKey;
use crate::kernel;
use std::fmt;

/// The columns of an image's identity, by the table of axes. The scene's name and its hash are one axis.
pub fn image_columns() -> Vec<String> {
    AXES.iter().filter(|axis| axis.changes_image).flat_map(Axis::columns).chain(["scene_hash".to_string()]).collect()
}

/// The columns of a schedule's identity, by the table of axes. The kernel's name and the reason for it are one axis.
pub fn schedule_columns() -> Vec<String> {
    let own = AXES.iter().filter(|axis| !axis.changes_image).flat_map(Axis::columns);
    own.chain(["kernel_fallback".to_string()]).collect()
}

/// The identity of an image: rows with equal keys have equal checksums, unless the sampler draws other random numbers
/// in each run.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct ImageKey {
    /// Name of the scene.
    pub scene: String,
    /// Hash of its definition: two files may have the same name, and one may be edited between two runs.
    pub scene_hash: String,
    /// Estimator.
    pub estimator: String,
    /// Sampler.
    pub sampler: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Seed.
    pub seed: u64,
    /// Bounces after which paths are cut, the estimator's own limit included.
    pub max_depth: Option<u16>,
    /// Camera rays of a sample; `None` for one.
    pub camera_rays: Option<u16>,
    /// Russian roulette rule, the estimator's own rule included; empty if there is none.
    pub roulette: String,
    /// Clamping rule; empty if nothing is clamped.
    pub clamp: String,
    /// Pixel filter; empty if it is the camera's own.
    pub filter: String,
    /// Distance below which hits are dropped; empty if there is none.
    pub epsilon: String,
    /// Floating-point format of the kernel that renders.
    pub precision: String,
    /// Whether the samples of each tile depend on its noise.
    pub adaptive: bool,
}

impl ImageKey {
    /// The key that the images of all seeds share.
    #[must_use]
    pub fn without_seed(&self) -> Self {
        Self { seed: 0, ..self.clone() }
    }
}

/// One word without spaces, equal only for equal keys.
impl fmt::Display for ImageKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, scene_hash, estimator, sampler, width, height, spp, seed, .. } = self;
        write!(f, "{scene}-{scene_hash}/{estimator}/{sampler}/{width}x{height}/{spp}spp/seed{seed}")?;
        if let Some(depth) = self.max_depth {
            write!(f, "/depth{depth}")?;
        }
        if let Some(rays) = self.camera_rays {
            write!(f, "/{rays}rays")?;
        }
        let parts = [
            ("roulette-", &self.roulette),
            ("clamp-", &self.clamp),
            ("filter-", &self.filter),
            ("epsilon-", &self.epsilon),
            ("", &self.precision),
        ];
        for (name, value) in parts.iter().filter(|(_, value)| !value.is_empty()) {
            write!(f, "/{name}{value}")?;
        }
        f.write_str(if self.adaptive { "/adaptive" } else { "" })
    }
}

/// The identity of a schedule among those of one image: who renders which pieces, and how. It must not change a bit of
/// the image.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct ScheduleKey {
    /// Strategy, with its parameter.
    pub strategy: String,
    /// Decomposition of the film.
    pub decomposition: String,
    /// Workers; with several processes, in each.
    pub threads: usize,
    /// Processes; `None` if there is one.
    pub ranks: Option<u16>,
    /// Rule by which processes share the jobs; empty if there is one process.
    pub rank_rule: String,
    /// How pieces get into the film.
    pub output: String,
    /// Kernel that renders.
    pub kernel: String,
    /// Why it is not the requested one; empty if it is.
    pub kernel_fallback: String,
    /// Instruction set of its lanes; empty if it has none.
    pub simd: String,
    /// Effect profile.
    pub effects: String,
    /// Acceleration structure of the search for the nearest primitive.
    pub accelerator: String,
}

impl ScheduleKey {
    /// Clears who renders, but keeps the pieces.
    pub fn forget_workers(&mut self) {
        self.strategy.clear();
        self.rank_rule.clear();
        (self.threads, self.ranks) = (0, None);
    }

    /// Clears the kernel and the options that are chosen to fit it.
    pub fn forget_kernel(&mut self) {
        let parts =
            [&mut self.kernel, &mut self.kernel_fallback, &mut self.simd, &mut self.effects, &mut self.accelerator];
        parts.into_iter().for_each(String::clear);
    }
}

/// One word without spaces, equal only for equal keys.
impl fmt::Display for ScheduleKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}t/{}", self.decomposition, self.strategy, self.threads, self.output)?;
        let fallback = if self.kernel_fallback.is_empty() { "" } else { "fallback" };
        if let Some(ranks) = self.ranks {
            write!(f, "/{ranks}ranks")?;
        }
        if !self.rank_rule.is_empty() {
            write!(f, "/by-{}", self.rank_rule)?;
        }
        let parts = [&self.kernel, fallback, &self.simd, &self.effects, &self.accelerator];
        parts.iter().filter(|part| !part.is_empty()).try_for_each(|part| write!(f, "/{part}"))
    }
}

impl Record {
    /// The identity of its image.
    pub fn image_key(&self) -> ImageKey {
        ImageKey {
            scene: self.scene.clone(),
            scene_hash: self.scene_hash.clone(),
            estimator: self.estimator.clone(),
            sampler: self.sampler.clone(),
            width: self.width,
            height: self.height,
            spp: self.spp,
            seed: self.seed,
            max_depth: self.max_depth,
            camera_rays: self.camera_rays,
            roulette: self.roulette.clone(),
            clamp: self.clamp.clone(),
            filter: self.filter.clone(),
            epsilon: self.epsilon.clone(),
            precision: self.precision.clone(),
            adaptive: self.adaptive,
        }
    }

    /// The identity of its schedule among those of the same image.
    pub fn schedule_key(&self) -> ScheduleKey {
        ScheduleKey {
            strategy: self.strategy.clone(),
            decomposition: self.decomposition.clone(),
            threads: self.threads,
            ranks: self.ranks,
            rank_rule: self.rank_rule.clone(),
            output: self.output.clone(),
            kernel: self.kernel.clone(),
            kernel_fallback: self.kernel_fallback.clone(),
            simd: self.simd.clone(),
            effects: self.effects.clone(),
            accelerator: self.accelerator.clone(),
        }
    }
}

/// A setup has the keys that its rows will have.
impl Setup {
    /// The identity of its image.
    pub fn image_key(&self) -> ImageKey {
        Record::of(self).image_key()
    }

    /// The identity of its schedule among those of the same image.
    pub fn schedule_key(&self) -> ScheduleKey {
        ScheduleKey { threads: self.threads(), ..Record::of(self).schedule_key() }
    }

    /// The key of the film that it will render.
    pub fn film_key(&self) -> FilmKey {
        let key = self.image_key();
        FilmKey {
            scene: key.scene,
            scene_hash: key.scene_hash,
            estimator: key.estimator,
            sampler: key.sampler,
            seed: key.seed,
            spp: key.spp,
            width: key.width,
            height: key.height,
            max_depth: key.max_depth,
            camera_rays: key.camera_rays,
            roulette: given(key.roulette),
            clamp: given(key.clamp),
            filter: given(key.filter),
            epsilon: given(key.epsilon),
            precision: key.precision,
            adaptive: key.adaptive,
            revision: kernel::REVISION,
        }
    }
}

/// A part of a key; `None` if it is empty.
fn given(part: String) -> Option<String> {
    Some(part).filter(|part| !part.is_empty())
}

#[cfg(test)]
mod tests;
