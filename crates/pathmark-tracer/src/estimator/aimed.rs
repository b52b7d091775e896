//! Next-event estimation: emission of surfaces, found by a shadow ray to one point of one light.

use super::Probe;
use super::medium::Medium;
use super::path::Light;
use crate::effect::EffectSet;
use crate::math::{Frame, Ray, Real, Rgb, Vec3, dot};
use crate::sampling::UNIFORM_SPHERE_DENSITY;
use crate::scene::{Aim, Hit, Lights, Scene, Standpoint, Tests};

/// The weight of a way to find light with density `a`, if another way has density `b`: the power heuristic with
/// exponent 2 (Veach and Guibas 1995). It is computed from a ratio, because squares overflow.
#[inline(always)]
pub fn power_heuristic<T: Real>(a: T, b: T) -> T {
    // They cannot both be zero: the way that found the light has a positive density.
    let ratio = b / a;
    T::splat(1.0) / (T::splat(1.0) + ratio * ratio)
}

/// The weight of a hit of a light, if a surface or fog sampled the ray's direction with `density`.
#[inline(always)]
pub(super) fn share_of_arrival(
    rule: Light,
    lights: &Lights,
    ray: &Ray,
    from: Option<Standpoint>,
    hit: &Hit,
    density: f64,
) -> f64 {
    let aimed = lights.density(ray, from, hit);
    match rule {
        Light::Weighted => power_heuristic(density, aimed),
        Light::Aimed if aimed > 0.0 => 0.0,
        Light::Aimed => 1.0,
    }
}

/// The weight of light that was aimed at, if a surface or fog samples the same direction with `density`.
#[inline(always)]
fn share_of_aim(rule: Light, aim: Aim, density: impl FnOnce() -> f64) -> f64 {
    match rule {
        Light::Weighted => power_heuristic(aim.density, density()),
        Light::Aimed => 1.0,
    }
}

/// The light's radiance at the end of a shadow ray, attenuated by fog; `None` if the light is hidden.
#[inline(always)]
fn arriving<X: EffectSet, P: Probe>(
    scene: &Scene,
    ray: &Ray,
    from: Option<Standpoint>,
    primitive: u32,
    medium: Medium,
    probe: &mut P,
) -> Option<Rgb> {
    let mut tests = Tests::default();
    let hit = scene.intersect::<X>(ray, from, &mut tests);
    probe.ray(tests);
    // Compared by index, not by distance: a surface very close to the light still hides it, and rounding errors never
    // do.
    let hit = hit.filter(|hit| hit.primitive == primitive)?;
    let emission = scene.objects[hit.object as usize].emitted::<X>(dot(ray.direction, hit.normal).abs());
    Some(medium.fog::<X>(scene).map_or(emission, |fog| emission * fog.unhindered(hit.t)))
}

/// The radiance that an aim adds at a surface, back along the ray that hit it and lies in `medium`; `None` if there is
/// none.
#[inline(always)]
pub(super) fn aimed_at_surface<X: EffectSet, P: Probe>(
    rule: Light,
    scene: &Scene,
    hit: &Hit,
    (frame, wo): (&Frame, Vec3),
    aim: Aim,
    medium: Medium,
    probe: &mut P,
) -> Option<Rgb> {
    let wi = frame.to_local(aim.direction);
    let material = &scene.objects[hit.object as usize].material;
    let scattered = material.eval::<X>(wo, wi) * wi.z.abs();
    if !scattered.has_light() {
        return None;
    }
    let from = Some(Standpoint { primitive: hit.primitive, inside: (wi.z < 0.0) != hit.inside });
    let ray = Ray { origin: hit.point, direction: aim.direction };
    let light = arriving::<X, P>(scene, &ray, from, aim.primitive, medium.beyond::<X>(hit, wi), probe)?;
    let weight = share_of_aim(rule, aim, || material.pdf::<X>(wo, wi));
    Some(scattered * light * (weight / aim.density))
}

/// The same for a scattering event in fog, which is isotropic.
#[inline(always)]
pub(super) fn aimed_at_fog<X: EffectSet, P: Probe>(
    rule: Light,
    scene: &Scene,
    point: Vec3,
    aim: Aim,
    probe: &mut P,
) -> Option<Rgb> {
    let ray = Ray { origin: point, direction: aim.direction };
    let light = arriving::<X, P>(scene, &ray, None, aim.primitive, Medium::OUTSIDE, probe)?;
    let weight = share_of_aim(rule, aim, || UNIFORM_SPHERE_DENSITY);
    Some(light * (UNIFORM_SPHERE_DENSITY * weight / aim.density))
}
