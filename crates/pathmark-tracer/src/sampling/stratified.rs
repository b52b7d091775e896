//! Jittered strata: `--sampler stratified`.
//!
//! Of every 16 samples of a pixel, each of the 4x4 cells of the unit square gets one, at a random position inside it:
//! jittered sampling (R. L. Cook, T. Porter and L. Carpenter, "Distributed Ray Tracing", 1984). The assignment of cells
//! to samples is shuffled for each use of random numbers and each 16 samples. So uses are independent of each other and
//! of the sample's index, and fewer than 16 samples are unbiased, too.
//!
//! The error falls at the rate of independent samples, but is smaller by a factor: the variation within a cell remains.

use super::independent::mix;
use super::{Address, Sampler};
use crate::math::unit;

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stratified;

/// Number of samples that are distributed over the cells.
const BLOCK: u32 = 16;

/// The cell of each sample: a permutation of 0..16 made from the key by eight rounds of a Feistel network, whose halves
/// are column and row. All cells are equally likely; so are all pairs of cells for two samples, to less than 1e-4.
#[inline(always)]
fn cell(sample: u32, key: u64) -> [u32; 2] {
    let (mut column, mut row) = (sample % 4, sample / 4 % 4);
    for round in 0..4 {
        let table = (key >> (16 * round)) as u32;
        column ^= table >> (2 * row) & 3;
        row ^= table >> (8 + 2 * column) & 3;
    }
    [column, row]
}

impl Sampler for Stratified {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        let sample = at.key.sample;
        // Constant along a path, so the compiler moves it out of the loop over bounces.
        let block = mix(mix(u64::from(at.key.pixel) << 32 | u64::from(sample / BLOCK)) ^ mix(at.key.seed));
        let key = mix(block ^ dimension);
        let cell = cell(sample, mix(key));
        let place = u64::from(sample % BLOCK) << 1 | 1;
        [0, 1].map(|axis| inside(cell[axis], mix(key ^ (place + axis as u64))))
    }
}

/// A number in the quarter `cell` of [0, 1). The cell is the leading two bits; adding a cell and an offset could round
/// up to 1.
#[inline(always)]
fn inside(cell: u32, bits: u64) -> f64 {
    unit(u64::from(cell) << 62 | bits >> 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sixteen samples get sixteen different cells. All cells are equally likely for a sample, and all pairs for two
    /// samples.
    #[test]
    fn cells_are_a_fair_permutation() {
        const KEYS: u64 = 1 << 18;
        let mut counts = [[0_u32; 16]; 16];
        let mut two = [[0_u32; 16]; 16];
        for key in 0..KEYS {
            let order: Vec<usize> = (0..16)
                .map(|sample| {
                    let [column, row] = cell(sample, mix(key));
                    (4 * row + column) as usize
                })
                .collect();
            assert_eq!(order.iter().fold(0_u32, |seen, cell| seen | 1 << cell), 0xFFFF, "key {key}");
            for (sample, cell) in order.iter().enumerate() {
                counts[sample][*cell] += 1;
            }
            two[order[1]][order[6]] += 1;
        }
        let chi_square = |counts: &mut dyn Iterator<Item = u32>, mean: f64| -> f64 {
            counts.map(|count| (f64::from(count) - mean) * (f64::from(count) - mean) / mean).sum()
        };
        // Both tails of chi-square at 1e-4, with 15 degrees of freedom for each of 16 samples and 239 for a pair of
        // samples.
        for counts in counts {
            let value = chi_square(&mut counts.into_iter(), KEYS as f64 / 16.0);
            assert!((1.2..54.0).contains(&value), "{value}");
        }
        let different = (0..256).filter(|index| index / 16 != index % 16).map(|index| two[index / 16][index % 16]);
        let value = chi_square(&mut { different }, KEYS as f64 / 240.0);
        assert!((163.0..334.0).contains(&value), "{value}");
    }

    /// R10: the last cell ends below 1.
    #[test]
    fn numbers_stay_in_their_cell() {
        assert_eq!(inside(3, u64::MAX), 1.0 - f64::EPSILON / 2.0);
        for cell in 0..4 {
            let [low, high] = [0, u64::MAX].map(|bits| inside(cell, bits) * 4.0);
            assert!(low == f64::from(cell) && high < f64::from(cell + 1), "{low} {high}");
        }
    }
}
