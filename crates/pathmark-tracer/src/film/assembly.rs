//! Assembly: pieces that arrive in any order are combined into the same film.
//!
//! A pixel's samples are summed along a fixed tree ([`super::SampleSum`]). A piece with only some of its pixels'
//! samples is a subtree. It waits here for its neighbour, and both are added to form their parent. So the film depends
//! on the pieces, not on their order.

use super::{Bounds, Film, TileBuffer};
use crate::error::Result;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// A film during its assembly.
#[derive(Debug)]
pub struct Assembly {
    film: Film,
    samples: Range<u32>,
    /// Subtrees waiting for their neighbours, by rectangle and first sample, each with its number of samples.
    waiting: HashMap<Bounds, BTreeMap<u32, (u32, TileBuffer)>>,
}

impl Assembly {
    /// Creates an empty film whose pixels will have the samples in `samples`. Fails if the system lacks the memory.
    pub fn new(width: u32, height: u32, samples: Range<u32>) -> Result<Self> {
        Ok(Self { film: Film::try_new(width, height)?, samples, waiting: HashMap::new() })
    }

    /// Adds a piece that was rendered into `tile`. Every piece must be added exactly once.
    pub fn add(&mut self, samples: &Range<u32>, mut tile: TileBuffer) {
        if *samples == self.samples {
            self.film.place(&tile);
            return;
        }
        let (mut start, mut length) = (samples.start, samples.end - samples.start);
        let parts = self.waiting.entry(tile.bounds()).or_default();
        // A subtree of n samples starts at a multiple of n. It is the left child of its parent if that multiple is even.
        while start.is_multiple_of(length) {
            let left = (start / length).is_multiple_of(2);
            let neighbour = if left { start.checked_add(length) } else { Some(start - length) };
            let fits = |at: &u32| parts.get(at).is_some_and(|(found, _)| *found == length);
            let Some((_, other)) = neighbour.filter(fits).and_then(|at| parts.remove(&at)) else { break };
            tile = if left { tile.plus(&other) } else { other.plus(&tile) };
            start = if left { start } else { start - length };
            length *= 2;
        }
        parts.insert(start, (length, tile));
    }

    /// Adds many pieces. Up to `threads` threads place the pieces that have all samples of their pixels.
    pub fn add_all(&mut self, pieces: Vec<(Range<u32>, TileBuffer)>, threads: usize) {
        let (whole, parts): (Vec<_>, Vec<_>) = pieces.into_iter().partition(|(samples, _)| *samples == self.samples);
        let whole: Vec<TileBuffer> = whole.into_iter().map(|(_, tile)| tile).collect();
        self.film.place_all(&whole, threads);
        for (samples, tile) in parts {
            self.add(&samples, tile);
        }
    }

    /// Returns the film, once all pieces have been added.
    pub fn finish(mut self) -> Film {
        for parts in self.waiting.into_values() {
            // The remaining subtrees are the digits of a binary number. They are summed from the smallest up: the last
            // one first.
            let whole = parts.into_values().map(|(_, tile)| tile).rev().reduce(|later, tile| tile.plus(&later));
            if let Some(tile) = whole {
                self.film.place(&tile);
            }
        }
        self.film
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{PixelSum, SAMPLE_BLOCK, SampleSum};
    use crate::math::Rgb;

    const BOUNDS: Bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };

    fn sum(samples: Range<u32>) -> PixelSum {
        let mut sum = SampleSum::default();
        samples.for_each(|k| sum.add(Rgb { r: 1.0 / f64::from(k % 97 + 1), g: f64::from(k) * 0.3, b: 0.1 }));
        sum.total()
    }

    fn part(samples: Range<u32>) -> TileBuffer {
        let mut tile = TileBuffer::new(BOUNDS);
        tile.row_mut(0)[0] = sum(samples);
        tile
    }

    /// Every count up to 200 samples, blocks of 16, 32 and 64, in order, backwards and interleaved: the bits of the undivided sum.
    #[test]
    fn any_order_gives_the_undivided_sum() {
        for spp in 1..=200 {
            for block in [SAMPLE_BLOCK, 2 * SAMPLE_BLOCK, 4 * SAMPLE_BLOCK] {
                let parts: Vec<Range<u32>> =
                    (0..spp).step_by(block as usize).map(|start| start..(start + block).min(spp)).collect();
                let (even, odd): (Vec<_>, Vec<_>) =
                    parts.iter().cloned().partition(|part| (part.start / block) % 2 == 0);
                let orders = [parts.clone(), parts.into_iter().rev().collect(), [odd, even].concat()];
                for order in orders {
                    let mut assembly = Assembly::new(1, 1, 0..spp).unwrap();
                    for samples in &order {
                        assembly.add(samples, part(samples.clone()));
                    }
                    let mut at_once = Assembly::new(1, 1, 0..spp).unwrap();
                    at_once.add_all(order.iter().map(|samples| (samples.clone(), part(samples.clone()))).collect(), 2);
                    for film in [assembly.finish(), at_once.finish()] {
                        assert_eq!(film.pixels(), [sum(0..spp)], "{spp} spp in {order:?}");
                    }
                }
            }
        }
    }

    /// Tiles of any size, some of which cross the threads' bands.
    #[test]
    fn threads_and_one_thread_place_the_same() {
        let (width, height) = (37, 29);
        let mut tiles = Vec::new();
        for y0 in (0..height).step_by(6) {
            for x0 in (0..width).step_by(5) {
                let bounds = Bounds { x0, y0, x1: (x0 + 5).min(width), y1: (y0 + 6).min(height) };
                let mut tile = TileBuffer::new(bounds);
                for y in bounds.y0..bounds.y1 {
                    for (x, pixel) in (x0..).zip(tile.row_mut(y)) {
                        pixel.count = 1;
                        pixel.sum = [f64::from(x), f64::from(y), 1.0];
                    }
                }
                tiles.push((0..1, tile));
            }
        }
        for threads in [1, 2, 3, 8, 29, 100] {
            let mut assembly = Assembly::new(width, height, 0..1).unwrap();
            assembly.add_all(tiles.clone(), threads);
            for (index, pixel) in (0..).zip(assembly.finish().pixels()) {
                let [x, y] = [index % width, index / width].map(f64::from);
                assert_eq!((pixel.sum, pixel.count), ([x, y, 1.0], 1), "{threads} threads");
            }
        }
    }
}
