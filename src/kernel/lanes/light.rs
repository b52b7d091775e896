//! Light that paths aim at: next-event estimation with a shadow ray from every lane that can be lit.

use super::Lanes;
use super::packet::{LanesOf, Packet, Rays, set_vector, vector};
use super::tables::Kind;
use super::vertex::{Arrival, Vertex, own_root};
use crate::estimator::power_heuristic;
use crate::kernel::Counts;
use crate::math::{Ray, Rgb, Vec3};
use crate::sampling::Purpose;
use crate::scene::{Aims, AllEffects, Hit, Lights, SphereLights, Standpoint, Start};
use crate::simd::{Float, Mask};
use std::f64::consts::FRAC_1_PI;

/// What paths aim at.
pub(super) enum Targets {
    /// Spheres.
    Spheres(Box<SphereLights>),
    /// Triangles, too: one lane after the other.
    Others,
}

impl Targets {
    /// Whether a number is needed to choose one.
    pub(super) fn are_several(&self) -> bool {
        match self {
            Self::Spheres(lights) => lights.are_several(),
            Self::Others => true,
        }
    }

    pub(super) fn of(lights: &Lights) -> Self {
        SphereLights::of(lights).map_or(Self::Others, |lights| Self::Spheres(Box::new(lights)))
    }
}

/// What a surface does with the light of some directions.
struct Lit<V: Float> {
    /// Where any is scattered.
    lanes: V::Mask,
    scattered: Rgb<V>,
    /// The density with which the surface chooses the direction itself.
    density: V,
}

impl Lanes {
    /// The share of emission that counts where rays arrived whose start aimed at light, too.
    #[inline(always)]
    pub(super) fn share_of_arrival<V: Float>(&self, packet: &Packet<V>, at: &Arrival<V>, lit: V::Mask) -> V {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let lanes = lit & zero.le(packet.density);
        if !lanes.any() {
            return one;
        }
        let aimed = match &self.targets {
            Some(Targets::Spheres(lights)) => {
                let Rays { ray, from, own_root } = packet.rays;
                let inside = own_root.equal(own_root);
                let start = Start { point: ray.origin, primitive: from, inside };
                lights.density(&start, &ray, at.primitive, at.t, at.normal)
            }
            _ => self.densities_one_by_one(packet, at, lanes),
        };
        let share = match self.course.aims {
            Some(true) => power_heuristic(packet.density, aimed),
            _ => V::select(zero.lt(aimed), zero, one),
        };
        V::select(lanes, share, one)
    }

    #[inline(always)]
    fn densities_one_by_one<V: Float>(&self, packet: &Packet<V>, at: &Arrival<V>, lanes: V::Mask) -> V {
        let mut densities = V::splat(0.0);
        let Some(lights) = &self.scene.lights else { return densities };
        let rays = &packet.rays;
        for lane in LanesOf(lanes.bits()) {
            let ray = Ray { origin: vector(&rays.ray.origin, lane), direction: vector(&rays.ray.direction, lane) };
            let primitive = at.primitive.lane(lane) as u32;
            let hit = Hit {
                t: at.t.lane(lane),
                primitive,
                object: self.scene.owners[primitive as usize],
                point: vector(&at.point, lane),
                normal: vector(&at.normal, lane),
                inside: at.inside.bits() >> lane & 1 == 1,
            };
            let from = rays.from.lane(lane);
            let inside = !rays.own_root.lane(lane).is_nan();
            let from = (from >= 0.0).then_some(Standpoint { primitive: from as u32, inside });
            densities.set_lane(lane, lights.density(&ray, from, &hit));
        }
        densities
    }

