//! Next-event estimation in lanes, with a shadow ray from every lane that a light can reach.

use super::kernel::Lanes;
use super::others::{Others, Place};
use super::packet::{Arrival, Packet, Vertex, own_root};
use super::rays::Rays;
use super::tables::Kind;
use super::targets::{Met, Start};
use crate::simd::{Apart, Float, Mask, Words};
use pathmark_tracer::estimator::{LightSampling, camera_share, power_heuristic};
use pathmark_tracer::kernel::Counts;
use pathmark_tracer::math::{Bits, Ray, Rgb, Vec3};
use pathmark_tracer::sampling::Purpose;
use std::f64::consts::FRAC_1_PI;

/// Light from given directions, scattered by surfaces.
struct Lit<V: Float> {
    /// The lanes that scatter any light.
    lanes: V::Mask,
    scattered: Rgb<V>,
    /// The density with which the surface itself samples the direction.
    density: V,
}

/// Rays that met an emitting surface. A separate function, because few rays do, and the time to compile a function
/// grows with the square of its length.
pub(super) struct ArrivedAtLight<'a, V: Float> {
    pub(super) kernel: &'a Lanes,
    pub(super) packet: &'a Packet<'a, V>,
    pub(super) at: &'a Arrival<V>,
    pub(super) lit: V::Mask,
}

impl<V: Float> Apart for ArrivedAtLight<'_, V> {
    type Output = V;

    #[inline(always)]
    fn run(self) -> V {
        self.kernel.mis_weight_bsdf(self.packet, self.at, self.lit)
    }
}

impl Lanes {
    /// Weights the light that paths meet: light that a camera ray sees counts by this ray's share.
    #[inline(always)]
    pub(super) fn counted<V: Float>(&self, packet: &Packet<'_, V>, light: Rgb<V>) -> Rgb<V> {
        if self.rules.camera_rays == 1 {
            return light;
        }
        let is_seen = packet.vertices.equal(V::Bits::splat(0));
        Rgb::select(is_seen, light * V::splat(camera_share(self.rules.camera_rays)), light)
    }

    /// The weight of emission that rays met, for rays whose start aimed at light, too; 1 for the others.
    #[inline(always)]
    fn mis_weight_bsdf<V: Float>(&self, packet: &Packet<'_, V>, at: &Arrival<V>, lit: V::Mask) -> V {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let lanes = lit & zero.le(packet.density);
        if !lanes.any() {
            return one;
        }
        let aimed = match &self.targets {
            Some(lights) => {
                let Rays { ray, from, own_root } = packet.rays;
                let inside = own_root.equal(own_root);
                let start = Start { point: ray.origin, primitive: from, inside };
                lights.density(&start, &ray, &Met { primitive: at.primitive, t: at.t, normal: at.normal })
            }
            None => zero,
        };
        let share = match self.rules.nee {
            Some(LightSampling::Mis) => power_heuristic(packet.density, aimed),
            _ => V::select(zero.lt(aimed), zero, one),
        };
        V::select(lanes, share, one)
    }

    /// Adds the light from next-event estimation.
    #[inline(always)]
    pub(super) fn aim<V: Float>(
        &self,
        packet: &mut Packet<'_, V>,
        at: &Arrival<V>,
        vertex: &Vertex<V>,
        ended: u32,
        counts: &mut Counts,
    ) {
        let Some(targets) = &self.targets else { return };
        let going_on = at.lanes & !V::Mask::from_bits(ended);
        let place = self.sampler.pair::<V>(&packet.words, vertex.number, packet.branch, Purpose::Light);
        let choice = if targets.are_several() {
            self.sampler.number::<V>(&packet.words, vertex.number, packet.branch, Purpose::LightChoice)
        } else {
            V::splat(0.0)
        };
        let start = Start { point: at.point, primitive: at.primitive, inside: at.inside };
        let aims = targets.aim(&start, choice, place);
        let wi = at.frame.to_local(aims.direction);
        let lit = self.scattered(packet, at, vertex, wi, going_on & aims.lanes);
        if !lit.lanes.any() {
            return;
        }
        let own_root = own_root(at, wi, aims.direction);
        let rays = Rays { ray: Ray { origin: at.point, direction: aims.direction }, from: at.primitive, own_root };
        let (_, met) = self.nearest(&rays, lit.lanes.bits(), &mut packet.scratch, counts);
        counts.rays += u64::from(lit.lanes.bits().count_ones());
        let [r, g, b, _] = V::rows(&self.tables.emissions, self.tables.rows(aims.primitive));
        let weight = match self.rules.nee {
            Some(LightSampling::Mis) => power_heuristic(aims.density, lit.density),
            _ => V::splat(1.0),
        };
        let found = lit.scattered * Rgb { r, g, b } * (weight / aims.density);
        let found = packet.collected + packet.throughput * found;
        packet.collected = Rgb::select(lit.lanes & met.equal(aims.primitive), found, packet.collected);
    }

    /// Evaluates the materials of [`super::others`].
    #[inline(always)]
    fn evaluate_others<V: Float>(
        &self,
        others: &mut Others<V::One>,
        at: &Arrival<V>,
        wo: Vec3<V>,
        wi: Vec3<V>,
        lanes: V::Mask,
    ) -> (Rgb<V>, V) {
        let numbers = [at.primitive, wo.x, wo.y, wo.z, wi.x, wi.y, wi.z];
        for (asked, number) in others.asked.iter_mut().zip(&numbers) {
            number.store(asked);
        }
        let place = Place { scene: &self.scene, level: self.level, lanes: lanes.bits(), inside: at.inside.bits() };
        others.evaluate(place, V::one);
        let [r, g, b, density, ..] = &others.found;
        (Rgb { r: V::load(r), g: V::load(g), b: V::load(b) }, V::load(density))
    }

    /// Evaluates the scattering of light from the local direction `wi`.
    #[inline(always)]
    fn scattered<V: Float>(
        &self,
        packet: &mut Packet<'_, V>,
        at: &Arrival<V>,
        vertex: &Vertex<V>,
        wi: Vec3<V>,
        lanes: V::Mask,
    ) -> Lit<V> {
        let zero = V::splat(0.0);
        let wo = at.frame.to_local(-packet.rays.ray.direction);
        let cos = wi.z.abs();
        let mut scattered = vertex.albedo * V::splat(FRAC_1_PI) * cos;
        let mut density = cos * V::splat(FRAC_1_PI);
        let mut scatters = lanes & zero.lt(wo.z * wi.z) & vertex.kind.equal(zero);
        if self.tables.has_others {
            let others = lanes & vertex.kind.equal(V::splat(Kind::Other.number()));
            if others.any() {
                let (light, pdf) = self.evaluate_others(packet.others, at, wo, wi, others);
                scattered = Rgb::select(others, light, scattered);
                density = V::select(others, pdf, density);
            }
            scatters = scatters | others;
        }
        let any = zero.lt(scattered.r) | zero.lt(scattered.g) | zero.lt(scattered.b);
        Lit { lanes: scatters & any, scattered, density }
    }
}
