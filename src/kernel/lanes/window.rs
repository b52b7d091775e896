//! The samples of a piece, handed out to lanes in order and taken back in order, however late a lane is done with its own. So a pixel's
//! samples are added as one path at a time would add them.

use crate::film::{Bounds, Piece, PixelSum, SampleSum, TileBuffer};
use crate::kernel::Counts;
use crate::math::Rgb;

/// Samples that may be handed out and not yet taken back. A path that goes on and on lets the others run this far ahead.
const SIZE: usize = 512;

/// A place in the piece: a pixel, and one of its samples.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) sample: u32,
}

/// The window over a piece.
pub(super) struct Window<'a> {
    bounds: Bounds,
    samples: std::ops::Range<u32>,
    out: &'a mut TileBuffer,
    /// Where the next sample to be handed out is; its row is below the last one when there are none.
    next: Place,
    handed: u64,
    /// Where the next sample to be taken back is.
    first: Place,
    taken: u64,
    is_done: [bool; SIZE],
    radiances: [Rgb; SIZE],
    sum: SampleSum,
}

impl Place {
    #[inline(always)]
    fn advance(&mut self, bounds: &Bounds, samples: &std::ops::Range<u32>) {
        self.sample += 1;
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
    pub(super) fn over(piece: &Piece, out: &'a mut TileBuffer) -> Self {
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
            is_done: [false; SIZE],
            radiances: [Rgb::BLACK; SIZE],
            sum: SampleSum::default(),
        }
    }

    /// The next sample, and the slot to give it back by; `None` if there is none, or none until others have been given back.
    #[inline(always)]
    pub(super) fn hand_out(&mut self) -> Option<(Place, u16)> {
        if self.next.y >= self.bounds.y1 || self.handed - self.taken == SIZE as u64 {
            return None;
        }
        let (place, slot) = (self.next, (self.handed % SIZE as u64) as u16);
        self.next.advance(&self.bounds, &self.samples);
        self.handed += 1;
        Some((place, slot))
    }

    /// Gives a sample back.
    #[inline(always)]
    pub(super) fn give_back(&mut self, slot: u16, radiance: Rgb, counts: &mut Counts) {
        self.radiances[usize::from(slot)] = radiance;
        self.is_done[usize::from(slot)] = true;
        loop {
            let slot = (self.taken % SIZE as u64) as usize;
            if !self.is_done[slot] {
                return;
            }
            self.is_done[slot] = false;
            self.taken += 1;
            self.add(self.radiances[slot], counts);
        }
    }

    /// Adds the first sample that has not been added yet.
    #[inline(always)]
    fn add(&mut self, radiance: Rgb, counts: &mut Counts) {
        counts.paths += 1;
        let is_valid = radiance.is_valid_radiance();
        counts.invalid += u64::from(!is_valid);
        self.sum.add(if is_valid { radiance } else { Rgb::BLACK });
        if self.first.sample + 1 == self.samples.end {
            let column = (self.first.x - self.bounds.x0) as usize;
            self.out.row_mut(self.first.y)[column] = self.sum.total();
            self.sum.clear();
        }
        self.first.advance(&self.bounds, &self.samples);
    }
}
