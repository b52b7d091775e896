//! Path vertices in lanes: the steps of [`pathmark_tracer::estimator::Path`], with a mask in place of each branch.

use super::kernel::Lanes;
use super::light::ArrivedAtLight;
use super::others::{Others, Place};
use super::packet::{Arrival, Packet, Part, Vertex, colour, own_root, vector};
use super::rays::LanesOf;
use super::tables::{GIVES_OFF, Kind};
use crate::simd::{Apart, Float, Mask, Words};
use pathmark_tracer::effect::{EffectSet, all};
use pathmark_tracer::kernel::Counts;
use pathmark_tracer::material::{Dielectric, MATERIALS, Mirror};
use pathmark_tracer::math::{
    Bits, Frame, Ray, Rgb, Vec3, curved_normal, dot, fresnel_dielectric, fresnel_schlick, reflect, refract,
};
use pathmark_tracer::sampling::{Purpose, cosine_hemisphere};
use std::marker::PhantomData;

/// The materials that the code for a profile contains. Constants and no functions: a branch on a constant is left out
/// before anything is inlined, and calls here made renders of smallpt's box take an eighth longer.
pub(super) struct Materials<X>(PhantomData<X>);

impl<X: EffectSet> Materials<X> {
    const ARE_DIFFUSE: bool = !X::EFFECTS.cover(Mirror::EFFECT);
    pub(super) const HAVE_GLASS: bool = X::EFFECTS.cover(Dielectric::EFFECT);
    /// Those that lanes have no code for.
    const HAVE_OTHERS: bool = X::EFFECTS.cover(all(MATERIALS));
}

/// Sampled directions of scattering.
struct Scattered<V: Float> {
    wi: Vec3<V>,
    weight: Rgb<V>,
    is_delta: V::Mask,
    /// Densities of the directions that are not deltas.
    density: V,
    /// The lanes whose surface absorbed the path.
    absorbed: u32,
}

/// The second directions of lanes whose paths split.
struct Split<V: Float> {
    lanes: u32,
    wi: Vec3<V>,
    weight: Rgb<V>,
}

impl Lanes {
    /// Traces each path to its next vertex and starts its next ray. Returns the lanes whose part of a path has ended.
    #[inline(always)]
    pub(super) fn advance<V: Float, X: EffectSet, const AIMS: bool>(
        &self,
        packet: &mut Packet<'_, V>,
        counts: &mut Counts,
    ) -> u32 {
        let number = packet.vertices.plus(V::Bits::splat(1));
        let (t, primitive) = self.nearest(&packet.rays, packet.alive, &mut packet.scratch, counts);
        counts.rays += u64::from(packet.alive.count_ones());
        let alive = V::Mask::from_bits(packet.alive);
        let met = alive & V::splat(0.0).le(primitive);
        let escaped = packet.alive & !met.bits();
        if escaped != 0 {
            self.escape(packet, escaped, counts);
        }
        let mut ended = escaped;
        if ended == packet.alive {
            return ended;
        }
        let row = self.tables.rows(primitive);
        let [r, g, b, kind] = V::rows(&self.tables.materials, row);
        let gives_off = V::splat(GIVES_OFF);
        let is_lamp = gives_off.le(kind);
        let vertex = Vertex { number, albedo: Rgb { r, g, b }, kind: V::select(is_lamp, kind - gives_off, kind) };
        // Without next-event estimation the point is computed last, so that fewer values occupy registers.
        let early = if AIMS { Some(self.arrive(packet, met, t, primitive)) } else { None };
        let lit = met & is_lamp;
        if lit.any() {
            let [r, g, b, _] = V::rows(&self.tables.emissions, row);
            let mut emission = Rgb { r, g, b };
            if let Some(at) = &early {
                emission = emission * V::apart(ArrivedAtLight { kernel: self, packet, at, lit });
            }
            emission = self.counted(packet, emission);
            // For a ray that met nothing, an arbitrary surface was looked up.
            let found = packet.collected + packet.throughput * emission;
            packet.collected = Rgb::select(lit, found, packet.collected);
        }
        let cut = (packet.vertices.equal(V::Bits::splat(u64::from(self.rules.max_depth))) & met).bits();
        counts.truncated += u64::from(cut.count_ones());
        ended |= cut;
        if let Some(at) = &early {
            self.aim(packet, at, &vertex, ended, counts);
        }
        ended |= self.roulette(packet, met, &vertex);
        let at = match early {
            Some(at) => at,
            None => self.arrive(packet, met, t, primitive),
        };
        let (scattered, split) = self.scatter::<V, X, AIMS>(packet, &at, &vertex, ended);
        ended |= scattered.absorbed;
        leave::<V, X>(packet, &at, number, &scattered, split, &mut ended);
        ended
    }

