//! Light that arrives straight from point lights, which no path can hit: a shadow ray to each.

use super::Probe;
use crate::effect::EffectSet;
use crate::math::{Ray, Rgb, Vec3, dot};
use crate::scene::{FOG, Fog, Hit, POINT_LIGHT, PointLight, Scene, Standpoint, Tests};
use std::f64::consts::PI;

/// The irradiance that arrives from a light on a surface that faces it, if nothing is between: intensity over distance squared, less what
/// fog takes.
#[inline(always)]
fn arriving<X: EffectSet, P: Probe>(
    scene: &Scene,
    light: &PointLight,
    point: Vec3,
    from: Option<Standpoint>,
    probe: &mut P,
) -> Option<Rgb> {
    let towards = light.position - point;
    let distance = dot(towards, towards).sqrt();
    let direction = towards * (1.0 / distance);
    let mut tests = Tests::default();
    let is_blocked = scene.is_blocked::<X>(&Ray { origin: point, direction }, from, distance, &mut tests);
    probe.ray(tests);
    if is_blocked {
        return None;
    }
    let irradiance = light.intensity * (1.0 / (distance * distance));
    Some(if X::EFFECTS.cover(FOG) { through(scene.fog.as_ref(), distance, irradiance) } else { irradiance })
}

/// What is left of a beam after a distance: neither absorbed nor scattered.
fn through(fog: Option<&Fog>, distance: f64, beam: Rgb) -> Rgb {
    fog.map_or(beam, |fog| beam * fog.transmittance(distance) * fog.unscattered(distance))
}

/// The radiance that the point lights cause at a surface that a ray of that direction met, back along the ray; `None` if there are none.
#[inline(always)]
pub(super) fn light_at_surface<X: EffectSet, P: Probe>(
    scene: &Scene,
    hit: &Hit,
    direction: Vec3,
    probe: &mut P,
) -> Option<Rgb> {
    if !X::EFFECTS.cover(POINT_LIGHT) || scene.point_lights.is_empty() {
        return None;
    }
    probe.used(POINT_LIGHT);
    let frame = hit.frame();
    let wo = frame.to_local(-direction);
    let material = &scene.objects[hit.object as usize].material;
    let mut radiance = Rgb::BLACK;
    for light in &scene.point_lights {
        let wi = frame.to_local((light.position - hit.point).normalized());
        let scattered = material.eval::<X>(wo, wi) * wi.z.abs();
        if scattered.is_black() {
            continue;
        }
        let from = Some(Standpoint { primitive: hit.primitive, inside: (wi.z < 0.0) != hit.inside });
        if let Some(irradiance) = arriving::<X, P>(scene, light, hit.point, from, probe) {
            radiance += scattered * irradiance;
        }
    }
    Some(radiance)
}

/// Likewise where fog scatters, evenly in all directions.
#[inline(always)]
pub(super) fn light_at_fog<X: EffectSet, P: Probe>(scene: &Scene, point: Vec3, probe: &mut P) -> Option<Rgb> {
    if !X::EFFECTS.cover(POINT_LIGHT) || scene.point_lights.is_empty() {
        return None;
    }
    probe.used(POINT_LIGHT);
    let mut radiance = Rgb::BLACK;
    for light in &scene.point_lights {
        if let Some(beam) = arriving::<X, P>(scene, light, point, None, probe) {
            radiance += beam * (0.25 / PI);
        }
    }
    Some(radiance)
}
