//! The values that a setup really uses, and the keys of its image, schedule and film: those that its rows will have.

use super::{ImageKey, ScheduleKey, Settings, Setup};
use crate::film_file::FilmKey;
use crate::kernel::workload::WORKLOAD;
use crate::kernel::{RenderOptions, Spec};
use crate::scene::Filter;

/// A distance as text; small ones by their power of ten.
fn distance(value: f64) -> String {
    if value > 0.0 && value < 1e-3 { format!("{value:e}") } else { value.to_string() }
}

/// The specification with the values that the choice really uses.
fn used(spec: Spec, choice: &RenderOptions) -> Spec {
    Spec {
        estimator: choice.estimator.name.to_string(),
        max_depth: choice.depth(),
        camera_rays: Some(choice.camera_rays()).filter(|rays| *rays > 1),
        roulette: choice.roulette().map(|rule| rule.to_string()),
        clamp: choice.clamp.map(|clamp| clamp.to_string()),
        filter: choice.filter.map(Filter::name).map(str::to_string),
        epsilon: choice.epsilon.map(distance),
        precision: choice.plan.precision().name().to_string(),
        kernel: choice.plan.name().to_string(),
        simd: Some(choice.plan.simd().to_string()),
        effects: Some(choice.effects().to_string()),
        accelerator: Some(choice.accelerator.name.to_string()),
        ..spec
    }
}

impl Setup {
    fn used(&self) -> Settings {
        let settings = self.settings().clone();
        let spec = match self.scene() {
            Some((_, choice)) => used(settings.spec, choice),
            None => Spec { kernel: WORKLOAD.to_string(), ..settings.spec },
        };
        Settings { scene: self.name().to_string(), threads: self.threads(), spec, ..settings }
    }

    pub fn image_key(&self) -> ImageKey {
        ImageKey { scene_hash: self.hash(), ..ImageKey::of(&self.used()) }
    }

    /// The identity of its schedule among those of the same image.
    pub fn schedule_key(&self) -> ScheduleKey {
        let fallback = self.scene().map(|(_, choice)| choice.fallback.to_string());
        ScheduleKey { kernel_fallback: fallback.unwrap_or_default(), ..ScheduleKey::of(&self.used()) }
    }

    pub fn film_key(&self) -> FilmKey {
        FilmKey::of(self.image_key())
    }
}

#[cfg(test)]
mod tests;