    /// Adds the background to paths whose rays meet nothing.
    #[inline(always)]
    fn escape<V: Float>(&self, packet: &mut Packet<'_, V>, escaped: u32, counts: &mut Counts) {
        counts.escaped += u64::from(escaped.count_ones());
        if let Some(background) = self.scene.background {
            let found = packet.collected + packet.throughput * self.counted(packet, Rgb::splat(background));
            packet.collected = Rgb::select(V::Mask::from_bits(escaped), found, packet.collected);
        }
    }

    #[inline(always)]
    fn arrive<V: Float>(&self, packet: &Packet<'_, V>, lanes: V::Mask, t: V, primitive: V) -> Arrival<V> {
        let point = packet.rays.ray.at(t);
        let [x, y, z, round] = V::rows(&self.tables.surfaces, primitive);
        let anchor = Vec3::new(x, y, z);
        let is_round = V::splat(0.0).lt(round);
        let (from_center, of_sphere);
        if V::IS_DOUBLE {
            from_center = point - anchor;
            of_sphere = from_center.normalized();
        } else {
            of_sphere = curved_normal(anchor, round, point).normalized();
            from_center = of_sphere * (V::splat(1.0) / round);
        }
        let normal = if self.tables.is_round { of_sphere } else { Vec3::select(is_round, of_sphere, anchor) };
        let inside = V::splat(0.0).lt(dot(normal, packet.rays.ray.direction));
        let frame = Frame::around(Vec3::select(inside, -normal, normal));
        Arrival { lanes, t, primitive, point, from_center, is_round, normal, inside, frame }
    }

    /// Russian roulette. Returns the lanes whose paths it ends.
    #[inline(always)]
    fn roulette<V: Float>(&self, packet: &mut Packet<'_, V>, lanes: V::Mask, vertex: &Vertex<V>) -> u32 {
        let begun = lanes & V::Bits::splat(u64::from(self.rules.roulette.after())).less(vertex.number);
        if !begun.any() {
            return 0;
        }
        let survival = self.rules.roulette.chance(packet.throughput, vertex.albedo);
        let number = self.sampler.number::<V>(&packet.words, vertex.number, packet.branch, Purpose::Roulette);
        let raised = packet.throughput * (V::splat(1.0) / survival);
        packet.throughput = Rgb::select(begun, raised, packet.throughput);
        (begun & survival.le(number)).bits()
    }

