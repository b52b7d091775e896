//! Plans: a film cut into pieces, so that every sample of every pixel belongs to exactly one.

use std::ops::Range;

/// A rectangle of pixels; the upper ends are excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Bounds {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Bounds {
    #[inline]
    pub const fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    #[inline]
    pub const fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    #[inline]
    pub const fn area(&self) -> usize {
        self.width() as usize * self.height() as usize
    }
}

/// One job: a rectangle of pixels and a range of their samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Piece {
    pub bounds: Bounds,
    /// The samples of each pixel.
    pub samples: Range<u32>,
}

/// The size of a plan, which is known before the plan is made: it may be too large for any memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlanSize {
    pub pieces: u64,
    /// Pixels of all pieces together. A pixel counts once for each piece that has samples of it.
    pub pixels: u64,
}

impl PlanSize {
    /// The size of two plans together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self { pieces: self.pieces + other.pieces, pixels: self.pixels + other.pixels }
    }
}

/// All pieces of a film, in the order in which they are handed out.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Plan {
    pieces: Vec<Piece>,
}

impl Plan {
    /// The rectangles between successive column and row boundaries. They are disjoint and complete because boundaries
    /// are shared.
    pub(super) fn from_boundaries(columns: &[u32], rows: &[u32], samples: &Range<u32>) -> Self {
        let mut pieces = Vec::with_capacity((columns.len() - 1) * (rows.len() - 1));
        for row in rows.windows(2) {
            for column in columns.windows(2) {
                let bounds = Bounds { x0: column[0], y0: row[0], x1: column[1], y1: row[1] };
                pieces.push(Piece { bounds, samples: samples.clone() });
            }
        }
        Self { pieces }
    }

    /// A plan of pieces that are known to be disjoint and complete.
    pub(super) fn from_pieces(pieces: Vec<Piece>) -> Self {
        Self { pieces }
    }

    /// The same pieces in another order; `order` must be a permutation.
    pub(super) fn reordered(self, order: &[usize]) -> Self {
        debug_assert_eq!(order.len(), self.pieces.len());
        Self { pieces: order.iter().map(|&index| self.pieces[index].clone()).collect() }
    }

    /// The same pieces, the most expensive first; of equal ones the earlier. `costs` has one entry per piece.
    #[must_use]
    pub fn longest_first(self, costs: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..self.pieces.len()).collect();
        order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
        self.reordered(&order)
    }

    /// The same pieces, each cut into parts of `block` samples; the last part takes the rest.
    pub(super) fn split_samples(self, block: u32) -> Self {
        let parts = |piece: Piece| {
            let Piece { bounds, samples } = piece;
            let starts = samples.clone().step_by(block as usize);
            starts.map(move |start| Piece { bounds, samples: start..samples.end.min(start.saturating_add(block)) })
        };
        Self { pieces: self.pieces.into_iter().flat_map(parts).collect() }
    }

    /// Appends another plan's pieces; the two plans must be disjoint.
    pub fn append(&mut self, later: &Self) {
        self.pieces.extend_from_slice(&later.pieces);
    }

    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    pub fn len(&self) -> usize {
        self.pieces.len()
    }

    /// Whether there are no pieces.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }
}
