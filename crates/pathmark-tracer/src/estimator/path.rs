//! The path that `smallpt`, `bsdf`, `nee` and `mis` share. The surface's BSDF chooses directions. Emission is collected
//! where the path hits it or aims at it. Point lights, which no path can hit, are evaluated at every vertex.
//!
//! The path is a loop over a small stack: glass may split a path at its first vertices, and no scene can overflow the
//! thread's stack.

use super::direct::{light_at_fog, light_at_surface};
use super::medium::Medium;
use super::nee::{LightSampling, mis_weight_bsdf, nee_at_fog, nee_at_surface};
use super::{Compiled, Estimator, Options, PathRules, Probe, Roulette, camera_share};
use crate::effect::EffectSet;
use crate::material::{BsdfSample, Density};
use crate::math::{Ray, Rgb, Vec3, dot};
use crate::sampling::{Address, Purpose, SampleKey, Sampler, UNIFORM_SPHERE_DENSITY, uniform_sphere};
use crate::scene::{Aim, BACKGROUND, FOG, Hit, Scene, SurfaceOrigin, Tests};
use std::marker::PhantomData;

/// The default bounce limit. Only a closed scene that absorbs nothing reaches it, and such cuts are counted.
pub const MAX_BOUNCES: u16 = u16::MAX;

/// Two splits leave at most three unfinished parts.
const LARGEST_STACK: usize = 3;

/// The rules in which the estimators of this file differ.
pub trait Rules: Send + Sync {
    /// Number of first vertices at which a path follows both reflection and transmission; at most 2.
    const SPLITS: u16;
    /// Samples per pixel must be a multiple of this.
    const SPP_MULTIPLE: u32;
    /// Whether vertices aim at lights: next-event estimation.
    const AIMS: bool;
    /// The effect profiles that scalar kernels are compiled for.
    const COMPILED: Compiled = Compiled::Common;
}

/// The rules of `nee` and `mis`. They differ only in a run-time value, so one kernel serves both.
#[derive(Debug, Clone, Copy)]
pub struct Nee;

impl Rules for Nee {
    const SPLITS: u16 = 0;
    const SPP_MULTIPLE: u32 = 1;
    const AIMS: bool = true;
}

/// An estimator that follows paths by these rules.
#[derive(Debug, Clone, Copy)]
pub struct Path<R> {
    max_depth: u16,
    roulette: Roulette,
    camera_rays: u16,
    light: LightSampling,
    rules: PhantomData<R>,
}

impl<R> Path<R> {
    /// Creates the estimator; without a requested limit it follows paths to [`MAX_BOUNCES`].
    pub fn new(options: Options) -> Self {
        Self {
            max_depth: options.max_depth.unwrap_or(MAX_BOUNCES),
            roulette: options.roulette.unwrap_or(Roulette::SMALLPT),
            camera_rays: options.camera_rays(),
            // Estimators without next-event estimation do not read it.
            light: LightSampling::Mis,
            rules: PhantomData,
        }
    }
}

impl Path<Nee> {
    /// `--estimator nee`: next-event estimation. The path samples a light from every vertex. Light that it then hits by
    /// chance is not counted again. A hit counts where no light was sampled: behind mirrors and glass, for camera rays,
    /// and on lights that are no target.
    pub(super) fn nee(options: Options) -> Self {
        Self { light: LightSampling::Nee, ..Self::new(options) }
    }

    /// `--estimator mis`: multiple importance sampling. Light is sampled as well as hit by chance, and each way is
    /// weighted by its density with the power heuristic (Veach and Guibas, "Optimally Combining Sampling Techniques for
    /// Monte Carlo Rendering", 1995).
    pub(super) fn mis(options: Options) -> Self {
        Self { light: LightSampling::Mis, ..Self::new(options) }
    }
}

impl<R: Rules> Estimator for Path<R> {
    fn rules(&self) -> Option<PathRules> {
        let nee = R::AIMS.then_some(self.light);
        let Self { max_depth, roulette, camera_rays, .. } = *self;
        Some(PathRules { splits: R::SPLITS, nee, max_depth, roulette, camera_rays })
    }

