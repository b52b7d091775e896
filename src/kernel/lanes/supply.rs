//! Camera rays made ahead, a whole packet of them at a time, so that lanes which end one by one can be given their next one by one.

use super::Lanes;
use super::packet::{LanesOf, Packet};
use super::window::Window;
use crate::math::{Bits, Ray, Rgb, Vec3};
use crate::sampling::{PathWords, Purpose, SampleKey};
use crate::scene::SUBPIXELS;
use crate::simd::{Float, MOST_LANES, Mask};

/// Rays that can wait, twice: what is read begins at any of them and is as long as all.
const SIZE: usize = 2 * MOST_LANES;

/// The rays that wait.
pub(super) struct Supply {
    /// Origins and directions.
    rays: [[f64; SIZE]; 6],
    /// What the numbers of their samples have in common.
    words: [[u64; SIZE]; 4],
    slots: [u16; SIZE],
    /// Columns and rows, pixels, samples and their places of those that are being made.
    pixels: [[f64; MOST_LANES]; 2],
    keys: [[u64; MOST_LANES]; 4],
    /// The next one.
    first: usize,
    /// How many there are.
    count: usize,
}

impl Supply {
    pub(super) fn new() -> Self {
        Self {
            rays: [[0.0; SIZE]; 6],
            words: [[0; SIZE]; 4],
            slots: [0; SIZE],
            pixels: [[0.0; MOST_LANES]; 2],
            keys: [[0; MOST_LANES]; 4],
            first: 0,
            count: 0,
        }
    }
}

impl Lanes {
    /// Gives free lanes their next samples.
    #[inline(always)]
    pub(super) fn refill<V: Float>(&self, packet: &mut Packet<V>, supply: &mut Supply, window: &mut Window<'_>) {
        let mut free = !packet.alive & (u32::MAX >> (MOST_LANES - V::LANES));
        while free != 0 {
            if supply.count == 0 {
                self.produce::<V>(supply, window);
                if supply.count == 0 {
                    return;
                }
            }
            free &= !self.take(packet, supply, free);
        }
    }

    /// Makes as many rays as there are lanes, or samples left.
    #[inline(always)]
    fn produce<V: Float>(&self, supply: &mut Supply, window: &mut Window<'_>) {
        supply.first = 0;
        while supply.count < V::LANES {
            let Some((place, slot)) = window.hand_out() else { break };
            let k = supply.count;
            let key = SampleKey { seed: self.seed, pixel: place.y * self.width + place.x, sample: place.sample };
            let [first, second] = self.sampler.joined(key);
            for (words, word) in supply.keys.iter_mut().zip([key.pixel.into(), key.sample.into(), first, second]) {
                words[k] = word;
            }
            (supply.pixels[0][k], supply.pixels[1][k]) = (f64::from(place.x), f64::from(place.y));
            supply.slots[k] = slot;
            supply.count += 1;
        }
        let none = V::Bits::splat(0);
        let [pixels, samples, film, first] = &supply.keys;
        let samples = V::load_words(samples);
        let joined = [V::load_words(film), V::load_words(first)];
        let words = self.sampler.words(self.seed, V::load_words(pixels), samples, joined);
        let film = self.sampler.pair::<V>(&words, none, none, Purpose::Film);
        let subpixel = V::number(samples & V::Bits::splat(u64::from(SUBPIXELS - 1)));
        let pixel = [V::load(&supply.pixels[0]), V::load(&supply.pixels[1])];
        let Ray { origin, direction } = self.view.rays(pixel, subpixel, film);
        origin.x.store(&mut supply.rays[0]);
        origin.y.store(&mut supply.rays[1]);
        origin.z.store(&mut supply.rays[2]);
        direction.x.store(&mut supply.rays[3]);
        direction.y.store(&mut supply.rays[4]);
        direction.z.store(&mut supply.rays[5]);
        V::store_words(words.path, &mut supply.words[0]);
        V::store_words(words.sample, &mut supply.words[1]);
        V::store_words(words.joined[0], &mut supply.words[2]);
        V::store_words(words.joined[1], &mut supply.words[3]);
    }

    /// Puts rays that wait into free lanes, the first into the lowest. The lanes that got one.
    #[inline(always)]
    fn take<V: Float>(&self, packet: &mut Packet<V>, supply: &mut Supply, free: u32) -> u32 {
        let mut taken = free;
        while taken.count_ones() as usize > supply.count {
            taken &= !(1 << (u32::BITS - 1 - taken.leading_zeros()));
        }
        let mask = V::Mask::from_bits(taken);
        let first = supply.first;
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
        let PathWords { path, sample, joined } = packet.words;
        let words = &supply.words;
        packet.words.path = V::fill_words(path, mask, &words[0][first..]);
        if self.sampler.is_spread() {
            packet.words.sample = V::fill_words(sample, mask, &words[1][first..]);
            packet.words.joined[0] = V::fill_words(joined[0], mask, &words[2][first..]);
            packet.words.joined[1] = V::fill_words(joined[1], mask, &words[3][first..]);
        }
        for (lane, slot) in LanesOf(taken).zip(&supply.slots[first..]) {
            packet.slots[lane] = *slot;
        }
        // What is on nothing has no use for `own_root`.
        packet.rays.from = V::select(mask, V::splat(-1.0), packet.rays.from);
        packet.throughput = Rgb::select(mask, Rgb::splat(Rgb::WHITE), packet.throughput);
        packet.collected = Rgb::select(mask, Rgb::splat(Rgb::BLACK), packet.collected);
        let none = V::Bits::splat(0);
        packet.vertices = V::choose(mask, none, packet.vertices);
        if self.course.splits > 0 {
            packet.branch = V::choose(mask, none, packet.branch);
        }
        if self.course.aims.is_some() {
            packet.density = V::select(mask, V::splat(-1.0), packet.density);
        }
        packet.alive |= taken;
        let count = taken.count_ones() as usize;
        supply.first += count;
        supply.count -= count;
        taken
    }
}
