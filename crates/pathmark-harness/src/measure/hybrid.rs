//! Devices that render pieces beside the workers.
//!
//! Each device has a thread that claims pieces, from the last one backwards and many at a time, and lets the device
//! render them. A worker skips a piece that is claimed. Any strategy can therefore share its pieces with a device.
//! Batches are as large as suits the device and the end of the run allows: at most half of the device's share of the
//! rest, if it and the workers continue at their speeds so far.

use super::ledger::Ledger;
use super::output::Output;
use crate::error::{Error, Result};
use crate::film::{Bounds, Piece, Plan, TileBuffer};
use crate::kernel::{Counts, Kernel};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

/// Intended duration of a batch, in seconds: launches that take longer are divided anyway.
const BATCH_S: f64 = 0.25;

/// The pieces that have been claimed; without a device, all belong to the workers.
pub(super) struct PieceClaims {
    taken: Vec<AtomicBool>,
    left: AtomicUsize,
}

impl PieceClaims {
    /// Returns claims for `pieces` pieces, all unclaimed; nothing is kept without a device.
    pub(super) fn new(pieces: usize, has_device: bool) -> Self {
        let pieces = if has_device { pieces } else { 0 };
        Self { taken: (0..pieces).map(|_| AtomicBool::new(false)).collect(), left: AtomicUsize::new(pieces) }
    }

    /// Claims a piece; returns whether it is the caller's from now on.
    pub(super) fn take(&self, index: usize) -> bool {
        let Some(taken) = self.taken.get(index) else { return true };
        let is_free = !taken.swap(true, Ordering::Relaxed);
        if is_free {
            self.left.fetch_sub(1, Ordering::Relaxed);
        }
        is_free
    }

    fn left(&self) -> usize {
        self.left.load(Ordering::Relaxed)
    }
}

/// A rendered piece, as a kernel: an output takes it as it takes any other.
struct Rendered {
    tile: TileBuffer,
    counts: Counts,
}

impl Kernel for Rendered {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let Bounds { y0, .. } = piece.bounds;
        for (y, row) in (y0..).zip(self.tile.rows()) {
            out.row_mut(y)[..row.len()].copy_from_slice(row);
        }
        self.counts
    }
}

pub(super) struct Shared<'a> {
    pub(super) plan: &'a Plan,
    pub(super) claims: &'a PieceClaims,
    pub(super) ledger: &'a Ledger,
    pub(super) output: &'a dyn Output,
}

