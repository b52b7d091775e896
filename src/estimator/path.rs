//! The path that `smallpt` and `bsdf` share: emission is collected wherever the path arrives, directions come from the surface.
//!
//! Written as a loop over a small stack: glass may split a path at its first vertices, and no scene can overflow the thread's stack.

use super::{Estimator, Probe};
use crate::material::{BsdfSample, Density, EffectSet};
use crate::math::{Frame, Ray, Rgb};
use crate::sampling::{Address, Purpose, SampleKey, Sampler};
use crate::scene::{Scene, Standpoint};

/// Where a path is cut whatever its throughput: only a closed scene that absorbs nothing comes here, and it is counted.
pub const MAX_BOUNCES: u16 = u16::MAX;

/// Roulette starts behind this vertex (smallpt: `if (++depth > 5)`).
const ROULETTE_AFTER: u16 = 5;

/// Two splits leave at most three unfinished parts.
const LARGEST_STACK: usize = 3;

/// What tells the estimators of this file apart.
pub(super) trait Rules: Send + Sync {
    /// At this many vertices, counted from the first, a surface that reflects and transmits is followed both ways; at most 2.
    const SPLITS: u16;
    /// Samples per pixel must be a multiple of this.
    const SPP_MULTIPLE: u32;
}

impl<R: Rules> Estimator for R {
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
        let mut collected = Rgb::BLACK;
        let mut part = Part { ray, from: None, throughput: Rgb::WHITE, vertices: 0, branch: 0 };
        let mut waiting = [part; LARGEST_STACK];
        let mut depth = 0;
        loop {
            while let Some(next) = advance::<R, S, X, P>(scene, part, key, sampler, probe, &mut collected) {
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

/// A part of a path that waits to be followed.
#[derive(Clone, Copy)]
struct Part {
    ray: Ray,
    from: Option<Standpoint>,
    throughput: Rgb,
    vertices: u16,
    branch: u16,
}

/// Traces a part to its next vertex. What goes on from there, and, after a split, the other way; `None` when the part has ended.
#[inline(always)]
fn advance<R: Rules, S: Sampler, X: EffectSet, P: Probe>(
    scene: &Scene,
    part: Part,
    key: SampleKey,
    sampler: &S,
    probe: &mut P,
    collected: &mut Rgb,
) -> Option<(Part, Option<Part>)> {
    probe.ray();
    let Some(hit) = scene.intersect(&part.ray, part.from) else {
        probe.escaped();
        return None;
    };
    let object = &scene.objects[hit.object as usize];
    *collected += part.throughput * object.emission;
    if part.vertices == MAX_BOUNCES {
        probe.truncated();
        return None;
    }

    let vertices = part.vertices + 1;
    let address = |purpose| Address { key, bounce: vertices, branch: part.branch, purpose };
    let mut throughput = part.throughput;
    if vertices > ROULETTE_AFTER {
        let survival = object.material.albedo().max_channel();
        // A number equal to the chance ends the path, so a black surface ends every path, whatever the number.
        if sampler.pair(address(Purpose::Roulette))[0] >= survival {
            return None;
        }
        throughput = throughput * (1.0 / survival);
    }

    let normal = if hit.inside { -hit.normal } else { hit.normal };
    let frame = Frame::around(normal);
    let wo = frame.to_local(-part.ray.direction);
    let leave = |sample: BsdfSample, branch: u16| {
        let towards = frame.to_world(sample.wi);
        // A chain of delta bounces would let the length drift; any other direction is made anew.
        let direction = if sample.density == Density::Delta { towards.normalized() } else { towards };
        let ray = Ray { origin: hit.point, direction };
        let from = Some(Standpoint { object: hit.object, inside: (sample.wi.z < 0.0) != hit.inside });
        Part { ray, from, throughput: throughput * sample.weight, vertices, branch }
    };
    if vertices <= R::SPLITS
        && let Some([reflected, refracted]) = object.material.split::<X>(wo, hit.inside)
    {
        return Some((leave(reflected, part.branch), Some(leave(refracted, part.branch | 1 << (vertices - 1)))));
    }
    let sample = object.material.sample::<X>(wo, hit.inside, sampler.pair(address(Purpose::Bsdf)))?;
    let next = leave(sample, part.branch);
    // Nothing that it still finds could reach the film.
    (!next.throughput.is_black()).then_some((next, None))
}
