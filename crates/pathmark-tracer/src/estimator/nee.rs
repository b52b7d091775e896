//! Next-event estimation: emission of surfaces, found by a shadow ray to one point of one light.

use super::Probe;
use super::medium::Medium;
use crate::effect::EffectSet;
use crate::math::{Frame, Ray, Real, Rgb, Vec3, dot};
use crate::sampling::UNIFORM_SPHERE_DENSITY;
use crate::scene::{Aim, Hit, Lights, Scene, SurfaceOrigin, Tests};

/// How the emission of surfaces is counted under next-event estimation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightSampling {
    /// By sampling a light from every vertex; a hit counts only where no light can be sampled.
    Nee,
    /// By sampled lights and by hits, weighted by their densities.
    Mis,
}

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
pub(super) fn mis_weight_bsdf(
    rule: LightSampling,
    lights: &Lights,
    ray: &Ray,
    from: Option<SurfaceOrigin>,
    hit: &Hit,
    density: f64,
) -> f64 {
    let aimed = lights.density(ray, from, hit);
    match rule {
        LightSampling::Mis => power_heuristic(density, aimed),
        LightSampling::Nee if aimed > 0.0 => 0.0,
        LightSampling::Nee => 1.0,
    }
}

/// The weight of light that was aimed at, if a surface or fog samples the same direction with `density`.
#[inline(always)]
fn mis_weight_light(rule: LightSampling, aim: Aim, density: impl FnOnce() -> f64) -> f64 {
    match rule {
        LightSampling::Mis => power_heuristic(aim.density, density()),
        LightSampling::Nee => 1.0,
    }
}

/// The light's radiance at the end of a shadow ray, attenuated by fog; `None` if the light is hidden.
#[inline(always)]
fn arriving<X: EffectSet, P: Probe>(
    scene: &Scene,
    ray: &Ray,
    from: Option<SurfaceOrigin>,
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
pub(super) fn nee_at_surface<X: EffectSet, P: Probe>(
    rule: LightSampling,
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
    let from = Some(SurfaceOrigin { primitive: hit.primitive, inside: (wi.z < 0.0) != hit.inside });
    let ray = Ray { origin: hit.point, direction: aim.direction };
    let light = arriving::<X, P>(scene, &ray, from, aim.primitive, medium.beyond::<X>(hit, wi), probe)?;
    let weight = mis_weight_light(rule, aim, || material.pdf::<X>(wo, wi));
    Some(scattered * light * (weight / aim.density))
}

/// The same for a scattering event in fog, which is isotropic.
#[inline(always)]
pub(super) fn nee_at_fog<X: EffectSet, P: Probe>(
    rule: LightSampling,
    scene: &Scene,
    point: Vec3,
    aim: Aim,
    probe: &mut P,
) -> Option<Rgb> {
    let ray = Ray { origin: point, direction: aim.direction };
    let light = arriving::<X, P>(scene, &ray, None, aim.primitive, Medium::OUTSIDE, probe)?;
    let weight = mis_weight_light(rule, aim, || UNIFORM_SPHERE_DENSITY);
    Some(light * (UNIFORM_SPHERE_DENSITY * weight / aim.density))
}
