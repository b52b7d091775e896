//! Mixed keys: generators seeded with the pixel indices do not fill an image evenly, or fill it too evenly.

use super::{Guard, InRender, Measured, Often, variant};
use crate::random_numbers::unguarded::{draw, sequential_state};
use crate::sampling::{Address, Independent, Purpose, SampleKey, Sampler};

pub(super) const GUARD: Guard = Guard {
    name: "mixed keys",
    error: "chi-square score of a draw over 786 432 pixels in 256 cells, mean size over eight draws (0.8 by chance)",
    operation: "a generator and its first two numbers",
    in_render: InRender { scene: "cornell", often: Often::Ray },
    with: variant!("all of the address mixed", error, work, mixed),
    without: variant!("state = pixel", error, work, sequential),
};

const PIXELS: u32 = 1024 * 768;
const CELLS: usize = 256;

/// The random numbers of a pixel at a bounce.
fn mixed(pixel: u32, bounce: u16) -> [f64; 2] {
    let key = SampleKey { seed: 1, pixel, sample: 0 };
    Independent.pair(Address { key, bounce, branch: 0, purpose: Purpose::Bsdf })
}

fn sequential(pixel: u32, bounce: u16) -> [f64; 2] {
    let mut pcg = sequential_state(pixel);
    for _ in 0..2 * bounce {
        draw(&mut pcg);
    }
    [draw(&mut pcg), draw(&mut pcg)]
}

/// Distance of chi-square from its mean, in standard deviations: too even is as wrong as uneven.
fn error(numbers: fn(u32, u16) -> [f64; 2]) -> Measured {
    let mut scores = Vec::new();
    for bounce in 0..4 {
        let mut cells = [[0_u32; CELLS]; 2];
        for pixel in 0..PIXELS {
            for (cells, number) in cells.iter_mut().zip(numbers(pixel, bounce)) {
                cells[(number * CELLS as f64) as usize] += 1;
            }
        }
        let (expected, freedom) = (f64::from(PIXELS) / CELLS as f64, (CELLS - 1) as f64);
        for cells in cells {
            let off = cells.iter().map(|count| f64::from(*count) - expected);
            let chi_square = off.map(|off| off * off / expected).sum::<f64>();
            scores.push(((chi_square - freedom) / (2.0 * freedom).sqrt()).abs());
        }
    }
    Measured::mean(&scores)
}

fn work(count: u64, numbers: impl Fn(u32, u16) -> [f64; 2]) -> f64 {
    (0..count).map(|k| numbers(k as u32, 0)).map(|[a, b]| a - b).sum()
}
