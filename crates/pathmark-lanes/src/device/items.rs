//! Input and output of a launch. An *item* is a pixel and a part of its samples, which is a subtree of the film's sum.
//! The items of a piece are ordered by pixel.

use pathmark_tracer::film::{Piece, PixelSum, SampleSum, TileBuffer};
use pathmark_tracer::kernel::Counts;

/// The input of a launch: its fields in order, with the number of words of each. A row for each piece follows.
pub(super) const TASK: &[(&str, usize)] =
    &[("TASK_PIECES", 1), ("TASK_PART_SAMPLES", 1), ("TASK_FIRST_ITEM", 2), ("TASK_TABLE", 0)];

/// The fields of a piece's row, with the number of words of each.
pub(super) const PIECE: &[(&str, usize)] = &[
    ("PIECE_FIRST_ITEM", 2),
    ("PIECE_X", 1),
    ("PIECE_Y", 1),
    ("PIECE_COLUMNS", 1),
    ("PIECE_PARTS", 1),
    ("PIECE_FIRST_SAMPLE", 1),
    ("PIECE_END_SAMPLE", 1),
];

/// The lower and the upper half of a number.
fn halves(number: u64) -> [u32; 2] {
    [number as u32, (number >> 32) as u32]
}

/// The pieces in items: each item is a pixel of a piece and a part of its samples.
pub(super) struct Items<'a> {
    pieces: &'a [&'a Piece],
    /// Samples of a part.
    pub(super) part: u32,
    /// Number of the first item of each piece.
    first: Vec<u64>,
    pub(super) count: u64,
}

impl<'a> Items<'a> {
    pub(super) fn new(pieces: &'a [&'a Piece], part: u32) -> Self {
        let mut count = 0;
        let first = pieces.iter().map(|piece| {
            let first = count;
            count += piece.bounds.area() as u64 * Self::parts(piece, part);
            first
        });
        let first = first.collect();
        Self { pieces, part, first, count }
    }

    fn parts(piece: &Piece, part: u32) -> u64 {
        u64::from((piece.samples.end - piece.samples.start).div_ceil(part))
    }

    /// The input words of a launch whose first item is this one.
    pub(super) fn task(&self, first_item: u64) -> Vec<u32> {
        let mut task = vec![self.pieces.len() as u32, self.part];
        task.extend(halves(first_item));
        for (piece, first) in self.pieces.iter().zip(&self.first) {
            let Piece { bounds, samples } = piece;
            task.extend(halves(*first));
            task.extend([bounds.x0, bounds.y0, bounds.width(), Self::parts(piece, self.part) as u32]);
            task.extend([samples.start, samples.end]);
        }
        task
    }
}

/// Most blocks of samples in an item, as an exponent of two.
pub(super) const MOST_BLOCKS: u32 = 8;

/// Words that an item writes: three sums, three sums of squares, and six counts.
pub(super) const OUT_WORDS: usize = 12;

/// Writes the results of items, in their order, to the pixels.
pub(super) struct Placing<'a> {
    items: &'a Items<'a>,
    out: &'a mut [TileBuffer],
    pub(super) counts: Vec<Counts>,
    sum: SampleSum,
    /// The piece, the pixel and the part of the next item.
    piece: usize,
    pixel: u64,
    number: u64,
}

impl<'a> Placing<'a> {
    pub(super) fn new(items: &'a Items<'a>, out: &'a mut [TileBuffer]) -> Self {
        let counts = vec![Counts::default(); items.pieces.len()];
        Self { items, out, counts, sum: SampleSum::default(), piece: 0, pixel: 0, number: 0 }
    }

    /// Adds the output words of the next item.
    pub(super) fn put(&mut self, words: &[u64]) {
        let piece = self.items.pieces[self.piece];
        let parts = Items::parts(piece, self.items.part);
        let is_last = self.number + 1 == parts;
        let samples = piece.samples.end - piece.samples.start;
        let count = if is_last { samples - self.number as u32 * self.items.part } else { self.items.part };
        self.sum.add_part(pixel_sum(words, count), is_last);
        self.counts[self.piece].add(&item_counts(words, count));
        self.number += 1;
        if is_last {
            let columns = u64::from(piece.bounds.width());
            let (column, row) = (self.pixel % columns, self.pixel / columns);
            self.out[self.piece].row_mut(piece.bounds.y0 + row as u32)[column as usize] = self.sum.total();
            self.sum.clear();
            (self.number, self.pixel) = (0, self.pixel + 1);
        }
        if self.pixel == piece.bounds.area() as u64 {
            (self.pixel, self.piece) = (0, self.piece + 1);
        }
    }
}

fn pixel_sum(words: &[u64], count: u32) -> PixelSum {
    let channels = |first: usize| [0, 1, 2].map(|channel| f64::from_bits(words[first + channel]));
    PixelSum { sum: channels(0), square: channels(3), count }
}

fn item_counts(words: &[u64], paths: u32) -> Counts {
    Counts {
        paths: u64::from(paths),
        rays: words[6],
        invalid: words[7],
        escaped: words[8],
        truncated: words[9],
        box_tests: words[10],
        primitive_tests: words[11],
    }
}
