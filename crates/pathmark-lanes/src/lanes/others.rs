//! Materials that lanes have no code of their own for. The materials' own code shades their vertices in memory, in
//! double precision: several vertices of a rough object side by side, all others one after the other.

use super::rays::LanesOf;
use crate::simd::{Float, Level, MOST_LANES, Number, Precision, Work, on_level};
use pathmark_tracer::material::{Density, Material, RoughSample};
use pathmark_tracer::math::{Rgb, Vec3};
use pathmark_tracer::scene::{AllEffects, Scene};

/// Numbers of a vertex: its primitive, the local direction to the previous vertex, and two random numbers or the local
/// direction to a light.
const ASKED: usize = 7;
/// Numbers of a sample: its direction, its weight and its density. An evaluation has the scattered light and a density.
const FOUND: usize = 7;

/// Fewer vertices of an object are shaded one after the other: one takes as long as a register of them.
const FEWEST: u32 = 2;

/// The vertices of all lanes, in the format of the lanes.
pub(super) struct Others<T> {
    pub(super) asked: [[T; MOST_LANES]; ASKED],
    pub(super) found: [[T; MOST_LANES]; FOUND],
    pub(super) deltas: u32,
    /// The lanes whose surface absorbed the path.
    pub(super) absorbed: u32,
    batch: Batch,
}

/// The place of the vertices: their scene, their lanes, and the lanes that are on the inside.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub(super) scene: &'a Scene,
    pub(super) level: Level,
    pub(super) lanes: u32,
    pub(super) inside: u32,
}

impl<T: Number> Others<T> {
    pub(super) fn new() -> Self {
        let zero = [T::default(); MOST_LANES];
        Self { asked: [zero; ASKED], found: [zero; FOUND], deltas: 0, absorbed: 0, batch: Batch([0.0; Batch::SIZE]) }
    }

    /// Samples the materials of some lanes. It needs no SIMD instructions and is compiled apart from code with them.
    #[inline(never)]
    pub(super) fn sample(&mut self, place: Place<'_>, one: fn(f64) -> T) {
        self.shade::<true>(place, one);
    }

    /// Evaluates the materials of some lanes.
    #[inline(never)]
    pub(super) fn evaluate(&mut self, place: Place<'_>, one: fn(f64) -> T) {
        self.shade::<false>(place, one);
    }

    fn shade<const SAMPLES: bool>(&mut self, Place { scene, level, lanes, inside }: Place<'_>, one: fn(f64) -> T) {
        (self.deltas, self.absorbed) = (0, 0);
        let mut left = lanes;
        while left != 0 {
            let owner = self.owner(scene, left.trailing_zeros() as usize);
            let alike = LanesOf(left).filter(|lane| self.owner(scene, *lane) == owner);
            let alike = alike.fold(0, |lanes, lane| lanes | 1 << lane);
            left &= !alike;
            let material = &scene.objects[owner as usize].material;
            if alike.count_ones() >= FEWEST && material.is_rough() {
                self.side_by_side::<SAMPLES>(material, level, alike, one);
                continue;
            }
            for lane in LanesOf(alike) {
                if SAMPLES {
                    self.sample_one(material, lane, inside >> lane & 1 == 1, one);
                } else {
                    self.evaluate_one(material, lane, one);
                }
            }
        }
    }

    /// The object of the primitive that a lane has met.
    fn owner(&self, scene: &Scene, lane: usize) -> u32 {
        let primitive: f64 = self.asked[0][lane].into();
        scene.owners[primitive as usize]
    }

    fn side_by_side<const SAMPLES: bool>(&mut self, material: &Material, level: Level, lanes: u32, one: fn(f64) -> T) {
        let Self { asked, found, absorbed, batch, .. } = self;
        for (place, lane) in LanesOf(lanes).enumerate() {
            for (row, numbers) in asked[1..].iter().enumerate() {
                batch.0[row * MOST_LANES + place] = numbers[lane].into();
            }
        }
        let count = lanes.count_ones() as usize;
        on_level(level, Precision::F64, SideBySide::<SAMPLES> { material, batch, count });
        for (place, lane) in LanesOf(lanes).enumerate() {
            for (row, numbers) in (Batch::FOUND..).zip(found.iter_mut()) {
                numbers[lane] = one(batch.0[row * MOST_LANES + place]);
            }
            let is_above = batch.0[(Batch::FOUND + 2) * MOST_LANES + place] > 0.0;
            *absorbed |= u32::from(SAMPLES && !is_above) << lane;
        }
    }

