//! Jobs encoded as words for messages between ranks, and decoded again. Sums keep all their bits.

use crate::film::{Plan, TileBuffer};
use crate::kernel::Counts;
use crate::measure::{DoneJob, JobSpan};

/// Words before the pixels: index, worker, start, stop, and seven counts.
const HEAD: usize = 11;
/// Words of a pixel: three sums, three sums of squares, and the number of samples.
const PIXEL: usize = 7;

/// Encodes jobs of a rank whose workers are numbered from `first_worker` on.
pub(super) fn words(done: &[DoneJob], first_worker: u32) -> Vec<u64> {
    let pixels: usize = done.iter().map(|job| job.tile.bounds().area()).sum();
    let mut words = Vec::with_capacity(done.len() * HEAD + pixels * PIXEL);
    for DoneJob { index, span, counts, tile } in done {
        let Counts { paths, rays, invalid, escaped, truncated, box_tests, primitive_tests } = *counts;
        words.extend([
            *index as u64,
            u64::from(first_worker + span.worker),
            span.start_s.to_bits(),
            span.stop_s.to_bits(),
        ]);
        words.extend([paths, rays, invalid, escaped, truncated, box_tests, primitive_tests]);
        for pixel in tile.rows().flatten() {
            words.extend(pixel.sum.iter().chain(&pixel.square).map(|value| value.to_bits()));
            words.push(u64::from(pixel.count));
        }
    }
    words
}

/// Decodes the jobs of a plan; `None` if [`words`] cannot have encoded them.
pub(super) fn jobs(mut words: &[u64], plan: &Plan) -> Option<Vec<DoneJob>> {
    let mut done = Vec::new();
    while !words.is_empty() {
        let head;
        (head, words) = words.split_at_checked(HEAD)?;
        let [index, worker, start, stop, paths, rays, invalid, escaped, truncated, box_tests, primitive_tests] =
            head.try_into().ok()?;
        let index = usize::try_from(index).ok()?;
        let bounds = plan.pieces().get(index)?.bounds;
        let mut tile = TileBuffer::new(bounds);
        for y in bounds.y0..bounds.y1 {
            for pixel in tile.row_mut(y) {
                let values;
                (values, words) = words.split_at_checked(PIXEL)?;
                pixel.sum = std::array::from_fn(|channel| f64::from_bits(values[channel]));
                pixel.square = std::array::from_fn(|channel| f64::from_bits(values[3 + channel]));
                pixel.count = u32::try_from(values[6]).ok()?;
            }
        }
        let (start_s, stop_s) = (f64::from_bits(start), f64::from_bits(stop));
        let span = JobSpan { worker: u32::try_from(worker).ok()?, start_s, stop_s };
        let counts = Counts { paths, rays, invalid, escaped, truncated, box_tests, primitive_tests };
        done.push(DoneJob { index, span, counts, tile });
    }
    Some(done)
}
