//! Tile orders: the order in which tiles are handed out. It changes idle time at the end and cache contents, but never
//! the image.

use std::cmp::Reverse;

/// An order of the cells of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TileOrder {
    /// Row by row from the top left.
    #[default]
    Scanline,
    /// Along Hilbert's curve (1891): successive tiles are neighbours.
    Hilbert,
    /// From the middle outwards, ring by ring.
    Spiral,
    /// The most expensive first (Graham 1969: at most 4/3 - 1/(3p) times the best makespan, where any order can take
    /// twice as long). A caller with a kernel must measure the costs; until then this is scanline order.
    Cost,
}

pub(super) const ORDERS: [(&str, TileOrder); 4] = [
    ("scanline", TileOrder::Scanline),
    ("hilbert", TileOrder::Hilbert),
    ("spiral", TileOrder::Spiral),
    ("cost", TileOrder::Cost),
];

impl TileOrder {
    /// The cells of a grid, as scanline indices, in this order.
    pub(super) fn permutation(self, columns: usize, rows: usize) -> Vec<usize> {
        let mut cells: Vec<usize> = (0..columns * rows).collect();
        match self {
            Self::Scanline | Self::Cost => {}
            Self::Hilbert => {
                let side = columns.max(rows).next_power_of_two() as u64;
                cells.sort_by_key(|cell| hilbert_index((cell % columns) as u64, (cell / columns) as u64, side));
            }
            Self::Spiral => cells.sort_by_key(|cell| spiral_key(cell % columns, cell / columns, columns, rows)),
        }
        cells
    }
}

/// The position of a cell along Hilbert's curve over a square whose side is a power of two.
fn hilbert_index(mut x: u64, mut y: u64, side: u64) -> u64 {
    let mut index = 0;
    let mut half = side / 2;
    while half > 0 {
        let (right, lower) = (u64::from(x & half > 0), u64::from(y & half > 0));
        index += half * half * ((3 * right) ^ lower);
        if lower == 0 {
            if right == 1 {
                x = side - 1 - x;
                y = side - 1 - y;
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    index
}

/// Sort key: the ring around the middle, then the position in it: right side downwards, bottom leftwards, left upwards,
/// top rightwards.
fn spiral_key(x: usize, y: usize, columns: usize, rows: usize) -> (usize, usize, Reverse<i64>) {
    // Doubled coordinates keep the middle of an even grid exact.
    let dx = 2 * x as i64 + 1 - columns as i64;
    let dy = 2 * y as i64 + 1 - rows as i64;
    let ring = dx.abs().max(dy.abs());
    let (side, along) = if dx == ring && dy > -ring {
        (0, -dy)
    } else if dy == ring {
        (1, dx)
    } else if dx == -ring {
        (2, dy)
    } else {
        (3, -dx)
    };
    (ring as usize, side, Reverse(along))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_is_a_permutation() {
        for (_, order) in ORDERS {
            for (columns, rows) in [(1, 1), (1, 7), (5, 3), (8, 8), (16, 9)] {
                let mut cells = order.permutation(columns, rows);
                cells.sort_unstable();
                assert_eq!(cells, (0..columns * rows).collect::<Vec<_>>(), "{order:?} {columns}x{rows}");
            }
        }
    }

    #[test]
    fn hilbert_steps_to_a_neighbour() {
        let cells = TileOrder::Hilbert.permutation(8, 8);
        for pair in cells.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            assert_eq!((a % 8).abs_diff(b % 8) + (a / 8).abs_diff(b / 8), 1, "{a} to {b}");
        }
    }

    #[test]
    fn spiral_starts_in_the_middle_and_ends_in_a_corner_ring() {
        let cells = TileOrder::Spiral.permutation(5, 5);
        assert_eq!(cells[0], 12);
        for pair in cells[..25].windows(2) {
            let ring = |cell: usize| (cell % 5).abs_diff(2).max((cell / 5).abs_diff(2));
            assert!(ring(pair[0]) <= ring(pair[1]));
        }
    }
}
