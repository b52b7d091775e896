//! Camera rays made in advance, a whole packet at a time, for lanes whose paths end one by one.

use super::bvh::Scratch;
use super::kernel::Lanes;
use super::packet::{Packet, colour};
use super::rays::{LanesOf, Rays};
use super::window::{Handed, Window};
use crate::sampler::PathWords;
use crate::simd::{Apart, Float, MOST_LANES, Mask, Words};
use pathmark_tracer::estimator::camera_share;
use pathmark_tracer::kernel::Counts;
use pathmark_tracer::math::{Bits, Ray, Rgb, Vec3};
use pathmark_tracer::sampling::Purpose;
use pathmark_tracer::scene::SUBPIXELS;

/// Places for waiting rays, twice as many as can wait: a load may start at any ray and always has full length.
const SIZE: usize = 2 * MOST_LANES;

pub(super) struct Supply<V: Float> {
    /// Origins and directions.
    rays: [[V::One; SIZE]; 6],
    /// The words that all random numbers of a sample share.
    words: [[u64; SIZE]; 2],
    /// Window slot of the next ray's sample; the slots of the others follow.
    slot: u64,
    /// For the rays that are being made: columns, rows, pixels and samples.
    keys: [[u64; MOST_LANES]; 4],
    /// Index of the next ray.
    first: usize,
    /// Number of waiting rays.
    count: usize,
}

impl<V: Float> Supply<V> {
    pub(super) fn new() -> Self {
        Self {
            rays: [[V::One::default(); SIZE]; 6],
            words: [[0; SIZE]; 2],
            slot: 0,
            keys: [[0; MOST_LANES]; 4],
            first: 0,
            count: 0,
        }
    }
}

/// Makes rays in advance. A separate function, because one call for a whole packet costs nothing, every kind of kernel
/// shares it, and the time to compile a function grows with the square of its length.
struct Produce<'a, 'w, 's, V: Float> {
    kernel: &'a Lanes,
    supply: &'a mut Supply<V>,
    window: &'a mut Window<'w>,
    scratch: &'a mut Scratch<'s, V>,
    counts: &'a mut Counts,
}

impl<V: Float> Apart for Produce<'_, '_, '_, V> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.kernel.produce::<V>(self.supply, self.window, self.scratch, self.counts);
    }
}

/// The samples whose rays are being made.
struct Batch<V: Float> {
    pixel: [V; 2],
    subpixel: V,
    /// The words of the positions in the pixels.
    film: PathWords<V::Bits>,
    count: usize,
}

/// Fills some places of a row with one word.
#[inline(always)]
fn same(row: &mut [u64; MOST_LANES], first: usize, count: usize, word: u32) {
    for place in &mut row[first..][..count] {
        *place = word.into();
    }
}

impl Lanes {
    /// Gives free lanes their next samples.
    #[inline(always)]
    pub(super) fn refill<V: Float>(
        &self,
        packet: &mut Packet<'_, V>,
        supply: &mut Supply<V>,
        window: &mut Window<'_>,
        counts: &mut Counts,
    ) {
        let mut free = !packet.alive & (u32::MAX >> (MOST_LANES - V::LANES));
        while free != 0 {
            if supply.count == 0 {
                window.settle(counts);
                V::apart(Produce { kernel: self, supply, window, scratch: &mut packet.scratch, counts });
                if supply.count == 0 {
                    return;
                }
            }
            free &= !self.take(packet, supply, free);
        }
    }

    /// Makes a ray for each lane, or as many as samples are left.
    #[inline(always)]
    fn produce<V: Float>(
        &self,
        supply: &mut Supply<V>,
        window: &mut Window<'_>,
        scratch: &mut Scratch<'_, V>,
        counts: &mut Counts,
    ) {
        supply.first = 0;
        while supply.count < V::LANES {
            let Some(Handed { first, count }) = window.hand_out(V::LANES - supply.count) else { break };
            let pixel = first.y * self.width + first.x;
            let [columns, rows, pixels, samples] = &mut supply.keys;
            same(columns, supply.count, count, first.x);
            same(rows, supply.count, count, first.y);
            same(pixels, supply.count, count, pixel);
            for (word, sample) in samples[supply.count..][..count].iter_mut().zip(first.sample..) {
                *word = sample.into();
            }
            supply.count += count;
        }
        let none = V::Bits::splat(0);
        let [columns, rows, pixels, samples] = &supply.keys;
        let samples = V::Bits::load(samples);
        let [film, words] = self.sampler.words(self.seed, V::Bits::load(pixels), samples);
        let subpixel = V::number(samples & V::Bits::splat(u64::from(SUBPIXELS - 1)));
        let pixel = [V::number(V::Bits::load(columns)), V::number(V::Bits::load(rows))];
        let batch = Batch { pixel, subpixel, film, count: supply.count };
        if self.rules.camera_rays > 1 && batch.count > 0 {
            let seen = self.extra_camera_rays(&batch, scratch, counts);
            for lane in 0..batch.count {
                window.add_beforehand(supply.slot + lane as u64, colour(&seen, lane));
            }
        }
        let Ray { origin, direction } = self.camera_rays(&batch, none);
        origin.x.store(&mut supply.rays[0]);
        origin.y.store(&mut supply.rays[1]);
        origin.z.store(&mut supply.rays[2]);
        direction.x.store(&mut supply.rays[3]);
        direction.y.store(&mut supply.rays[4]);
        direction.z.store(&mut supply.rays[5]);
        words.path.store(&mut supply.words[0]);
        words.sample.store(&mut supply.words[1]);
    }