    const SPP_MULTIPLE: u32 = R::SPP_MULTIPLE;
    const ROULETTE: Option<Roulette> = Some(Roulette::SMALLPT);
    const AIMS: bool = R::AIMS;
    const COMPILED: Compiled = R::COMPILED;
    const IS_ONE_PATH: bool = R::SPLITS == 0;
    const SHARES_CAMERA_RAYS: bool = true;

    #[inline(always)]
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        let Self { max_depth, roulette, light, .. } = *self;
        let seen_share = camera_share(self.camera_rays);
        let walk = Walk { scene, key, sampler, max_depth, roulette, light, seen_share };
        let mut collected = Rgb::BLACK;
        let mut part = Part {
            ray,
            from: None,
            density: None,
            throughput: Rgb::WHITE,
            vertices: 0,
            branch: 0,
            medium: Medium::OUTSIDE,
        };
        let mut waiting = [part; LARGEST_STACK];
        let mut depth = 0;
        loop {
            while let Some(next) = walk.advance::<R, X, P>(part, probe, &mut collected) {
                part = next.0;
                if let Some(other) = next.1 {
                    waiting[depth] = other;
                    depth += 1;
                }
            }
            if depth == 0 {
                return collected;
            }
            depth -= 1;
            part = waiting[depth];
        }
    }
}

/// Chooses one of two lobes with a probability proportional to its weight, so that neither result weighs more than both
/// lobes together. smallpt refracts more rarely, and every such vertex then increases the variance.
#[inline(always)]
fn by_share(lobes: [BsdfSample; 2], u: f64) -> BsdfSample {
    let [first, second] = lobes.map(|lobe| lobe.weight.max_channel());
    let both = first + second;
    // If both are black, either choice returns black.
    let chance = if both > 0.0 { first / both } else { 0.5 };
    let (lobe, chance) = if u < chance { (lobes[0], chance) } else { (lobes[1], 1.0 - chance) };
    BsdfSample { weight: lobe.weight * (1.0 / chance), ..lobe }
}

/// Whether a throughput is too small for a part's light to reach the film. Below the smallest normal number a
/// throughput may never become 0: nine tenths of 4 units are rounded to 4 units. A path with a NaN goes on, so that the
/// NaN is counted.
#[inline(always)]
fn is_spent(throughput: Rgb) -> bool {
    throughput.r < f64::MIN_POSITIVE && throughput.g < f64::MIN_POSITIVE && throughput.b < f64::MIN_POSITIVE
}

/// The values that all parts of a path share.
struct Walk<'a, S> {
    scene: &'a Scene,
    key: SampleKey,
    sampler: &'a S,
    max_depth: u16,
    roulette: Roulette,
    light: LightSampling,
    /// The share with which light at the end of the camera ray counts.
    seen_share: f64,
}

/// A part of a path that waits to be followed.
#[derive(Clone, Copy)]
struct Part {
    ray: Ray,
    from: Option<SurfaceOrigin>,
    /// The density of the ray's direction, per steradian, if its start used next-event estimation.
    density: Option<f64>,
    throughput: Rgb,
    vertices: u16,
    branch: u16,
    medium: Medium,
}

impl Part {
    /// The address of the random numbers of this part's next vertex. After the last possible vertex it wraps around to
    /// 0, the camera's. There a path only samples its distance in fog, which the camera never does.
    #[inline(always)]
    fn address(&self, key: SampleKey, purpose: Purpose) -> Address {
        Address { key, bounce: self.vertices.wrapping_add(1), branch: self.branch, purpose }
    }
}