    fn numbers(&self, lane: usize) -> [f64; ASKED] {
        self.asked.each_ref().map(|numbers| numbers[lane].into())
    }

    fn sample_one(&mut self, material: &Material, lane: usize, inside: bool, one: fn(f64) -> T) {
        let [_, x, y, z, first, second, _] = self.numbers(lane);
        let Some(sample) = material.sample::<AllEffects>(Vec3::new(x, y, z), inside, [first, second]) else {
            self.absorbed |= 1 << lane;
            return;
        };
        let Vec3 { x, y, z } = sample.wi;
        let Rgb { r, g, b } = sample.weight;
        for (numbers, number) in self.found.iter_mut().zip([x, y, z, r, g, b]) {
            numbers[lane] = one(number);
        }
        match sample.density {
            Density::Delta => self.deltas |= 1 << lane,
            Density::PerSolidAngle(density) => self.found[FOUND - 1][lane] = one(density),
        }
    }

    fn evaluate_one(&mut self, material: &Material, lane: usize, one: fn(f64) -> T) {
        let [_, ox, oy, oz, ix, iy, iz] = self.numbers(lane);
        let (wo, wi) = (Vec3::new(ox, oy, oz), Vec3::new(ix, iy, iz));
        let Rgb { r, g, b } = material.eval::<AllEffects>(wo, wi) * wi.z.abs();
        for (numbers, number) in self.found.iter_mut().zip([r, g, b, material.pdf::<AllEffects>(wo, wi)]) {
            numbers[lane] = one(number);
        }
    }
}

/// Vertices of one object without gaps between them: rows of the numbers asked, without the primitive, and of the
/// numbers found.
struct Batch([f64; Self::SIZE]);

impl Batch {
    /// The first row of the numbers found.
    const FOUND: usize = ASKED - 1;
    const SIZE: usize = (Self::FOUND + FOUND) * MOST_LANES;
}

struct SideBySide<'a, const SAMPLES: bool> {
    material: &'a Material,
    batch: &'a mut Batch,
    count: usize,
}

impl<const SAMPLES: bool> Work for SideBySide<'_, SAMPLES> {
    type Output = ();

    #[inline(always)]
    fn run<V: Float>(self) {
        // Double precision was asked for.
        let Some(numbers) = V::One::of_doubles(&mut self.batch.0) else { return };
        let mut place = 0;
        while place < self.count {
            if SAMPLES {
                sample::<V::Register>(self.material, numbers, place);
            } else {
                evaluate::<V::Register>(self.material, numbers, place);
            }
            place += V::Register::LANES;
        }
    }
}

/// Samples a register of vertices from some place on.
#[inline(always)]
fn sample<V: Float>(material: &Material, numbers: &mut [V::One], place: usize) {
    let wo = direction::<V>(numbers, 0, place);
    let u = [row::<V>(numbers, 3, place), row::<V>(numbers, 4, place)];
    let Some(RoughSample { wi, weight, density }) = material.sample_rough(wo, u) else { return };
    put(numbers, 0, place, wi.x);
    put(numbers, 1, place, wi.y);
    put(numbers, 2, place, wi.z);
    put(numbers, 3, place, weight.r);
    put(numbers, 4, place, weight.g);
    put(numbers, 5, place, weight.b);
    put(numbers, 6, place, density);
}

/// Evaluates a register of vertices from some place on.
#[inline(always)]
fn evaluate<V: Float>(material: &Material, numbers: &mut [V::One], place: usize) {
    let (wo, wi) = (direction::<V>(numbers, 0, place), direction::<V>(numbers, 3, place));
    let Some((value, density)) = material.eval_rough(wo, wi) else { return };
    let Rgb { r, g, b } = value * wi.z.abs();
    put(numbers, 0, place, r);
    put(numbers, 1, place, g);
    put(numbers, 2, place, b);
    put(numbers, 3, place, density);
}

#[inline(always)]
fn direction<V: Float>(numbers: &[V::One], first: usize, place: usize) -> Vec3<V> {
    Vec3::new(row(numbers, first, place), row(numbers, first + 1, place), row(numbers, first + 2, place))
}

