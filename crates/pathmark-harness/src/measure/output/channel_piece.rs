//! `--output channel-piece`: each job sends its finished piece through one channel; it is received when all jobs are done.
//!
//! Cost: a buffer allocated in each job, and one message for each, on a queue that all workers append to.

use super::{Delivery, Entry, Output};
use crate::film::{Film, TileBuffer};
use crate::kernel::{Counts, Kernel};
use crossbeam::channel::{Receiver, Sender, unbounded};

pub(super) const ENTRY: Entry = Entry {
    name: "channel-piece",
    about: "each piece is a message through one channel",
    new: |delivery| {
        let (sender, receiver) = unbounded();
        Ok(Box::new(ChannelPiece { delivery, sender, receiver }))
    },
};

struct ChannelPiece {
    delivery: Delivery,
    sender: Sender<(usize, TileBuffer)>,
    receiver: Receiver<(usize, TileBuffer)>,
}

impl Output for ChannelPiece {
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts {
        let piece = &self.delivery.plan.pieces()[index];
        let mut tile = TileBuffer::new(piece.bounds);
        let counts = kernel.render(piece, &mut tile);
        // It fails only without a receiver, and `self` holds one.
        let _ = self.sender.send((index, tile));
        counts
    }

    fn films(self: Box<Self>) -> Vec<Film> {
        let Delivery { plan, mut films, .. } = self.delivery;
        for (index, tile) in self.receiver.try_iter() {
            films.add(&plan.pieces()[index].samples, tile);
        }
        films.finish()
    }
}
