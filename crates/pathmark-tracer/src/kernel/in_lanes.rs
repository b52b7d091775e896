//! Selection of lanes: whether they can render a scene with given settings, and with which instruction set.

use super::choice::unknown;
use super::{SCALAR, Spec};
use crate::error::{InputError, Result};
use crate::estimator::PathRules;
use crate::material::Diffuse;
use crate::sampling::InLanes as LaneSampler;
use crate::scene::{ANGULAR_EMISSION, FOG, LENS, POINT_LIGHT, Scene};
use crate::simd::{Entry as LevelEntry, LEVELS, Level, Precision};

/// The settings of lanes.
#[derive(Clone, Copy)]
pub(super) struct InLanes {
    pub(super) level: Level,
    pub(super) precision: Precision,
    pub(super) rules: PathRules,
    pub(super) sampler: LaneSampler,
    /// Whether the code for diffuse surfaces alone is used.
    pub(super) is_diffuse_only: bool,
}

/// Lanes allow fewer primitives than this: single precision must represent a primitive's number exactly.
pub(super) const MOST_IN_LANES: usize = 1 << f32::MANTISSA_DIGITS;

/// The feature of a scene or of its settings that lanes have no code for.
fn obstacle(scene: &Scene, spec: &Spec, epsilon: Option<f64>) -> Option<&'static str> {
    let features = [(FOG, "fog"), (LENS, "lens"), (POINT_LIGHT, "point-light"), (ANGULAR_EMISSION, "angular-emission")];
    let of_scene = features.into_iter().find(|(effect, _)| scene.effects().cover(*effect)).map(|(_, name)| name);
    let others = [
        (spec.effects.is_some(), "effects"),
        (spec.clamp.is_some(), "clamp"),
        (epsilon.is_some(), "epsilon"),
        (scene.owners.len() >= MOST_IN_LANES, "primitives"),
    ];
    of_scene.or_else(|| others.into_iter().find(|(is_there, _)| *is_there).map(|(_, name)| name))
}

/// The settings of lanes for a scene, or the feature that they have no code for.
pub(super) fn lanes_for(
    scene: &Scene,
    spec: &Spec,
    rules: Option<PathRules>,
    epsilon: Option<f64>,
) -> Result<std::result::Result<InLanes, &'static str>> {
    let level = level(LEVELS, spec.simd.as_deref())?;
    let precision = precision(spec)?;
    Ok(Err(match (obstacle(scene, spec, epsilon), rules, LaneSampler::find(&spec.sampler)) {
        (None, Some(rules), Some(sampler)) => {
            let is_diffuse = scene.objects.iter().all(|object| object.material.effect() == Diffuse::EFFECT);
            // Under next-event estimation, lights take most of the time: code for diffuse surfaces alone would gain
            // 3 %, and take as long to compile as the other versions.
            let is_diffuse_only = is_diffuse && rules.aims.is_none() && !level.is_fallback();
            return Ok(Ok(InLanes { level, precision, rules, sampler, is_diffuse_only }));
        }
        (Some(reason), ..) => reason,
        (None, None, _) => "estimator",
        (None, Some(_), None) => "sampler",
    }))
}

/// The instruction set of that name, or the fastest one of this processor.
pub(super) fn level(levels: &'static [LevelEntry], wanted: Option<&str>) -> Result<Level> {
    let available = || levels.iter().filter_map(LevelEntry::here);
    if let Some(level) = available().find(|level| wanted.is_none_or(|name| level.name() == name)) {
        return Ok(level);
    }
    let name = wanted.unwrap_or_default();
    if levels.iter().any(|level| level.name == name) {
        let allowed: Vec<&str> = available().map(Level::name).collect();
        let error = InputError::new("simd", name, "is not supported by this processor");
        return Err(error.allowed(allowed.join(", ")).into());
    }
    Err(unknown("simd", name, available().map(Level::name)).into())
}

/// The floating-point format that the spec names. The scalar kernel has only f64.
pub(super) fn precision(spec: &Spec) -> Result<Precision> {
    let name = &spec.precision;
    let Some(precision) = Precision::ALL.into_iter().find(|precision| precision.name() == name) else {
        return Err(unknown("precision", name, Precision::ALL.into_iter().map(Precision::name)).into());
    };
    if spec.kernel == SCALAR && precision != Precision::F64 {
        let problem = "is not supported by the scalar kernel";
        return Err(InputError::new("precision", name, problem).allowed(Precision::F64.name()).into());
    }
    Ok(precision)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If the processor lacks the first instruction set, the next one is chosen. A request for the first is an error
    /// that lists the available ones.
    #[test]
    fn a_level_that_the_processor_lacks_is_refused() {
        let [mut first, last] = [&LEVELS[0], &LEVELS[LEVELS.len() - 1]].map(LevelEntry::clone);
        (first.name, first.is_available) = ("first", || false);
        let table = Box::leak(Box::new([first, last]));
        assert_eq!(level(table, None).unwrap().name(), "baseline");
        let error = level(table, Some("first")).unwrap_err().to_string();
        assert!(error.contains("first") && error.contains("is not supported by this processor"), "{error}");
        assert!(error.contains("baseline"), "{error}");
        let error = level(table, Some("mmx")).unwrap_err().to_string();
        assert!(error.contains("there is none of that name"), "{error}");
    }
}