impl<S: Sampler> Walk<'_, S> {
    #[inline(always)]
    fn pair(&self, part: &Part, purpose: Purpose) -> [f64; 2] {
        self.sampler.pair(part.address(self.key, purpose))
    }

    /// Scales the light that a part reaches: the end of a camera ray counts by its share.
    #[inline(always)]
    fn counted(&self, part: &Part, light: Rgb) -> Rgb {
        if part.vertices == 0 { light * self.seen_share } else { light }
    }

    /// Samples a direction towards a light from the vertex that a part has reached.
    #[inline(always)]
    fn aim<R: Rules>(&self, part: &Part, point: Vec3, from: Option<SurfaceOrigin>) -> Option<Aim> {
        let lights = if R::AIMS { self.scene.lights.as_ref()? } else { return None };
        let choice = || self.pair(part, Purpose::LightChoice)[0];
        lights.aim(point, from, choice, self.pair(part, Purpose::Light))
    }

    /// Traces a part to its next vertex. Returns the part that continues and, after a split, the other one; `None` if
    /// the part ended.
    #[inline(always)]
    fn advance<R: Rules, X: EffectSet, P: Probe>(
        &self,
        mut part: Part,
        probe: &mut P,
        collected: &mut Rgb,
    ) -> Option<(Part, Option<Part>)> {
        let scene = self.scene;
        let mut tests = Tests::default();
        let hit = scene.intersect::<X>(&part.ray, part.from, &mut tests);
        probe.ray(tests);
        if let Some(fog) = part.medium.fog::<X>(scene) {
            probe.used(FOG);
            let reach = hit.map_or(f64::INFINITY, |hit| hit.t);
            let free = fog.free_path(|| self.pair(&part, Purpose::Medium)[0]);
            let way = reach.min(free);
            let glow = self.counted(&part, part.throughput * fog.glow(way));
            probe.light(part.vertices, glow);
            *collected += glow;
            let transmittance = fog.transmittance(way);
            part.throughput = part.throughput * transmittance;
            if free < reach {
                probe.scattered(part.vertices, &part.ray, free, part.throughput);
                return self.scatter::<R, X, P>(part, transmittance, part.ray.at(free), probe, collected);
            }
        }
        let Some(hit) = hit else {
            if X::EFFECTS.cover(BACKGROUND)
                && let Some(background) = scene.background.filter(|radiance| !radiance.is_black())
            {
                probe.used(BACKGROUND);
                let found = self.counted(&part, part.throughput * background);
                probe.light(part.vertices, found);
                *collected += found;
            }
            probe.escaped();
            probe.ended(part.vertices);
            return None;
        };
        self.surface::<R, X, P>(part, &hit, probe, collected)
    }

    /// Processes a hit of a surface: adds its light and samples the next direction.
    #[inline(always)]
    fn surface<R: Rules, X: EffectSet, P: Probe>(
        &self,
        part: Part,
        hit: &Hit,
        probe: &mut P,
        collected: &mut Rgb,
    ) -> Option<(Part, Option<Part>)> {
        let scene = self.scene;
        let object = &scene.objects[hit.object as usize];
        probe.vertex(part.vertices, &part.ray, hit, part.throughput);
        let mut emission = object.emitted::<X>(dot(part.ray.direction, hit.normal).abs());
        if R::AIMS
            && let (Some(density), Some(lights)) = (part.density, &scene.lights)
            && !emission.is_black()
        {
            emission = emission * mis_weight_bsdf(self.light, lights, &part.ray, part.from, hit, density);
        }
        let found = self.counted(&part, part.throughput * emission);
        probe.light(part.vertices, found);
        *collected += found;
        if part.vertices == self.max_depth {
            probe.truncated();
            probe.ended(part.vertices);
            return None;
        }

        let vertices = part.vertices + 1;
        if let Some(direct) = light_at_surface::<X, P>(scene, hit, part.ray.direction, part.medium, probe) {
            probe.light(vertices, part.throughput * direct);
            *collected += part.throughput * direct;
        }

        let frame = hit.frame();
        let wo = frame.to_local(-part.ray.direction);
        let standpoint = SurfaceOrigin { primitive: hit.primitive, inside: hit.inside };
        if let Some(aim) = self.aim::<R>(&part, hit.point, Some(standpoint))
            && let Some(found) = nee_at_surface::<X, P>(self.light, scene, hit, (&frame, wo), aim, part.medium, probe)
        {
            probe.light(vertices, part.throughput * found);
            *collected += part.throughput * found;
        }

        let mut throughput = part.throughput;
        if let Some(survival) = self.roulette.survival(vertices, throughput, || object.material.albedo::<X>()) {
            // A number equal to the survival probability ends the path, so a black surface ends every path.
            if self.pair(&part, Purpose::Roulette)[0] >= survival {
                probe.roulette();
                probe.ended(part.vertices);
                return None;
            }
            throughput = throughput * (1.0 / survival);
        }

        probe.used(object.material.effect());
        let leave = |sample: BsdfSample, branch: u16| {
            let towards = frame.to_world(sample.wi);
            // Over a chain of delta bounces the length would drift; all other directions are computed afresh.
            let direction = if sample.density == Density::Delta { towards.normalized() } else { towards };
            let ray = Ray { origin: hit.point, direction };
            let from = Some(SurfaceOrigin { primitive: hit.primitive, inside: (sample.wi.z < 0.0) != hit.inside });
            let medium = part.medium.beyond::<X>(hit, sample.wi);
            let density = match sample.density {
                Density::PerSolidAngle(density) if R::AIMS => Some(density),
                _ => None,
            };
            Part { ray, from, density, throughput: throughput * sample.weight, vertices, branch, medium }
        };
        if vertices <= R::SPLITS
            && let [Some(reflected), Some(refracted)] = object.material.delta_lobes::<X>(wo, hit.inside)
        {
            probe.split(part.vertices);
            return Some((leave(reflected, part.branch), Some(leave(refracted, part.branch | 1 << (vertices - 1)))));
        }
        let numbers = self.pair(&part, Purpose::Bsdf);
        let sample = if R::AIMS
            && let [Some(reflected), Some(refracted)] = object.material.delta_lobes::<X>(wo, hit.inside)
        {
            Some(by_share([reflected, refracted], numbers[0]))
        } else {
            object.material.sample::<X>(wo, hit.inside, numbers)
        };
        let next = sample.map(|sample| leave(sample, part.branch));
        let next = next.filter(|next| !is_spent(next.throughput));
        if next.is_none() {
            probe.ended(part.vertices);
        }
        Some((next?, None))
    }

    /// Processes a scattering event in fog, which is isotropic. Russian roulette uses the transmittance as the albedo.
    #[inline(never)]
    fn scatter<R: Rules, X: EffectSet, P: Probe>(
        &self,
        part: Part,
        transmittance: Rgb,
        point: Vec3,
        probe: &mut P,
        collected: &mut Rgb,
    ) -> Option<(Part, Option<Part>)> {
        if is_spent(part.throughput) {
            probe.ended(part.vertices);
            return None;
        }
        if part.vertices == self.max_depth {
            probe.truncated();
            probe.ended(part.vertices);
            return None;
        }
        let vertices = part.vertices + 1;
        if let Some(direct) = light_at_fog::<X, P>(self.scene, point, probe) {
            probe.light(vertices, part.throughput * direct);
            *collected += part.throughput * direct;
        }
        if let Some(aim) = self.aim::<R>(&part, point, None)
            && let Some(found) = nee_at_fog::<X, P>(self.light, self.scene, point, aim, probe)
        {
            probe.light(vertices, part.throughput * found);
            *collected += part.throughput * found;
        }
        let mut throughput = part.throughput;
        if let Some(survival) = self.roulette.survival(vertices, throughput, || transmittance) {
            if self.pair(&part, Purpose::Roulette)[0] >= survival {
                probe.roulette();
                probe.ended(part.vertices);
                return None;
            }
            throughput = throughput * (1.0 / survival);
        }
        let direction = uniform_sphere(self.pair(&part, Purpose::Bsdf)).normalized();
        let ray = Ray { origin: point, direction };
        let density = R::AIMS.then_some(UNIFORM_SPHERE_DENSITY);
        Some((Part { ray, from: None, density, throughput, vertices, ..part }, None))
    }
}
