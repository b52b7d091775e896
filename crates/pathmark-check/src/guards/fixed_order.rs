//! Sums in a fixed order: samples are added along a tree, whichever block is finished first.

use super::{Guard, InRender, Measured, Often, variant};
use crate::film::{Assembly, Bounds, PixelSum, SAMPLE_BLOCK, SampleSum, TileBuffer};
use crate::math::Rgb;
use crate::random::Random;
use std::hint::black_box;

pub(super) const GUARD: Guard = Guard {
    name: "one image from all schedules",
    error: "share of 200 orders of arrival whose sum of 4096 samples differs in a bit from the first's",
    operation: "256 blocks of 16 samples of a pixel put together",
    in_render: InRender { scene: "cornell", often: Often::Sample(1.0 / 4096.0) },
    with: variant!("along a tree, as a film", error, work, as_a_film),
    without: variant!("as they arrive", error, work, as_they_arrive),
};

const BLOCKS: u32 = 256;
const PIXEL: Bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };

/// A part of a pixel's samples.
struct Part {
    first: u32,
    tile: TileBuffer,
    sum: PixelSum,
}

/// Blocks of samples whose magnitudes vary as those of light do.
fn parts(random: &mut Random) -> Vec<Part> {
    let mut part = |block: u32| {
        let mut samples = SampleSum::default();
        for _ in 0..SAMPLE_BLOCK {
            let value = random.scale(-4.0, 4.0);
            samples.add(Rgb { r: value, g: value, b: value });
        }
        let (sum, mut tile) = (samples.total(), TileBuffer::new(PIXEL));
        tile.row_mut(0)[0] = sum;
        Part { first: block * SAMPLE_BLOCK, tile, sum }
    };
    (0..BLOCKS).map(&mut part).collect()
}

fn as_they_arrive(parts: &[Part]) -> f64 {
    parts.iter().fold(PixelSum::default(), |sum, part| sum.plus(&part.sum)).sum[0]
}

fn as_a_film(parts: &[Part]) -> f64 {
    let mut assembly = Assembly::new(1, 1, 0..BLOCKS * SAMPLE_BLOCK).expect("memory for a pixel");
    for part in parts {
        assembly.add(&(part.first..part.first + SAMPLE_BLOCK), part.tile.clone());
    }
    assembly.finish().pixels()[0].sum[0]
}

fn error(sum: fn(&[Part]) -> f64) -> Measured {
    let (mut random, orders) = (Random::new(91), 200);
    let mut parts = parts(&mut random);
    let first = sum(&parts);
    let mut differ = 0;
    for _ in 0..orders {
        random.shuffle(&mut parts);
        differ += u64::from(sum(&parts).to_bits() != first.to_bits());
    }
    Measured::share(differ, orders)
}

fn work(count: u64, sum: fn(&[Part]) -> f64) -> f64 {
    let mut random = Random::new(92);
    let mut parts = parts(&mut random);
    random.shuffle(&mut parts);
    (0..count).map(|_| black_box(sum(black_box(&parts)))).sum()
}
