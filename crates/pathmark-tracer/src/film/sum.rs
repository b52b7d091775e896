//! The sum of a pixel's samples, in an order of addition that depends only on their number.
//!
//! Samples are added in order inside blocks of [`SAMPLE_BLOCK`]; blocks are combined like the digits of a binary counter. A range of
//! 16 · 2^k samples that starts at a multiple of its length is a subtree, so a pixel's samples can be split among jobs without changing
//! the sum. The error grows with the logarithm of the number of blocks instead of with the number of samples (Higham, "The Accuracy of
//! Floating Point Summation", 1993).

use crate::math::Rgb;

/// Samples that are added one after the other within a block.
pub const SAMPLE_BLOCK: u32 = 16;

/// The sums of a pixel: sum and sum of squares per channel, and the number of samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PixelSum {
    pub sum: [f64; 3],
    /// Sum of squared radiances.
    pub square: [f64; 3],
    pub count: u32,
}

impl PixelSum {
    #[inline(always)]
    fn add(&mut self, radiance: Rgb) {
        for (channel, value) in radiance.channels().into_iter().enumerate() {
            self.sum[channel] += value;
            self.square[channel] += value * value;
        }
        self.count += 1;
    }

    /// The sum of two ranges of samples; `self` is the earlier one.
    #[inline(always)]
    #[must_use]
    pub fn plus(&self, later: &Self) -> Self {
        let mut total = *self;
        for channel in 0..3 {
            total.sum[channel] += later.sum[channel];
            total.square[channel] += later.square[channel];
        }
        total.count += later.count;
        total
    }

    /// The estimate of the pixel's radiance; 0 without samples.
    #[must_use]
    pub fn mean(&self) -> [f64; 3] {
        let n = f64::from(self.count.max(1));
        self.sum.map(|sum| sum / n)
    }
}

/// Accumulates the samples of one pixel.
#[derive(Debug, Clone, Default)]
pub struct SampleSum {
    block: PixelSum,
    blocks: u32,
    /// Entry k is a finished subtree of 2^k blocks if bit k of `blocks` is set.
    subtrees: [PixelSum; 32],
}

impl SampleSum {
    /// Removes all samples. The subtrees may keep their old values, because no bit of `blocks` refers to them.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.block = PixelSum::default();
        self.blocks = 0;
    }

    /// Adds the next sample.
    #[inline(always)]
    pub fn add(&mut self, radiance: Rgb) {
        self.block.add(radiance);
        self.end_block();
    }

    #[inline(always)]
    fn end_block(&mut self) {
        if self.block.count == SAMPLE_BLOCK {
            self.carry();
        }
    }

    /// Adds the next samples.
    #[inline(always)]
    pub fn add_all(&mut self, mut radiances: &[[f64; 3]]) {
        while !radiances.is_empty() {
            let room = (SAMPLE_BLOCK - self.block.count) as usize;
            let (now, later) = radiances.split_at(room.min(radiances.len()));
            // A copy, which stays in registers.
            let mut block = self.block;
            for radiance in now {
                block.add(Rgb::from(*radiance));
            }
            self.block = block;
            self.end_block();
            radiances = later;
        }
    }

    /// Adds the sum of the next blocks, which was computed elsewhere. All parts but the last have the same number of
    /// blocks, a power of two.
    pub fn add_part(&mut self, part: PixelSum, is_last: bool) {
        self.block = part;
        if !is_last {
            self.carry();
        }
    }

    fn carry(&mut self) {
        let mut carried = std::mem::take(&mut self.block);
        let mut level = 0;
        while self.blocks & (1 << level) != 0 {
            carried = self.subtrees[level].plus(&carried);
            level += 1;
        }
        self.subtrees[level] = carried;
        self.blocks += 1;
    }

    /// The sum of all samples: the unfinished block, then the subtrees from the smallest up.
    #[inline]
    pub fn total(&self) -> PixelSum {
        let mut total = self.block;
        for level in 0..32 {
            if self.blocks & (1 << level) != 0 {
                total = self.subtrees[level].plus(&total);
            }
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum_of(values: impl Iterator<Item = f64>) -> PixelSum {
        let mut sum = SampleSum::default();
        values.for_each(|value| sum.add(Rgb { r: value, g: 2.0 * value, b: 0.0 }));
        sum.total()
    }

    /// The same tree written recursively: the counter must equal it bit for bit.
    fn tree(values: &[f64]) -> f64 {
        if values.len() <= SAMPLE_BLOCK as usize {
            return values.iter().fold(0.0, |sum, value| sum + value);
        }
        let blocks = values.len().div_ceil(SAMPLE_BLOCK as usize);
        let left = (blocks.next_power_of_two() / 2) * SAMPLE_BLOCK as usize;
        let (left, right) = values.split_at(left.min(values.len()));
        tree(left) + tree(right)
    }

    #[test]
    fn the_counter_is_the_tree() {
        let value = |k: u32| 1.0 / f64::from(k % 97 + 1);
        for n in [0, 1, 15, 16, 17, 31, 32, 33, 48, 100, 1000, 4096, 5000] {
            let values: Vec<f64> = (0..n).map(value).collect();
            let found = sum_of(values.iter().copied());
            assert_eq!((found.sum[0].to_bits(), found.count), (tree(&values).to_bits(), n), "n = {n}");
        }
    }

    /// Splitting a pixel's samples at an aligned power of two gives the same bits.
    #[test]
    fn an_aligned_part_is_a_subtree() {
        let value = |k: u32| 0.1 + f64::from(k) * 1e-7;
        let whole = sum_of((0..256).map(value));
        let parts = sum_of((0..128).map(value)).plus(&sum_of((128..256).map(value)));
        assert_eq!(whole, parts);
    }

    /// Parts with a power of two of blocks, the last possibly shorter, add up to the same bits.
    #[test]
    fn parts_are_subtrees() {
        let value = |k: u32| 1.0 / f64::from(k % 97 + 1);
        for (part, n) in [(16, 100), (32, 100), (64, 64), (64, 1000), (256, 777), (4096, 10)] {
            let mut sum = SampleSum::default();
            for start in (0..n).step_by(part) {
                let end = n.min(start + part as u32);
                sum.add_part(sum_of((start..end).map(value)), end == n);
            }
            assert_eq!(sum.total(), sum_of((0..n).map(value)), "{n} samples in parts of {part}");
        }
    }

    #[test]
    fn clearing_forgets() {
        let mut sum = SampleSum::default();
        (0..100).for_each(|_| sum.add(Rgb::WHITE));
        sum.clear();
        sum.add(Rgb::WHITE);
        assert_eq!((sum.total().sum[0], sum.total().count), (1.0, 1));
    }
}