impl Shared<'_> {
    pub(super) fn beside(
        &self,
        devices: Vec<&dyn Kernel>,
        start: Instant,
        work: impl FnOnce() -> Result<()>,
    ) -> Result<()> {
        thread::scope(|scope| {
            for device in devices {
                let started = thread::Builder::new().spawn_scoped(scope, move || self.serve(device, start));
                started.map_err(|e| Error::system("starting", "the thread that serves a device", e))?;
            }
            work()
        })
    }

    /// Claims at most `most` free pieces from the end; the pieces from `next` on have been tried.
    fn claim(&self, next: &mut usize, most: usize) -> Vec<usize> {
        let mut claimed = Vec::new();
        while claimed.len() < most && *next > 0 {
            *next -= 1;
            if self.claims.take(*next) {
                claimed.push(*next);
            }
        }
        claimed
    }

    /// Lets the device render pieces until none is left or it fails.
    fn serve(&self, device: &dyn Kernel, start: Instant) {
        let pieces = self.plan.pieces();
        let (mut next, mut batch, mut done) = (pieces.len(), 1, 0);
        let mut longest = 1;
        loop {
            let claimed = self.claim(&mut next, batch);
            if claimed.is_empty() {
                return;
            }
            let tiles = claimed.iter().map(|index| TileBuffer::new(pieces[*index].bounds));
            let mut tiles: Vec<TileBuffer> = tiles.collect();
            let of_batch: Vec<&Piece> = claimed.iter().map(|index| &pieces[*index]).collect();
            let start_s = start.elapsed().as_secs_f64();
            let counts = device.render_all(&of_batch, &mut tiles);
            if device.failure().is_some() {
                return;
            }
            let stop_s = start.elapsed().as_secs_f64();
            let each_s = (stop_s - start_s) / claimed.len() as f64;
            for (place, ((index, tile), counts)) in claimed.iter().zip(tiles).zip(counts).enumerate() {
                let span = [start_s + place as f64 * each_s, start_s + (place + 1) as f64 * each_s];
                self.ledger.enter(*index, span, || self.output.render(*index, &Rendered { tile, counts }));
            }
            done += claimed.len();
            // As many as take long enough, at most twice the last limit, and at most half of the device's share of the
            // rest.
            let by_workers = (pieces.len() - self.claims.left()).saturating_sub(done) as f64 / stop_s;
            let by_device = 1.0 / each_s.max(1e-9);
            let share = self.claims.left() as f64 * by_device / (by_device + by_workers);
            longest *= 2;
            batch = ((BATCH_S * by_device) as usize).min(longest).min((0.5 * share) as usize).max(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Decomposition, Film};
    use std::sync::Mutex;

    /// A device whose sums show which pieces it was given.
    struct Device;

    impl Kernel for Device {
        fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
            let Bounds { x0, y0, .. } = piece.bounds;
            out.row_mut(y0)[0].sum = [f64::from(x0), f64::from(y0), 0.0];
            Counts { paths: 1, ..Counts::default() }
        }
    }

    /// The delivered pieces, with their sums.
    #[derive(Default)]
    struct Delivered(Mutex<Vec<(usize, [f64; 3])>>, Plan);

    impl Output for Delivered {
        fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
            let piece = &self.1.pieces()[index];
            let mut tile = TileBuffer::new(piece.bounds);
            let counts = kernel.render(piece, &mut tile);
            self.0.lock().unwrap().push((index, tile.row_mut(piece.bounds.y0)[0].sum));
            counts
        }
        fn films(self: Box<Self>) -> Vec<Film> {
            Vec::new()
        }
    }

    /// Without workers the device renders all remaining pieces, from the last one backwards, one after the other in its
    /// lane.
    #[test]
    fn a_device_renders_the_remaining_pieces() {
        let plan = Decomposition::parse("tiles:4x4").unwrap().plan(40, 20, &(0..16));
        let (claims, ledger) = (PieceClaims::new(plan.len(), true), Ledger::new(plan.len(), &[]));
        assert!(claims.take(7));
        ledger.record(7, Instant::now(), Counts::default);
        let output = Delivered(Mutex::default(), plan.clone());
        Shared { plan: &plan, claims: &claims, ledger: &ledger, output: &output }.serve(&Device, Instant::now());
        let delivered = output.0.into_inner().unwrap();
        let order: Vec<usize> = (0..plan.len()).rev().filter(|index| *index != 7).collect();
        assert_eq!(delivered.iter().map(|(index, _)| *index).collect::<Vec<_>>(), order);
        for (index, sum) in delivered {
            let Bounds { x0, y0, .. } = plan.pieces()[index].bounds;
            assert_eq!(sum, [f64::from(x0), f64::from(y0), 0.0]);
        }
        let entries = ledger.close().unwrap();
        let spans: Vec<_> = order.iter().map(|index| entries[*index].span).collect();
        assert!(spans.windows(2).all(|two| two[0].stop_s <= two[1].start_s + 1e-9), "{spans:?}");
        assert_eq!(entries.iter().map(|entry| entry.counts.paths).sum::<u64>(), order.len() as u64);
    }

    /// Workers and a device claim each piece once.
    #[test]
    fn each_piece_is_claimed_once() {
        let claims = PieceClaims::new(10_000, true);
        let claimed = AtomicUsize::new(0);
        thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    let mine = (0..10_000).filter(|index| claims.take(*index)).count();
                    claimed.fetch_add(mine, Ordering::Relaxed);
                });
            }
            let mine = (0..10_000).rev().filter(|index| claims.take(*index)).count();
            claimed.fetch_add(mine, Ordering::Relaxed);
        });
        assert_eq!((claimed.into_inner(), claims.left()), (10_000, 0));
        assert!(PieceClaims::new(10, false).take(3));
    }
}
