//! The path that `smallpt` and `bsdf` share: emission is collected wherever the path arrives, directions come from the surface, and point
//! lights, which no path can arrive at, are asked at every vertex.
//!
//! Written as a loop over a small stack: glass may split a path at its first vertices, and no scene can overflow the thread's stack.

use super::direct::{light_at_fog, light_at_surface};
use super::medium::Medium;
use super::{Estimator, Options, Probe};
use crate::effect::EffectSet;
use crate::material::{BsdfSample, Density};
use crate::math::{Ray, Rgb, Vec3, dot};
use crate::sampling::{Address, Purpose, SampleKey, Sampler, uniform_sphere};
use crate::scene::{BACKGROUND, FOG, Hit, Scene, Standpoint, Tests};
use std::marker::PhantomData;

/// Where a path is cut whatever its throughput: only a closed scene that absorbs nothing comes here, and it is counted.
pub const MAX_BOUNCES: u16 = u16::MAX;

/// Roulette starts behind this vertex (smallpt: `if (++depth > 5)`).
const ROULETTE_AFTER: u16 = 5;

/// Two splits leave at most three unfinished parts.
const LARGEST_STACK: usize = 3;

/// What tells the estimators of this file apart.
pub trait Rules: Send + Sync {
    /// At this many vertices, counted from the first, a surface that reflects and transmits is followed both ways; at most 2.
    const SPLITS: u16;
    /// Samples per pixel must be a multiple of this.
    const SPP_MULTIPLE: u32;
}

/// An estimator that follows paths by these rules.
#[derive(Debug, Clone, Copy)]
pub struct Path<R> {
    max_depth: u16,
    rules: PhantomData<R>,
}

impl<R> Path<R> {
    /// The estimator; without a depth of its own it follows paths to [`MAX_BOUNCES`].
    pub fn new(options: Options) -> Self {
        Self { max_depth: options.max_depth.unwrap_or(MAX_BOUNCES), rules: PhantomData }
    }
}

impl<R: Rules> Estimator for Path<R> {
    const SPP_MULTIPLE: u32 = R::SPP_MULTIPLE;

    #[inline(always)]
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        let walk = Walk { scene, key, sampler, max_depth: self.max_depth };
        let mut collected = Rgb::BLACK;
        let mut part =
            Part { ray, from: None, throughput: Rgb::WHITE, vertices: 0, branch: 0, medium: Medium::OUTSIDE };
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

/// What is the same for all parts of a path.
struct Walk<'a, S> {
    scene: &'a Scene,
    key: SampleKey,
    sampler: &'a S,
    max_depth: u16,
}

/// A part of a path that waits to be followed.
#[derive(Clone, Copy)]
struct Part {
    ray: Ray,
    from: Option<Standpoint>,
    throughput: Rgb,
    vertices: u16,
    branch: u16,
    medium: Medium,
}

impl Part {
    /// The numbers of the vertex that this part is on its way to.
    #[inline(always)]
    fn address(&self, key: SampleKey, purpose: Purpose) -> Address {
        Address { key, bounce: self.vertices + 1, branch: self.branch, purpose }
    }
}

impl<S: Sampler> Walk<'_, S> {
    #[inline(always)]
    fn pair(&self, part: &Part, purpose: Purpose) -> [f64; 2] {
        self.sampler.pair(part.address(self.key, purpose))
    }

    /// Traces a part to its next vertex. What goes on from there, and, after a split, the other way; `None` when the part has ended.
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
            let glow = part.throughput * fog.glow(way);
            probe.light(part.vertices, glow);
            *collected += glow;
            let transmittance = fog.transmittance(way);
            part.throughput = part.throughput * transmittance;
            if free < reach {
                probe.scattered(part.vertices, &part.ray, free, part.throughput);
                return self.scatter::<X, P>(part, transmittance, part.ray.at(free), probe, collected);
            }
        }
        let Some(hit) = hit else {
            if X::EFFECTS.cover(BACKGROUND)
                && let Some(background) = scene.background.filter(|radiance| !radiance.is_black())
            {
                probe.used(BACKGROUND);
                probe.light(part.vertices, part.throughput * background);
                *collected += part.throughput * background;
            }
            probe.escaped();
            probe.ended(part.vertices);
            return None;
        };
        self.surface::<R, X, P>(part, &hit, probe, collected)
    }

    /// What happens at a point of a surface.
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
        let emission = object.emitted::<X>(dot(part.ray.direction, hit.normal).abs());
        probe.light(part.vertices, part.throughput * emission);
        *collected += part.throughput * emission;
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

        let mut throughput = part.throughput;
        if vertices > ROULETTE_AFTER {
            let survival = object.material.albedo::<X>().max_channel();
            // A number equal to the chance ends the path, so a black surface ends every path, whatever the number.
            if self.pair(&part, Purpose::Roulette)[0] >= survival {
                probe.roulette();
                probe.ended(part.vertices);
                return None;
            }
            throughput = throughput * (1.0 / survival);
        }

        probe.used(object.material.effect());
        let frame = hit.frame();
        let wo = frame.to_local(-part.ray.direction);
        let leave = |sample: BsdfSample, branch: u16| {
            let towards = frame.to_world(sample.wi);
            // A chain of delta bounces would let the length drift; any other direction is made anew.
            let direction = if sample.density == Density::Delta { towards.normalized() } else { towards };
            let ray = Ray { origin: hit.point, direction };
            let from = Some(Standpoint { primitive: hit.primitive, inside: (sample.wi.z < 0.0) != hit.inside });
            let medium = part.medium.beyond::<X>(hit, sample.wi);
            Part { ray, from, throughput: throughput * sample.weight, vertices, branch, medium }
        };
        if vertices <= R::SPLITS
            && let [Some(reflected), Some(refracted)] = object.material.delta_lobes::<X>(wo, hit.inside)
        {
            probe.split(part.vertices);
            return Some((leave(reflected, part.branch), Some(leave(refracted, part.branch | 1 << (vertices - 1)))));
        }
        let sample = object.material.sample::<X>(wo, hit.inside, self.pair(&part, Purpose::Bsdf));
        let next = sample.map(|sample| leave(sample, part.branch));
        // Nothing that a black part still finds could reach the film.
        let next = next.filter(|next| !next.throughput.is_black());
        if next.is_none() {
            probe.ended(part.vertices);
        }
        Some((next?, None))
    }

    /// What happens where fog scatters light, evenly in all directions. Absorption on the way is the survival of roulette.
    #[inline(never)]
    fn scatter<X: EffectSet, P: Probe>(
        &self,
        part: Part,
        transmittance: Rgb,
        point: Vec3,
        probe: &mut P,
        collected: &mut Rgb,
    ) -> Option<(Part, Option<Part>)> {
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
        let mut throughput = part.throughput;
        if vertices > ROULETTE_AFTER {
            let survival = transmittance.max_channel();
            if self.pair(&part, Purpose::Roulette)[0] >= survival {
                probe.roulette();
                probe.ended(part.vertices);
                return None;
            }
            throughput = throughput * (1.0 / survival);
        }
        let direction = uniform_sphere(self.pair(&part, Purpose::Bsdf)).normalized();
        let ray = Ray { origin: point, direction };
        Some((Part { ray, from: None, throughput, vertices, ..part }, None))
    }
}
