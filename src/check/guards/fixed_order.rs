//! Sums of one shape: whoever is done first may not be added first.

use super::{Guard, Measured, Variant};
use crate::check::random::Random;
use crate::film::{PixelSum, SampleSum};
use crate::math::Rgb;

pub(super) const GUARD: Guard = Guard {
    name: "one image from all schedules",
    error: "share of 200 orders of arrival whose sum of 4096 samples differs in a bit from the first's",
    operation: "256 blocks of 16 samples added",
    with: Variant { name: "by place, in a tree", error: || error(by_place), work: |count| work(count, by_place) },
    without: Variant {
        name: "as they arrive",
        error: || error(as_they_arrive),
        work: |count| work(count, as_they_arrive),
    },
};

const BLOCKS: usize = 256;

/// Sums of blocks of samples whose sizes differ as light does, and their places.
fn blocks(random: &mut Random) -> Vec<(usize, PixelSum)> {
    let mut block = || {
        let mut sum = SampleSum::default();
        for _ in 0..16 {
            let value = random.scale(-4.0, 4.0);
            sum.add(Rgb { r: value, g: value, b: value });
        }
        sum.total()
    };
    (0..BLOCKS).map(|place| (place, block())).collect()
}

fn shuffle(blocks: &mut [(usize, PixelSum)], random: &mut Random) {
    for end in (1..blocks.len()).rev() {
        blocks.swap(end, random.below(end + 1));
    }
}

fn as_they_arrive(blocks: &[(usize, PixelSum)]) -> f64 {
    blocks.iter().fold(PixelSum::default(), |sum, (_, block)| sum.plus(block)).sum[0]
}

/// Each block is put where it belongs; neighbours are added, then pairs of neighbours.
fn by_place(blocks: &[(usize, PixelSum)]) -> f64 {
    let mut row = [PixelSum::default(); BLOCKS];
    for (place, block) in blocks {
        row[*place] = *block;
    }
    let mut length = BLOCKS;
    while length > 1 {
        length /= 2;
        for k in 0..length {
            row[k] = row[2 * k].plus(&row[2 * k + 1]);
        }
    }
    row[0].sum[0]
}

fn error(sum: fn(&[(usize, PixelSum)]) -> f64) -> Measured {
    let (mut random, orders) = (Random::new(91), 200);
    let mut blocks = blocks(&mut random);
    let first = sum(&blocks);
    let mut differ = 0;
    for _ in 0..orders {
        shuffle(&mut blocks, &mut random);
        differ += u64::from(sum(&blocks).to_bits() != first.to_bits());
    }
    Measured::share(differ, orders)
}

fn work(count: u64, sum: fn(&[(usize, PixelSum)]) -> f64) -> f64 {
    let mut random = Random::new(92);
    let mut blocks = blocks(&mut random);
    shuffle(&mut blocks, &mut random);
    (0..count).map(|_| std::hint::black_box(sum(std::hint::black_box(&blocks)))).sum()
}
