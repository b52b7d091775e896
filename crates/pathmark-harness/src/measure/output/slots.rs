//! `--output slots`: each job has its own buffer, made before the run, and no worker waits for another.

use super::{Delivery, Entry, Output};
use crate::error::Result;
use crate::film::{Bounds, Film, TileBuffer};
use crate::kernel::{Counts, Kernel};
use crossbeam::atomic::AtomicCell;

pub(super) const ENTRY: Entry = Entry {
    name: "slots",
    about: "one buffer per job, allocated before the run: no worker waits for another (the default)",
    new: |delivery| Ok(Box::new(Slots::new(delivery)?)),
};

/// The buffers. One is missing while its job renders into it.
pub(super) struct Slots {
    pub(super) delivery: Delivery,
    cells: Vec<AtomicCell<Option<Box<TileBuffer>>>>,
}

impl Slots {
    /// Empty buffers for all pieces: allocated and touched here, so that jobs need not do it.
    pub(super) fn new(delivery: Delivery) -> Result<Self> {
        let rectangles: Vec<Bounds> = delivery.plan.pieces().iter().map(|piece| piece.bounds).collect();
        let tiles = TileBuffer::all(&rectangles, delivery.threads)?;
        let cells = tiles.into_iter().map(|tile| AtomicCell::new(Some(Box::new(tile)))).collect();
        Ok(Self { delivery, cells })
    }

    pub(super) fn fill(&self, index: usize, work: impl FnOnce(&mut TileBuffer) -> Counts) -> Counts {
        let bounds = self.delivery.plan.pieces()[index].bounds;
        let mut tile = self.cells[index].take().unwrap_or_else(|| Box::new(TileBuffer::new(bounds)));
        let counts = work(&mut tile);
        self.cells[index].store(Some(tile));
        counts
    }
}

impl Output for Slots {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        self.fill(index, |tile| kernel.render(&self.delivery.plan.pieces()[index], tile))
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        let Delivery { plan, mut films, threads } = self.delivery;
        let tiles = plan.pieces().iter().zip(self.cells);
        let tiles = tiles.filter_map(|(piece, cell)| Some((piece.samples.clone(), *cell.take()?)));
        films.add_all(tiles, threads);
        films.finish()
    }
}
