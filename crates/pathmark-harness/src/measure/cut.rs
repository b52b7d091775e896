//! The jobs of a run: refused before any is made if memory or threads do not suffice for so many.

use super::Setup;
use crate::error::{InputError, Result};
use crate::film::{Bounds, Decomposition, Piece, PixelSum, Plan, PlanSize, TileBuffer};
use crate::kernel::Kernel;
use crate::settings::{LARGEST_BYTES, LARGEST_THREADS};
use crate::strategy::{Entry, Workers};
use std::ops::Range;

/// Bytes of a job besides its pixels: its piece, its place in the ledger and in the output, its span and its counts,
/// some of them several times. Measured: 336 for pieces of one pixel and 360 for pieces of 16 pixels.
const JOB_BYTES: u64 = 384;
const PIXEL_BYTES: u64 = size_of::<PixelSum>() as u64;

/// Cuts a film into pieces: section by section of its samples.
pub(super) fn cut(
    decomposition: &Decomposition,
    strategy: &Entry,
    [width, height]: [u32; 2],
    sections: &[Range<u32>],
) -> Result<Plan> {
    let sizes = sections.iter().map(|samples| decomposition.plan_size(width, height, samples));
    check(sizes.fold(PlanSize::default(), PlanSize::plus), decomposition, strategy)?;
    let mut plan = Plan::default();
    for samples in sections {
        plan.append(&decomposition.plan(width, height, samples));
    }
    Ok(plan)
}

fn check(size: PlanSize, decomposition: &Decomposition, strategy: &Entry) -> Result<()> {
    let PlanSize { pieces: jobs, pixels } = size;
    let bytes = jobs * JOB_BYTES + pixels * PIXEL_BYTES;
    let refused = |problem: String, allowed: String| {
        Err(InputError::new("decomposition", decomposition.name(), problem).allowed(allowed).into())
    };
    if bytes > LARGEST_BYTES {
        let (each, most) = (bytes / jobs, LARGEST_BYTES >> 30);
        let allowed = LARGEST_BYTES / each;
        return refused(
            format!("makes {jobs} jobs of {each} bytes each, for which the program would need {} GiB", bytes >> 30),
            format!(
                "at most {allowed} such jobs, which take {most} GiB; larger tiles, or more samples in each job, make fewer"
            ),
        );
    }
    if strategy.workers == Workers::PerJob && jobs > LARGEST_THREADS as u64 {
        let problem = format!("makes {jobs} jobs, and {} starts a thread for each", strategy.name);
        return refused(problem, format!("at most {LARGEST_THREADS} jobs"));
    }
    Ok(())
}

impl Setup {
    /// The pieces of other samples than those of the settings: of each section in turn.
    pub(super) fn plan_of(&self, sections: &[Range<u32>]) -> Result<Plan> {
        let spec = &self.settings().spec;
        cut(&self.decomposition, self.strategy(), [spec.width, spec.height], sections)
    }

    /// Refuses a plan of pieces that are cut further, if it would be too large.
    pub(super) fn check_size(&self, size: PlanSize) -> Result<()> {
        check(size, &self.decomposition, self.strategy())
    }
}

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
