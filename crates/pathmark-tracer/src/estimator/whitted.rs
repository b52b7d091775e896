//! `--estimator whitted`: Turner Whitted, "An Improved Illumination Model for Shaded Display", Communications of the
//! ACM 23(6), 1980, used by reports C and D. Surfaces receive light from point lights and by ideal reflection and
//! refraction. Light by way of diffuse surfaces is left out, so the limit is darker than the scene's true radiance.
//!
//! Every ideal reflection and refraction is followed, so only the position inside the pixel is random. A loop walks the
//! tree of rays depth first: at most one part waits at each depth.

use super::direct::light_at_surface;
use super::medium::Medium;
use super::{Estimator, Options, Probe};
use crate::effect::EffectSet;
use crate::material::BsdfSample;
use crate::math::{Frame, Ray, Rgb, dot};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::{BACKGROUND, FOG, Hit, Scene, SurfaceOrigin, Tests};

/// The default bounce limit.
const DEFAULT_DEPTH: u16 = 10;

/// The largest bounce limit: glass in glass makes up to 2^depth rays per sample.
const LARGEST_DEPTH: u16 = 32;

#[derive(Debug, Clone, Copy)]
pub struct Whitted {
    max_depth: u16,
}

impl Whitted {
    /// Creates the estimator; a limit above the largest is reduced to it.
    pub fn new(options: Options) -> Self {
        Self { max_depth: options.max_depth.unwrap_or(DEFAULT_DEPTH).min(LARGEST_DEPTH) }
    }
}

/// A ray of the tree.
#[derive(Clone, Copy)]
struct Part {
    ray: Ray,
    from: Option<SurfaceOrigin>,
    throughput: Rgb,
    bounces: u16,
    medium: Medium,
}

impl Estimator for Whitted {
    const SPP_MULTIPLE: u32 = 1;
    const MAX_DEPTH: Option<u16> = Some(DEFAULT_DEPTH);
    const LARGEST_DEPTH: u16 = LARGEST_DEPTH;

    #[inline(always)]
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        _key: SampleKey,
        _sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        let mut collected = Rgb::BLACK;
        let mut part = Part { ray, from: None, throughput: Rgb::WHITE, bounces: 0, medium: Medium::OUTSIDE };
        let mut waiting = [part; LARGEST_DEPTH as usize];
        let mut depth = 0;
        loop {
            let [first, second] = self.follow::<X, P>(scene, part, probe, &mut collected);
            match (first, second) {
                (Some(first), second) => {
                    part = first;
                    if let Some(second) = second {
                        waiting[depth] = second;
                        depth += 1;
                    }
                }
                (None, Some(only)) => part = only,
                (None, None) if depth == 0 => return collected,
                (None, None) => {
                    depth -= 1;
                    part = waiting[depth];
                }
            }
        }
    }
}

impl Whitted {
    /// Traces a part to its hit, adds the light from there, and returns the parts that continue.
    #[inline(always)]
    fn follow<X: EffectSet, P: Probe>(
        self,
        scene: &Scene,
        mut part: Part,
        probe: &mut P,
        collected: &mut Rgb,
    ) -> [Option<Part>; 2] {
        let mut add = |probe: &mut P, bounces: u16, light: Rgb| {
            probe.light(bounces, light);
            *collected += light;
        };
        let mut tests = Tests::default();
        let hit = scene.intersect::<X>(&part.ray, part.from, &mut tests);
        probe.ray(tests);
        if let Some(fog) = part.medium.fog::<X>(scene) {
            probe.used(FOG);
            let way = hit.map_or(f64::INFINITY, |hit| hit.t);
            add(probe, part.bounces, part.throughput * fog.unhindered_glow(way));
            part.throughput = part.throughput * fog.unhindered(way);
        }
        let Some(hit) = hit else {
            if X::EFFECTS.cover(BACKGROUND)
                && let Some(background) = scene.background.filter(|radiance| !radiance.is_black())
            {
                probe.used(BACKGROUND);
                add(probe, part.bounces, part.throughput * background);
            }
            probe.escaped();
            probe.ended(part.bounces);
            return [None, None];
        };
        let object = &scene.objects[hit.object as usize];
        probe.vertex(part.bounces, &part.ray, &hit, part.throughput);
        let emitted = object.emitted::<X>(dot(hit.normal, part.ray.direction).abs());
        add(probe, part.bounces, part.throughput * emitted);
        if part.bounces == self.max_depth {
            probe.truncated();
            probe.ended(part.bounces);
            return [None, None];
        }

        if let Some(direct) = light_at_surface::<X, P>(scene, &hit, part.ray.direction, part.medium, probe) {
            add(probe, part.bounces + 1, part.throughput * direct);
        }
        probe.used(object.material.effect());
        let frame = hit.frame();
        let wo = frame.to_local(-part.ray.direction);
        let lobes = object.material.delta_lobes::<X>(wo, hit.inside);
        let next = lobes.map(|lobe| lobe.and_then(|lobe| part.after::<X>(&hit, &frame, &lobe)));
        if next.iter().all(Option::is_none) {
            probe.ended(part.bounces);
        }
        next
    }
}

impl Part {
    /// The part that leaves a surface by one of its lobes; `None` if its throughput is black.
    #[inline(always)]
    fn after<X: EffectSet>(&self, hit: &Hit, frame: &Frame, lobe: &BsdfSample) -> Option<Self> {
        let throughput = self.throughput * lobe.weight;
        let direction = frame.to_world(lobe.wi).normalized();
        let from = Some(SurfaceOrigin { primitive: hit.primitive, inside: (lobe.wi.z < 0.0) != hit.inside });
        let medium = self.medium.beyond::<X>(hit, lobe.wi);
        let ray = Ray { origin: hit.point, direction };
        (!throughput.is_black()).then_some(Self { ray, from, throughput, bounces: self.bounces + 1, medium })
    }
}