    /// The camera rays with that number, one for each sample of the batch.
    #[inline(always)]
    fn camera_rays<V: Float>(&self, batch: &Batch<V>, number: V::Bits) -> Ray<V> {
        let film = self.sampler.pair::<V>(&batch.film, V::Bits::splat(0), number, Purpose::Film);
        self.view.rays(batch.pixel, batch.subpixel, film)
    }

    /// The radiance that the samples' other camera rays see, as in [`pathmark_tracer::estimator::extra_camera_rays`].
    #[inline(always)]
    fn extra_camera_rays<V: Float>(
        &self,
        batch: &Batch<V>,
        scratch: &mut Scratch<'_, V>,
        counts: &mut Counts,
    ) -> Rgb<V> {
        let wanted = u32::MAX >> (MOST_LANES - batch.count);
        let mut seen = Rgb::splat(Rgb::BLACK);
        for number in 1..self.rules.camera_rays {
            let ray = self.camera_rays(batch, V::Bits::splat(number.into()));
            let rays = Rays { ray, from: V::splat(-1.0), own_root: V::splat(f64::NAN) };
            let (_, primitive) = self.nearest(&rays, wanted, scratch, counts);
            counts.rays += batch.count as u64;
            let met = V::splat(0.0).le(primitive);
            if met.any() {
                let [r, g, b, _] = V::rows(&self.tables.emissions, self.tables.rows(primitive));
                seen = Rgb::select(met, seen + Rgb { r, g, b }, seen);
            }
            if let Some(background) = self.scene.background {
                seen = Rgb::select(met, seen, seen + Rgb::splat(background));
            }
        }
        seen * V::splat(camera_share(self.rules.camera_rays))
    }

    /// Moves waiting rays into free lanes, the first ray into the lowest lane. Returns the filled lanes.
    #[inline(always)]
    fn take<V: Float>(&self, packet: &mut Packet<'_, V>, supply: &mut Supply<V>, free: u32) -> u32 {
        let mut taken = free;
        while taken.count_ones() as usize > supply.count {
            taken &= !(1 << (u32::BITS - 1 - taken.leading_zeros()));
        }
        let mask = V::Mask::from_bits(taken);
        // `first` is never larger; with this explicit bound the loads below need no check.
        let first = supply.first.min(MOST_LANES);
        let Ray { origin, direction } = packet.rays.ray;
        let rays = &supply.rays;
        packet.rays.ray = Ray {
            origin: Vec3::new(
                origin.x.fill(mask, &rays[0][first..]),
                origin.y.fill(mask, &rays[1][first..]),
                origin.z.fill(mask, &rays[2][first..]),
            ),
            direction: Vec3::new(
                direction.x.fill(mask, &rays[3][first..]),
                direction.y.fill(mask, &rays[4][first..]),
                direction.z.fill(mask, &rays[5][first..]),
            ),
        };
        let PathWords { path, sample } = packet.words;
        let words = &supply.words;
        packet.words.path = path.fill(mask, &words[0][first..]);
        if self.sampler.is_spread() {
            packet.words.sample = sample.fill(mask, &words[1][first..]);
        }
        for lane in LanesOf(taken) {
            packet.slots[lane] = supply.slot;
            supply.slot += 1;
        }
        // A camera ray starts on no primitive, so `own_root` is not read.
        packet.rays.from = V::select(mask, V::splat(-1.0), packet.rays.from);
        packet.throughput = Rgb::select(mask, Rgb::splat(Rgb::WHITE), packet.throughput);
        packet.collected = Rgb::select(mask, Rgb::splat(Rgb::BLACK), packet.collected);
        let none = V::Bits::splat(0);
        packet.vertices = V::Bits::choose(mask, none, packet.vertices);
        if self.rules.splits > 0 {
            packet.branch = V::Bits::choose(mask, none, packet.branch);
        }
        if self.rules.nee.is_some() {
            packet.density = V::select(mask, V::splat(-1.0), packet.density);
        }
        packet.alive |= taken;
        let count = taken.count_ones() as usize;
        supply.first += count;
        supply.count -= count;
        taken
    }
}