    /// Samples the directions in which paths continue.
    #[inline(always)]
    fn scatter<V: Float, X: EffectSet, const AIMS: bool>(
        &self,
        packet: &mut Packet<'_, V>,
        at: &Arrival<V>,
        vertex: &Vertex<V>,
        ended: u32,
    ) -> (Scattered<V>, Option<Split<V>>) {
        let (zero, none) = (V::splat(0.0), V::Mask::from_bits(0));
        let going_on = at.lanes & !V::Mask::from_bits(ended);
        let is_mirror = if Materials::<X>::ARE_DIFFUSE {
            none
        } else {
            going_on & vertex.kind.equal(V::splat(Kind::Mirror.number()))
        };
        let (mut numbers, mut wi) = ([zero; 2], Vec3::new(zero, zero, zero));
        // Mirrors need no random numbers.
        if Materials::<X>::ARE_DIFFUSE || is_mirror.bits() != going_on.bits() {
            numbers = self.sampler.pair::<V>(&packet.words, vertex.number, packet.branch, Purpose::Bsdf);
            wi = cosine_hemisphere(numbers);
        }
        let density = wi.z * V::splat(std::f64::consts::FRAC_1_PI);
        let mut scattered = Scattered { wi, weight: vertex.albedo, is_delta: is_mirror, density, absorbed: 0 };
        let mut split = None;
        let others = going_on & V::splat(0.5).lt(vertex.kind);
        if Materials::<X>::ARE_DIFFUSE || !others.any() {
            return (scattered, split);
        }
        let wo = at.frame.to_local(-packet.rays.ray.direction);
        scattered.wi = Vec3::select(is_mirror, reflect(wo), scattered.wi);
        let is_glass = others & vertex.kind.equal(V::splat(Kind::Dielectric.number()));
        if is_glass.any() {
            split = self.refract::<V, AIMS>(at, vertex, wo, numbers[0], is_glass, &mut scattered);
        }
        let is_other = others & vertex.kind.equal(V::splat(Kind::Other.number()));
        if Materials::<X>::HAVE_OTHERS && is_other.any() {
            self.scatter_others(packet.others, at, wo, numbers, is_other, &mut scattered);
        }
        (scattered, split)
    }

    /// Samples directions at the materials of [`super::others`].
    #[inline(always)]
    fn scatter_others<V: Float>(
        &self,
        others: &mut Others<V::One>,
        at: &Arrival<V>,
        wo: Vec3<V>,
        numbers: [V; 2],
        lanes: V::Mask,
        scattered: &mut Scattered<V>,
    ) {
        let [primitive, x, y, z, first, second, _] = &mut others.asked;
        at.primitive.store(primitive);
        wo.x.store(x);
        wo.y.store(y);
        wo.z.store(z);
        numbers[0].store(first);
        numbers[1].store(second);
        let place = Place { scene: &self.scene, level: self.level, lanes: lanes.bits(), inside: at.inside.bits() };
        others.sample(place, V::one);
        let [x, y, z, r, g, b, density] = &others.found;
        let wi = Vec3::new(V::load(x), V::load(y), V::load(z));
        let weight = Rgb { r: V::load(r), g: V::load(g), b: V::load(b) };
        scattered.wi = Vec3::select(lanes, wi, scattered.wi);
        scattered.weight = Rgb::select(lanes, weight, scattered.weight);
        scattered.density = V::select(lanes, V::load(density), scattered.density);
        scattered.is_delta = scattered.is_delta | V::Mask::from_bits(others.deltas);
        scattered.absorbed |= others.absorbed;
    }