#[inline(always)]
fn row<V: Float>(numbers: &[V::One], number: usize, place: usize) -> V {
    V::load(&numbers[number * MOST_LANES + place..])
}

#[inline(always)]
fn put<V: Float>(numbers: &mut [V::One], found: usize, place: usize, value: V) {
    value.store(&mut numbers[(Batch::FOUND + found) * MOST_LANES + place..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::levels;
    use pathmark_tracer::math::unit;
    use pathmark_tracer::sampling::{mix, uniform_sphere};
    use pathmark_tracer::scene::load;

    /// A scene whose objects have these materials in turn: rough ones, one with a delta lobe, and one without code for
    /// several vertices.
    fn scene() -> Scene {
        let ball = |name: &&str| {
            let objects = load(name).unwrap().objects;
            objects.iter().find(|object| object.name == "ball").unwrap().material.clone()
        };
        let names = ["conductor-25", "kd-ks-25", "kd-ks-25-vndf", "kd-ks-0", "report-b-25"];
        let materials: Vec<Material> = names.iter().map(ball).collect();
        let mut scene = load("conductor-25").unwrap();
        for (object, material) in scene.objects.iter_mut().zip(materials.iter().cycle()) {
            object.material = material.clone();
        }
        scene
    }

    /// Asserts that the first numbers found for a lane have the same bits.
    fn same<T: Number>(one: &Others<T>, other: &Others<T>, lane: usize, count: usize) -> usize {
        for row in 0..count {
            let [one, other]: [f64; 2] = [one.found[row][lane].into(), other.found[row][lane].into()];
            assert_eq!(one.to_bits(), other.to_bits(), "number {row}: {one} and {other}");
        }
        count
    }

    /// Lanes together have the bits of each lane alone, which the materials' code for one vertex shades.
    fn compare<T: Number>(level: Level, one: fn(f64) -> T) {
        let scene = scene();
        let (mut deltas, mut absorbed, mut compared) = (0, 0, 0);
        for round in 0..200 {
            let random = |k: u64| mix(round << 32 | k);
            let (lanes, inside) = (random(0) as u32, random(1) as u32);
            let (mut together, mut alone) = (Others::<T>::new(), Others::<T>::new());
            for lane in 0..MOST_LANES {
                let numbers = [2, 3, 4, 5].map(|k| unit(random(k + 8 * lane as u64)));
                let primitive = random(6 + 8 * lane as u64) % scene.owners.len() as u64;
                let [wo, wi] = [uniform_sphere([numbers[0], numbers[1]]), uniform_sphere([numbers[2], numbers[3]])];
                // As random numbers, coordinates of `wi` are in their range.
                let asked = [primitive as f64, wo.x, wo.y, wo.z.abs(), wi.x.abs(), wi.y.abs(), wi.z].map(one);
                for (row, number) in asked.into_iter().enumerate() {
                    together.asked[row][lane] = number;
                    alone.asked[row][lane] = number;
                }
            }
            let place = Place { scene: &scene, level, lanes, inside };
            together.sample(place, one);
            for lane in LanesOf(lanes) {
                alone.sample(Place { lanes: 1 << lane, ..place }, one);
                let of_lane = |others: &Others<T>| (others.deltas >> lane & 1, others.absorbed >> lane & 1);
                let (is_delta, is_absorbed) = of_lane(&alone);
                assert_eq!(of_lane(&together), (is_delta, is_absorbed));
                // The density of a delta lobe is not set, and nothing is set for a path that ended.
                let known = if is_absorbed == 1 { 0 } else { FOUND - is_delta as usize };
                compared += same(&together, &alone, lane, known);
                deltas += is_delta;
                absorbed += is_absorbed;
            }
            together.evaluate(place, one);
            for lane in LanesOf(lanes) {
                alone.evaluate(Place { lanes: 1 << lane, ..place }, one);
                compared += same(&together, &alone, lane, 4);
            }
        }
        assert!(deltas > 0 && absorbed > 0 && compared > 10_000, "{deltas} {absorbed} {compared}");
    }

    #[test]
    fn lanes_together_are_each_lane_alone() {
        for level in levels() {
            compare(level, |number| number);
            compare(level, |number| number as f32);
        }
    }
}
