//! Next-event estimation: light from surfaces that a path aims at, by a shadow ray to one point of one light.

use super::Probe;
use super::medium::Medium;
use super::path::Light;
use crate::effect::EffectSet;
use crate::math::{Frame, Ray, Real, Rgb, Vec3, dot};
use crate::sampling::UNIFORM_SPHERE_DENSITY;
use crate::scene::{Aim, Hit, Lights, Scene, Standpoint, Tests};

/// The share of a way of finding light with density `a`, where another has density `b`: the power heuristic with exponent 2 (Veach and
/// Guibas 1995), by a ratio, because squares overflow.
#[inline(always)]
pub fn power_heuristic<T: Real>(a: T, b: T) -> T {
    // Both zero cannot be: who found the light had a density for it.
    let ratio = b / a;
    T::splat(1.0) / (T::splat(1.0) + ratio * ratio)
}

/// The share of light at the end of a ray that counts, when the ray's direction was chosen by a surface or by fog with `density`.
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

/// The share of light at the end of an aim that counts, where chance finds its direction with `density`.
#[inline(always)]
fn share_of_aim(rule: Light, aim: Aim, density: impl FnOnce() -> f64) -> f64 {
    match rule {
        Light::Weighted => power_heuristic(aim.density, density()),
        Light::Aimed => 1.0,
    }
}

/// What is at the end of a shadow ray: the radiance of the light, less what fog takes; `None` if it is hidden.
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
    // By its number, not by its distance: so no surface is too near to the light to hide it, and none that is not hides it.
    let hit = hit.filter(|hit| hit.primitive == primitive)?;
    let emission = scene.objects[hit.object as usize].emitted::<X>(dot(ray.direction, hit.normal).abs());
    Some(medium.fog::<X>(scene).map_or(emission, |fog| emission * fog.unhindered(hit.t)))
}

/// The radiance that an aim adds at a surface that a ray of that direction met, back along the ray, which lies in `medium`.
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
    if scattered.is_black() {
        return None;
    }
    let from = Some(Standpoint { primitive: hit.primitive, inside: (wi.z < 0.0) != hit.inside });
    let ray = Ray { origin: hit.point, direction: aim.direction };
    let light = arriving::<X, P>(scene, &ray, from, aim.primitive, medium.beyond::<X>(hit, wi), probe)?;
    let weight = share_of_aim(rule, aim, || material.pdf::<X>(wo, wi));
    Some(scattered * light * (weight / aim.density))
}

/// Likewise where fog scatters, evenly in all directions.
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
