//! The kernel of lanes: its data, and its entry: whether lanes can render a scene with given settings, and with which
//! instruction set.

use super::bvh::{Stacks, Wide};
use super::filter::Filter;
use super::search::SearchOfLanes;
use super::spheres_f32::SpheresF32;
use super::tables::Tables;
use super::targets::Targets;
use crate::level::level;
use crate::sampler::InLanes as Sampler;
use crate::simd::{Level, Sizes, sizes_of};
use pathmark_tracer::error::Result;
use pathmark_tracer::estimator::PathRules;
use pathmark_tracer::kernel::{FirstHits, Kernel, KernelEntry, KernelPlan, Planned, RenderOptions, Request, Start};
use pathmark_tracer::material::Diffuse;
use pathmark_tracer::math::Precision;
use pathmark_tracer::scene::{
    ANGULAR_EMISSION, DiffuseOnly, FAULTS, FOG, LENS, POINT_LIGHT, Scan, Scene, Sphere, View,
};
use std::sync::Arc;

#[derive(Clone, Copy)]
pub(super) struct InLanes {
    pub(super) level: Level,
    pub(super) precision: Precision,
    pub(super) rules: PathRules,
    pub(super) sampler: Sampler,
    /// Whether the code for diffuse surfaces alone is used.
    pub(super) is_diffuse_only: bool,
}

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
        let lights = options.estimator.aims.then(|| scene.lights_for(&view));
        Self {
            targets: lights.as_ref().and_then(|lights| Targets::of(lights, precision)).map(Box::new),
            tables: Tables::of(scene, precision),
            search,
            view,
            precision,
            scene: Arc::clone(scene),
            width: options.width,
            seed: options.seed,
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

/// Many paths side by side.
pub(crate) const LANES: KernelEntry =
    KernelEntry::new("lanes", "many paths side by side in SIMD lanes; falls back to the scalar kernel if needed", plan);

/// Name for the effects of a kernel that checks at run time whether any of its lanes needs one.
const AT_RUN_TIME: &str = "run-time";

/// Lanes allow fewer primitives than this: single precision must represent a primitive's number exactly.
pub(crate) const MOST_IN_LANES: usize = 1 << f32::MANTISSA_DIGITS;

/// The feature of a scene or of its settings that lanes have no code for.
fn obstacle(request: &Request<'_>) -> Option<&'static str> {
    let Request { scene, spec, epsilon, .. } = request;
    let features = [
        (FOG, "fog"),
        (LENS, "lens"),
        (POINT_LIGHT, "point-light"),
        (ANGULAR_EMISSION, "angular-emission"),
        (FAULTS, "faults"),
    ];
    let of_scene = features.into_iter().find(|(effect, _)| scene.effects().cover(*effect)).map(|(_, name)| name);
    let others = [
        (spec.effects.is_some(), "effects"),
        (spec.clamp.is_some(), "clamp"),
        (epsilon.is_some(), "epsilon"),
        (scene.owners.len() >= MOST_IN_LANES, "primitives"),
    ];
    of_scene.or_else(|| others.into_iter().find(|(is_there, _)| *is_there).map(|(_, name)| name))
}

fn plan(request: &Request<'_>) -> Result<Planned> {
    let (level, precision) = (level(request.simd)?, request.precision);
    let (rules, sampler) = match (obstacle(request), request.rules, Sampler::find(&request.spec.sampler)) {
        (None, Some(rules), Some(sampler)) => (rules, sampler),
        (Some(reason), ..) => return Ok(Planned::Unsupported(reason)),
        (None, None, _) => return Ok(Planned::Unsupported("estimator")),
        (None, Some(_), None) => return Ok(Planned::Unsupported("sampler")),
    };
    let is_diffuse = request.scene.objects.iter().all(|object| object.material.effect() == Diffuse::EFFECT);
    // Under next-event estimation, lights take most of the time: code for diffuse surfaces alone would gain 3 %, and
    // take as long to compile as the other versions.
    let is_diffuse_only = is_diffuse && rules.nee.is_none() && !level.is_fallback();
    Ok(Planned::Ready(Arc::new(InLanes { level, precision, rules, sampler, is_diffuse_only })))
}

impl KernelPlan for InLanes {
    fn name(&self) -> &str {
        LANES.name
    }

    fn simd(&self) -> &'static str {
        self.level.name()
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn effects(&self) -> Option<&'static str> {
        Some(if self.is_diffuse_only { DiffuseOnly::NAME } else { AT_RUN_TIME })
    }

    fn scan(&self, scene: &Scene) -> Scan {
        let Sizes { lanes, single, .. } = sizes_of(self.level, self.precision);
        match self.precision {
            _ if scene.primitives.effects() == Sphere::EFFECT => Scan::Spheres(single),
            Precision::F64 => Scan::Doubles(lanes),
            Precision::F32 => Scan::Singles(lanes),
        }
    }

    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>> {
        Ok(Box::new(Lanes::new(scene, options, *self)))
    }

    fn first_hits(&self, scene: &Arc<Scene>, options: &RenderOptions, rays: Vec<Start>) -> Result<Box<dyn FirstHits>> {
        Ok(Box::new(SearchOfLanes::new(Lanes::new(scene, options, *self), &rays)))
    }
}