    /// Samples reflection or refraction at dielectrics; a path that splits takes both.
    #[inline(always)]
    fn refract<V: Float, const AIMS: bool>(
        &self,
        at: &Arrival<V>,
        vertex: &Vertex<V>,
        wo: Vec3<V>,
        number: V,
        lanes: V::Mask,
        scattered: &mut Scattered<V>,
    ) -> Option<Split<V>> {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let tint = vertex.albedo;
        let [eta, inverse, r0, is_exact] = V::rows(&self.tables.interfaces, self.tables.rows(at.primitive));
        let crossed = V::select(at.inside, eta, inverse);
        let (refracted, cos2) = refract(wo, crossed);
        let is_total = cos2.lt(zero);
        let thinner = V::select(crossed.lt(one), wo.z, -refracted.z);
        let mut reflectance = fresnel_schlick(thinner, r0);
        let is_exact = lanes & V::splat(0.5).lt(is_exact);
        if is_exact.any() {
            let exact = fresnel_dielectric(wo.z, V::select(at.inside, inverse, eta));
            reflectance = V::select(is_exact, exact, reflectance);
        }
        let transmittance = one - reflectance;
        let goes_both_ways = lanes & !is_total & vertex.number.less(V::Bits::splat(u64::from(self.rules.splits) + 1));

        let (chance, reflects, weight);
        if AIMS {
            // Each lobe is chosen in proportion to its share of the light.
            let (first, second) = ((tint * reflectance).largest(), (tint * transmittance).largest());
            let both = first + second;
            chance = V::select(zero.lt(both), first / both, V::splat(0.5));
            reflects = number.lt(chance);
            let share = V::select(reflects, reflectance, transmittance);
            weight = tint * share * (one / V::select(reflects, chance, one - chance));
        } else {
            chance = V::splat(0.25) + V::splat(0.5) * reflectance;
            reflects = number.lt(chance);
            let share = V::select(reflects, reflectance, transmittance) / V::select(reflects, chance, one - chance);
            weight = tint * V::select(goes_both_ways, reflectance, share);
        }
        let reflects = is_total | reflects | goes_both_ways;
        let weight = Rgb::select(is_total, tint, weight);
        scattered.wi = Vec3::select(lanes, Vec3::select(reflects, reflect(wo), refracted), scattered.wi);
        scattered.weight = Rgb::select(lanes, weight, scattered.weight);
        scattered.is_delta = scattered.is_delta | lanes;
        let lanes = goes_both_ways.bits();
        (lanes != 0).then(|| Split { lanes, wi: refracted, weight: tint * transmittance })
    }
}

/// Starts the next ray segment of each path in its sampled direction.
#[inline(always)]
fn leave<V: Float, X: EffectSet>(
    packet: &mut Packet<'_, V>,
    at: &Arrival<V>,
    vertices: V::Bits,
    scattered: &Scattered<V>,
    split: Option<Split<V>>,
    ended: &mut u32,
) {
    let mut direction = at.frame.to_world(scattered.wi);
    if !Materials::<X>::ARE_DIFFUSE && scattered.is_delta.any() {
        direction = Vec3::select(scattered.is_delta, direction.normalized(), direction);
    }
    let mut splits = 0;
    if let Some(split) = split {
        splits = split.lanes & !*ended;
        V::apart(PutAside { packet, at, vertices, split: &split, lanes: splits });
    }
    packet.rays.own_root = own_root(at, scattered.wi, direction);
    packet.rays.ray = Ray { origin: at.point, direction };
    packet.rays.from = at.primitive;
    packet.throughput = packet.throughput * scattered.weight;
    packet.vertices = vertices;
    packet.density = V::select(scattered.is_delta, V::splat(-1.0), scattered.density);
    // Paths that have just split are checked when their parts have been traced.
    let smallest = V::splat(V::SMALLEST);
    let Rgb { r, g, b } = packet.throughput;
    let spent = r.lt(smallest) & g.lt(smallest) & b.lt(smallest);
    *ended |= (at.lanes & spent).bits() & !splits;
}

/// The refracted parts of paths that split, to be put aside.
struct PutAside<'a, 'w, V: Float> {
    packet: &'a mut Packet<'w, V>,
    at: &'a Arrival<V>,
    vertices: V::Bits,
    split: &'a Split<V>,
    lanes: u32,
}

impl<V: Float> Apart for PutAside<'_, '_, V> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { packet, at, vertices, split, lanes } = self;
        let direction = at.frame.to_world(split.wi).normalized();
        let own_root = own_root(at, split.wi, direction);
        let throughput = packet.throughput * split.weight;
        for lane in LanesOf(lanes) {
            let vertices = vertices.word(lane);
            let part = Part {
                origin: vector(&at.point, lane),
                direction: vector(&direction, lane),
                from: at.primitive.lane(lane),
                own_root: own_root.lane(lane),
                throughput: colour(&throughput, lane),
                vertices,
                branch: packet.branch.word(lane) | 1 << (vertices - 1),
            };
            packet.push(lane, part);
        }
    }
}
