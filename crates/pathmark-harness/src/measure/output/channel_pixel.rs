//! `--output channel-pixel`: each pixel is sent through one channel as soon as its row of the piece is rendered, and received when all
//! jobs are done, as report D (docs/reports.md) does it.
//!
//! Cost: a message for each pixel on a queue that all workers append to, and memory for all of them until the end.

use super::{Delivery, Entry, Output};
use crate::film::{Bounds, Film, Piece, PixelSum, TileBuffer};
use crate::kernel::{Counts, Kernel};
use crossbeam::channel::{Receiver, Sender, unbounded};

pub(super) const ENTRY: Entry = Entry {
    name: "channel-pixel",
    about: "each pixel is a message through one channel (report D)",
    new: |delivery| {
        let (sender, receiver) = unbounded();
        Ok(Box::new(ChannelPixel { delivery, sender, receiver }))
    },
};

struct Pixel {
    job: usize,
    x: u32,
    y: u32,
    sum: PixelSum,
}

struct ChannelPixel {
    delivery: Delivery,
    sender: Sender<Pixel>,
    receiver: Receiver<Pixel>,
}

impl Output for ChannelPixel {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let Piece { bounds, samples } = &self.delivery.plan.pieces()[index];
        let mut counts = Counts::default();
        for y in bounds.y0..bounds.y1 {
            let row = Piece { bounds: Bounds { y0: y, y1: y + 1, ..*bounds }, samples: samples.clone() };
            let mut tile = TileBuffer::new(row.bounds);
            counts.add(&kernel.render(&row, &mut tile));
            for (x, sum) in (bounds.x0..bounds.x1).zip(tile.row_mut(y)) {
                // It fails only without a receiver, and `self` holds one.
                let _ = self.sender.send(Pixel { job: index, x, y, sum: *sum });
            }
        }
        counts
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        let Delivery { plan, mut films, .. } = self.delivery;
        let mut tiles: Vec<TileBuffer> = plan.pieces().iter().map(|piece| TileBuffer::new(piece.bounds)).collect();
        for Pixel { job, x, y, sum } in self.receiver.try_iter() {
            let left = tiles[job].bounds().x0;
            tiles[job].row_mut(y)[(x - left) as usize] = sum;
        }
        for (piece, tile) in plan.pieces().iter().zip(tiles) {
            films.add(&piece.samples, tile);
        }
        films.finish()
    }
}
