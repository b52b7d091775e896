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
    radiances: [Rgb; SIZE],
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
            radiances: [Rgb::BLACK; SIZE],
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
        self.radiances[slot as usize % SIZE] = radiance;
    }

    /// Gives a sample back; [`Window::settle`] adds it.
    #[inline(always)]
    pub(super) fn give_back(&mut self, slot: u64, radiance: Rgb) {
        let slot = slot as usize % SIZE;
        self.radiances[slot] = if self.has_seen_light { radiance + self.radiances[slot] } else { radiance };
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
            for k in slot..slot + ready as usize {
                self.add(self.radiances[k], counts);
            }
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
        self.first.advance(1, &self.bounds, &self.samples);
    }
}