    /// Adds the light that vertices aim at.
    #[inline(always)]
    pub(super) fn aim<V: Float>(
        &self,
        packet: &mut Packet<V>,
        at: &Arrival<V>,
        vertex: &Vertex<V>,
        ended: u32,
        counts: &mut Counts,
    ) {
        let Some(targets) = &self.targets else { return };
        let going_on = at.lanes & !V::Mask::from_bits(ended);
        let place = self.sampler.pair::<V>(&packet.words, vertex.number, packet.branch, Purpose::Light);
        let choice = if targets.are_several() {
            self.sampler.pair::<V>(&packet.words, vertex.number, packet.branch, Purpose::LightChoice)[0]
        } else {
            V::splat(0.0)
        };
        let aims = match targets {
            Targets::Spheres(lights) => {
                let start = Start { point: at.point, primitive: at.primitive, inside: at.inside };
                lights.aim(&start, choice, place)
            }
            Targets::Others => self.aim_one_by_one(at, choice, place, going_on),
        };
        let wi = at.frame.to_local(aims.direction);
        let lit = self.scattered(packet, at, vertex, wi, going_on & aims.lanes);
        if !lit.lanes.any() {
            return;
        }
        let own_root = own_root(at, wi, aims.direction);
        let rays = Rays { ray: Ray { origin: at.point, direction: aims.direction }, from: at.primitive, own_root };
        let (_, met) = self.nearest(&rays, lit.lanes.bits(), counts);
        counts.rays += u64::from(lit.lanes.bits().count_ones());
        let [r, g, b, _] = V::rows(&self.tables.emissions, aims.primitive);
        let weight = match self.course.aims {
            Some(true) => power_heuristic(aims.density, lit.density),
            _ => V::splat(1.0),
        };
        let found = lit.scattered * Rgb { r, g, b } * (weight / aims.density);
        let found = packet.collected + packet.throughput * found;
        packet.collected = Rgb::select(lit.lanes & met.equal(aims.primitive), found, packet.collected);
    }

    /// What surfaces make of light from the local direction `wi`.
    #[inline(always)]
    fn scattered<V: Float>(
        &self,
        packet: &Packet<V>,
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
        let mut scatters = lanes & vertex.kind.equal(zero) & zero.lt(wo.z * wi.z);
        if self.tables.has_others {
            let others = lanes & vertex.kind.equal(V::splat(Kind::Other.number()));
            for lane in LanesOf(others.bits()) {
                let owner = self.scene.owners[at.primitive.lane(lane) as usize];
                let material = &self.scene.objects[owner as usize].material;
                let (wo, wi) = (vector(&wo, lane), vector(&wi, lane));
                let Rgb { r, g, b } = material.eval::<AllEffects>(wo, wi) * wi.z.abs();
                scattered.r.set_lane(lane, r);
                scattered.g.set_lane(lane, g);
                scattered.b.set_lane(lane, b);
                density.set_lane(lane, material.pdf::<AllEffects>(wo, wi));
            }
            scatters = scatters | others;
        }
        let any = zero.lt(scattered.r) | zero.lt(scattered.g) | zero.lt(scattered.b);
        Lit { lanes: scatters & any, scattered, density }
    }

    #[inline(always)]
    fn aim_one_by_one<V: Float>(&self, at: &Arrival<V>, choice: V, place: [V; 2], lanes: V::Mask) -> Aims<V> {
        let zero = V::splat(0.0);
        let mut aims = Aims {
            lanes: V::Mask::from_bits(0),
            direction: Vec3::new(zero, zero, zero),
            primitive: zero,
            density: zero,
        };
        let Some(lights) = &self.scene.lights else { return aims };
        let mut found = 0;
        for lane in LanesOf(lanes.bits()) {
            let inside = at.inside.bits() >> lane & 1 == 1;
            let from = Some(Standpoint { primitive: at.primitive.lane(lane) as u32, inside });
            let place = [place[0].lane(lane), place[1].lane(lane)];
            if let Some(aim) = lights.aim(vector(&at.point, lane), from, || choice.lane(lane), place) {
                set_vector(&mut aims.direction, lane, aim.direction);
                aims.primitive.set_lane(lane, f64::from(aim.primitive));
                aims.density.set_lane(lane, aim.density);
                found |= 1 << lane;
            }
        }
        aims.lanes = V::Mask::from_bits(found);
        aims
    }
}
