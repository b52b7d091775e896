//! Pilot: a cheap estimate of the cost of each piece, for the order `tiles:WxH:cost`.

use crate::film::{Bounds, Piece, Plan, TileBuffer};
use crate::kernel::Kernel;

/// One in this many rows of a piece is rendered.
const STRIDE: u32 = 4;

/// The rays that each piece will take, estimated from one sample in every pixel of every fourth row. Rays instead of
/// seconds keep the order the same in each run.
pub(super) fn costs(plan: &Plan, kernel: &dyn Kernel) -> Vec<f64> {
    plan.pieces().iter().map(|piece| cost(piece, kernel)).collect()
}

fn cost(piece: &Piece, kernel: &dyn Kernel) -> f64 {
    let (bounds, samples) = (piece.bounds, &piece.samples);
    let (mut rays, mut rows) = (0, 0);
    for y in (bounds.y0..bounds.y1).step_by(STRIDE as usize) {
        let row = Piece { bounds: Bounds { y0: y, y1: y + 1, ..bounds }, samples: samples.start..samples.start + 1 };
        rays += kernel.render(&row, &mut TileBuffer::new(row.bounds)).rays;
        rows += 1;
    }
    rays as f64 * f64::from(bounds.height()) * samples.len() as f64 / f64::from(rows)
}
