//! The data of the kernel.

use super::bvh::{Stacks, Wide};
use super::filter::Filter;
use super::spheres_f32::SpheresF32;
use super::tables::Tables;
use super::targets::Targets;
use crate::sampler::InLanes as Sampler;
use crate::simd::Level;
use pathmark_tracer::estimator::PathRules;
use pathmark_tracer::kernel::RenderOptions;
use pathmark_tracer::math::Precision;
use pathmark_tracer::scene::{Scene, View};
use std::sync::Arc;

/// The settings of lanes.
#[derive(Clone, Copy)]
pub(super) struct InLanes {
    pub(super) level: Level,
    pub(super) precision: Precision,
    pub(super) rules: PathRules,
    pub(super) sampler: Sampler,
    /// Whether the code for diffuse surfaces alone is used.
    pub(super) is_diffuse_only: bool,
}

/// The kernel.
pub(super) struct Lanes {
    pub(super) scene: Arc<Scene>,
    pub(super) view: View,
    pub(super) width: u32,
    pub(super) seed: u64,
    pub(super) rules: PathRules,
    pub(super) sampler: Sampler,
    pub(super) tables: Tables,
    pub(super) targets: Option<Box<Targets>>,
    pub(super) level: Level,
    pub(super) precision: Precision,
    pub(super) is_diffuse_only: bool,
    pub(super) search: Search,
}

/// Method to find the nearest primitive along each ray.
pub(super) enum Search {
    /// Few primitives, all of them spheres: a quick formula tests every sphere, and an exact one confirms the nearest.
    Filter(Filter),
    /// The same primitives by the formulas of single precision.
    SpheresF32(SpheresF32),
    /// Any primitives: one ray at a time.
    Wide(Box<Wide>),
}

impl Lanes {
    pub(super) fn new(
        scene: &Arc<Scene>,
        options: &RenderOptions,
        InLanes { level, precision, rules, sampler, is_diffuse_only }: InLanes,
    ) -> Self {
        let view = options.view(scene);
        let is_round = scene.is_round();
        let hierarchy = options.hierarchy(scene).or_else(|| scene.hierarchy.clone());
        let search = match precision {
            _ if !is_round || hierarchy.is_some() => {
                Search::Wide(Box::new(Wide::of(scene, hierarchy, level, precision, &scene.enclosing(&view))))
            }
            Precision::F64 => Search::Filter(Filter::of(scene)),
            Precision::F32 => Search::SpheresF32(SpheresF32::of(scene, &scene.enclosing(&view))),
        };
        let lights = options.estimator().aims.then(|| scene.lights_for(&view));
        Self {
            targets: lights.as_ref().and_then(|lights| Targets::of(lights, precision)).map(Box::new),
            tables: Tables::of(scene, precision),
            search,
            view,
            precision,
            scene: Arc::clone(scene),
            width: options.width(),
            seed: options.seed(),
            rules,
            sampler,
            level,
            is_diffuse_only,
        }
    }

    /// Stacks for searches, if there is a tree.
    pub(super) fn stacks(&self) -> Option<Box<Stacks>> {
        matches!(&self.search, Search::Wide(wide) if wide.has_tree()).then(Stacks::new)
    }
}
