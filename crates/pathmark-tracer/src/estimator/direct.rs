//! Direct light from point lights, which no path can hit: a shadow ray to each.

use super::Probe;
use super::medium::Medium;
use crate::effect::EffectSet;
use crate::math::{Ray, Rgb, Vec3, dot};
use crate::sampling::UNIFORM_SPHERE_DENSITY;
use crate::scene::{Hit, POINT_LIGHT, PointLight, REACH, Scene, SurfaceOrigin, Tests};

/// The part of the distance to a light in which a surface can hide it. A light that lies in a surface is not hidden by
/// it: the rest is larger than a distance's rounding error. It is relative, so it is the same in scenes of any size.
pub const HIDING: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;

/// The straight line to a light.
struct Way {
    direction: Vec3,
    distance: f64,
}

impl Way {
    /// `None` at the light's own position, where it has no direction, and beyond its reach.
    #[inline(always)]
    fn to<X: EffectSet, P: Probe>(light: &PointLight, point: Vec3, probe: &mut P) -> Option<Self> {
        let towards = light.position - point;
        let distance = dot(towards, towards).sqrt();
        if X::EFFECTS.cover(REACH)
            && let Some(reach) = light.reach
        {
            probe.used(REACH);
            if distance > reach {
                return None;
            }
        }
        (distance > 0.0).then(|| Self { direction: towards * (1.0 / distance), distance })
    }

    /// The irradiance on a surface that faces the light: intensity over distance squared, attenuated by fog; `None` if
    /// the light is hidden.
    #[inline(always)]
    fn arriving<X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        light: &PointLight,
        point: Vec3,
        from: Option<SurfaceOrigin>,
        medium: Medium,
        probe: &mut P,
    ) -> Option<Rgb> {
        let mut tests = Tests::default();
        let ray = Ray { origin: point, direction: self.direction };
        let is_hidden = scene.is_blocked::<X>(&ray, from, self.distance * HIDING, &mut tests);
        probe.ray(tests);
        if is_hidden {
            return None;
        }
        let irradiance = light.intensity * (1.0 / (self.distance * self.distance));
        Some(medium.fog::<X>(scene).map_or(irradiance, |fog| irradiance * fog.unhindered(self.distance)))
    }
}

/// The radiance that the point lights cause at a surface, back along a ray of `direction` that hit it and lies in
/// `medium`; `None` if there are no point lights.
#[inline(always)]
pub(super) fn light_at_surface<X: EffectSet, P: Probe>(
    scene: &Scene,
    hit: &Hit,
    direction: Vec3,
    medium: Medium,
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
        let Some(way) = Way::to::<X, P>(light, hit.point, probe) else { continue };
        let wi = frame.to_local(way.direction);
        let scattered = material.eval::<X>(wo, wi) * wi.z.abs();
        if !scattered.has_light() {
            continue;
        }
        let from = Some(SurfaceOrigin { primitive: hit.primitive, inside: (wi.z < 0.0) != hit.inside });
        let medium = medium.beyond::<X>(hit, wi);
        if let Some(irradiance) = way.arriving::<X, P>(scene, light, hit.point, from, medium, probe) {
            radiance += scattered * irradiance;
        }
    }
    Some(radiance)
}

/// The same for a scattering event in fog, which is isotropic.
#[inline(always)]
pub(super) fn light_at_fog<X: EffectSet, P: Probe>(scene: &Scene, point: Vec3, probe: &mut P) -> Option<Rgb> {
    if !X::EFFECTS.cover(POINT_LIGHT) || scene.point_lights.is_empty() {
        return None;
    }
    probe.used(POINT_LIGHT);
    let mut radiance = Rgb::BLACK;
    for light in &scene.point_lights {
        let Some(way) = Way::to::<X, P>(light, point, probe) else { continue };
        if let Some(beam) = way.arriving::<X, P>(scene, light, point, None, Medium::OUTSIDE, probe) {
            radiance += beam * UNIFORM_SPHERE_DENSITY;
        }
    }
    Some(radiance)
}
