//! The samples of a piece. They are handed out to lanes in order and taken back in order, however late a lane ends its
//! path. So a pixel's samples are added in the same order as with one path at a time.

use pathmark_tracer::film::{Bounds, Piece, PixelSum, SampleSum, TileBuffer};
use pathmark_tracer::kernel::Counts;
use pathmark_tracer::math::Rgb;

/// Most samples that are handed out and not yet taken back. While one path is long, other lanes can get this far ahead.
const SIZE: usize = 512;

/// A sample of the piece: its pixel and its number.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) sample: u32,
}

/// Replaces invalid radiances by black ones. Returns their number. No part of the kernel, because it is hardly ever
/// called.
#[inline(never)]
fn blacken(radiances: &mut [[f64; 3]]) -> u64 {
    let mut invalid = 0;
    for radiance in radiances {
        if !Rgb::from(*radiance).is_valid_radiance() {
            invalid += 1;
            *radiance = [0.0; 3];
        }
    }
    invalid
}

/// Consecutive samples of a pixel that were handed out.
pub(super) struct Handed {
    pub(super) first: Place,
    pub(super) count: usize,
}

/// The window over a piece.
pub(super) struct Window<'a> {
    bounds: Bounds,
    samples: std::ops::Range<u32>,
    out: &'a mut TileBuffer,
    /// The next sample to be handed out; its row is below the last row if there are none.
    next: Place,
    handed: u64,
    /// The next sample to be taken back.
    first: Place,
    taken: u64,
    /// A bit for each slot that was given back.
    done: [u64; SIZE / 64],
    radiances: [[f64; 3]; SIZE],
    /// Whether the radiance of other camera rays is added to each sample.
    has_seen_light: bool,
    sum: SampleSum,
}

impl Place {
    /// Advances by `count` samples, at most as many as the pixel has left.
    #[inline(always)]
    fn advance(&mut self, count: u32, bounds: &Bounds, samples: &std::ops::Range<u32>) {
        self.sample += count;
        if self.sample == samples.end {
            self.sample = samples.start;
            self.x += 1;
            if self.x == bounds.x1 {
                self.x = bounds.x0;
                self.y += 1;
            }
        }
    }
}

impl<'a> Window<'a> {
    pub(super) fn over(piece: &Piece, out: &'a mut TileBuffer, has_seen_light: bool) -> Self {
        let Piece { bounds, samples } = piece.clone();
        // A piece without samples has nothing to hand out.
        let first =
            Place { x: bounds.x0, y: if samples.is_empty() { bounds.y1 } else { bounds.y0 }, sample: samples.start };
        if samples.is_empty() {
            for y in bounds.y0..bounds.y1 {
                out.row_mut(y)[..bounds.width() as usize].fill(PixelSum::default());
            }
        }
        Self {
            bounds,
            samples,
            out,
            next: first,
            handed: 0,
            first,
            taken: 0,
            done: [0; SIZE / 64],
            radiances: [[0.0; 3]; SIZE],
            has_seen_light,
            sum: SampleSum::default(),
        }
    }

    /// Hands out the next samples, at most `most`, all of one pixel. `None` if there are none, or none before others
    /// have been given back.
    #[inline(always)]
    pub(super) fn hand_out(&mut self, most: usize) -> Option<Handed> {
        let room = SIZE as u64 - (self.handed - self.taken);
        if self.next.y >= self.bounds.y1 || room == 0 {
            return None;
        }
        let first = self.next;
        let left = self.samples.end - first.sample;
        let count = (most as u64).min(room).min(left.into());
        self.next.advance(count as u32, &self.bounds, &self.samples);
        self.handed += count;
        Some(Handed { first, count: count as usize })
    }

    /// Stores radiance that is added to a sample when it is given back.
    #[inline(always)]
    pub(super) fn add_beforehand(&mut self, slot: u64, radiance: Rgb) {
        self.radiances[slot as usize % SIZE] = radiance.into();
    }

    /// Gives a sample back; [`Window::settle`] adds it.
    #[inline(always)]
    pub(super) fn give_back(&mut self, slot: u64, radiance: Rgb) {
        let slot = slot as usize % SIZE;
        let radiance = if self.has_seen_light { radiance + self.radiances[slot].into() } else { radiance };
        self.radiances[slot] = radiance.into();
        self.done[slot / 64] |= 1 << (slot % 64);
    }

    /// Adds the samples that were given back, up to the first one that is still missing.
    #[inline(always)]
    pub(super) fn settle(&mut self, counts: &mut Counts) {
        loop {
            let slot = (self.taken % SIZE as u64) as usize;
            let word = &mut self.done[slot / 64];
            let ready = (!(*word >> (slot % 64))).trailing_zeros().min(64 - (slot % 64) as u32);
            if ready == 0 {
                return;
            }
            // A mask of `ready` ones, from the slot on.
            *word &= !((u64::MAX >> (64 - ready)) << (slot % 64));
            self.taken += u64::from(ready);
            counts.paths += u64::from(ready);
            let end = slot + ready as usize;
            let mut start = slot;
            while start < end {
                start += self.add(start..end, counts);
            }
        }
    }

    /// Adds the first samples that have not been added yet, as many as are of one pixel. Returns their number.
    #[inline(always)]
    fn add(&mut self, slots: std::ops::Range<usize>, counts: &mut Counts) -> usize {
        let left = (self.samples.end - self.first.sample) as usize;
        let count = left.min(slots.len());
        let radiances = &mut self.radiances[slots][..count];
        // First all together, which takes a few instructions.
        let mut are_valid = true;
        for channel in radiances.as_flattened() {
            are_valid &= *channel >= 0.0 && *channel < f64::INFINITY;
        }
        if !are_valid {
            counts.invalid += blacken(radiances);
        }
        self.sum.add_all(radiances);
        if count == left {
            let column = (self.first.x - self.bounds.x0) as usize;
            self.out.row_mut(self.first.y)[column] = self.sum.total();
            self.sum.clear();
        }
        self.first.advance(count as u32, &self.bounds, &self.samples);
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radiance(slot: u64) -> Rgb {
        let value = 1.0 / (slot + 1) as f64;
        let r = match slot {
            4 => f64::NAN,
            17 => f64::INFINITY,
            30 => -1.0,
            _ => value,
        };
        Rgb { r, g: value, b: -0.0 }
    }

    /// Samples of two pixels that come back in another order are added in their own order, and invalid ones are black.
    #[test]
    fn samples_are_added_in_order() {
        let piece = Piece { bounds: Bounds { x0: 3, y0: 5, x1: 5, y1: 6 }, samples: 7..28 };
        let (mut out, mut counts) = (TileBuffer::new(piece.bounds), Counts::default());
        let mut window = Window::over(&piece, &mut out, false);
        let mut handed = 0;
        while let Some(Handed { count, .. }) = window.hand_out(8) {
            handed += count;
        }
        assert_eq!(handed, 42);
        for k in 0..42 {
            let slot = k * 25 % 42;
            window.give_back(slot, radiance(slot));
            window.settle(&mut counts);
        }
        assert_eq!((counts.paths, counts.invalid), (42, 3));
        let expected = [0..21, 21..42].map(|slots| {
            let mut sum = SampleSum::default();
            for radiance in slots.map(radiance) {
                sum.add(if radiance.is_valid_radiance() { radiance } else { Rgb::BLACK });
            }
            sum.total()
        });
        let found: Vec<PixelSum> = out.rows().flatten().copied().collect();
        assert_eq!(found, expected);
    }
}
