//! Growing films: samples are added in rounds, and the result has the same bits as all samples at once.
//!
//! A growing film keeps the finished subtrees of each pixel's sum ([`super::SampleSum`]) for the whole image, like the
//! digits of a binary counter, and the unfinished block apart. More samples come in sections that are subtrees
//! themselves. The unfinished block cannot be continued without its single samples, so its up to 15 samples are
//! rendered again.

use super::{Assembly, Film, SAMPLE_BLOCK, TileBuffer};
use crate::error::Result;
use std::ops::Range;

/// Cuts samples into the largest subtrees that fit: 16 · 2^k samples that start at a multiple of their number. The last
/// section may be a rest of less than a block. `samples` must start at a multiple of [`SAMPLE_BLOCK`].
pub fn sections(samples: &Range<u32>) -> Vec<Range<u32>> {
    debug_assert!(samples.start.is_multiple_of(SAMPLE_BLOCK));
    let (mut cut, mut start) = (Vec::new(), samples.start);
    while start < samples.end {
        let left = samples.end - start;
        let length = if left < SAMPLE_BLOCK {
            left
        } else {
            // The largest power of two that fits into the rest; sample 0 is a multiple of all.
            let fits = 1 << left.ilog2();
            if start == 0 { fits } else { fits.min(1 << start.trailing_zeros()) }
        };
        cut.push(start..start + length);
        start += length;
    }
    cut
}

/// Sections that are assembled at the same time, from pieces in any order.
#[derive(Debug)]
pub struct Sections {
    ends: Vec<u32>,
    assemblies: Vec<Assembly>,
}

impl Sections {
    /// Creates empty films for successive ranges of samples. Fails if the system lacks the memory.
    pub fn new(width: u32, height: u32, sections: &[Range<u32>]) -> Result<Self> {
        let assembly = |samples: &Range<u32>| Assembly::new(width, height, samples.clone());
        let assemblies = sections.iter().map(assembly).collect::<Result<_>>()?;
        Ok(Self { ends: sections.iter().map(|samples| samples.end).collect(), assemblies })
    }

    /// Adds a piece that was rendered into `tile`. All its samples must lie in one section. Every piece must be added
    /// exactly once.
    pub fn add(&mut self, samples: &Range<u32>, tile: TileBuffer) {
        let section = self.ends.partition_point(|end| *end <= samples.start);
        self.assemblies[section].add(samples, tile);
    }

    /// Adds many pieces, with up to `threads` threads; pieces that share pixels are added up by one thread.
    pub fn add_all(&mut self, pieces: impl IntoIterator<Item = (Range<u32>, TileBuffer)>, threads: usize) {
        let mut by_section: Vec<Vec<_>> = self.ends.iter().map(|_| Vec::new()).collect();
        for (samples, tile) in pieces {
            by_section[self.ends.partition_point(|end| *end <= samples.start)].push((samples, tile));
        }
        for (assembly, pieces) in self.assemblies.iter_mut().zip(by_section) {
            assembly.add_all(pieces, threads);
        }
    }

    /// Returns the films, one per section, once all pieces have been added.
    pub fn finish(self) -> Vec<Film> {
        self.assemblies.into_iter().map(Assembly::finish).collect()
    }
}

/// A film that can be continued with more samples.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgressiveFilm {
    width: u32,
    height: u32,
    samples: Range<u32>,
    /// The finished subtrees, from the first samples on, then the unfinished block if there is one.
    parts: Vec<(Range<u32>, Film)>,
}

impl ProgressiveFilm {
    /// Creates a film without samples. Its first sample will have the index `start`, a multiple of [`SAMPLE_BLOCK`].
    pub fn new(width: u32, height: u32, start: u32) -> Self {
        debug_assert!(start.is_multiple_of(SAMPLE_BLOCK));
        Self { width, height, samples: start..start, parts: Vec::new() }
    }

    /// Creates a film from parts in the form that [`ProgressiveFilm::parts`] returns; `None` if they lack that form. `owns`
    /// tells by column and row whether a pixel has samples.
    pub fn from_parts(
        width: u32,
        height: u32,
        parts: Vec<(Range<u32>, Film)>,
        owns: impl Fn(u32, u32) -> bool,
    ) -> Option<Self> {
        let start = parts.first().map_or(0, |(samples, _)| samples.start);
        let samples = start..parts.last().map_or(start, |(samples, _)| samples.end);
        let fits = |(samples, film): &(Range<u32>, Film)| {
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let count = |(x, y)| if owns(x, y) { samples.end - samples.start } else { 0 };
            let counts = film.pixels().iter().map(|pixel| pixel.count).eq(places.map(count));
            counts && (film.width(), film.height()) == (width, height)
        };
        let found = parts.iter().map(|(samples, _)| samples.clone());
        let is_aligned = start.is_multiple_of(SAMPLE_BLOCK);
        let is_ours = is_aligned && found.eq(sections(&samples)) && parts.iter().all(fits);
        is_ours.then_some(Self { width, height, samples, parts })
    }

    /// Samples per pixel, including those before the film's first.
    pub fn spp(&self) -> u32 {
        self.samples.end
    }

    /// The subtrees and their ranges of samples.
    pub fn parts(&self) -> &[(Range<u32>, Film)] {
        &self.parts
    }

    /// Returns the subtrees of a film that will grow no more.
    pub fn into_parts(self) -> Vec<(Range<u32>, Film)> {
        self.parts
    }

    /// The sections to render and add, in this order, to reach `spp` samples. Empty if there are at least as many
    /// already; a film does not shrink.
    pub fn missing(&self, spp: u32) -> Vec<Range<u32>> {
        Self::missing_after(self.samples.end, spp)
    }

    /// The same for any film that has the samples up to `end`.
    pub fn missing_after(end: u32, spp: u32) -> Vec<Range<u32>> {
        if spp <= end { Vec::new() } else { sections(&(end / SAMPLE_BLOCK * SAMPLE_BLOCK..spp)) }
    }

    /// Adds the next section.
    pub fn add(&mut self, samples: Range<u32>, mut film: Film) {
        // Parts from here on are an unfinished block; the new samples include it.
        self.parts.retain(|(found, _)| found.start < samples.start);
        self.samples.end = samples.end;
        let mut samples = samples;
        let length = |samples: &Range<u32>| samples.end - samples.start;
        // A subtree of n samples is the left child of its parent if it starts at a multiple of 2 n.
        let is_left = |before: &Range<u32>| before.start.is_multiple_of(length(before).saturating_mul(2));
        while let Some((before, earlier)) =
            self.parts.pop_if(|(before, _)| length(before) == length(&samples) && is_left(before))
        {
            film = earlier.plus(&film);
            samples.start = before.start;
        }
        self.parts.push((samples, film));
    }

    /// The sum of all samples: equal, bit for bit, to a film rendered with them at once, if the first sample has index
    /// 0.
    pub fn film(&self) -> Film {
        let mut parts = self.parts.iter().rev().map(|(_, film)| film);
        let Some(last) = parts.next() else { return Film::new(self.width, self.height) };
        parts.fold(last.clone(), |later, film| film.clone().plus(&later))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Bounds, SampleSum};
    use crate::math::Rgb;

    const BOUNDS: Bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };

    fn part(samples: Range<u32>) -> TileBuffer {
        let mut sum = SampleSum::default();
        samples.for_each(|k| sum.add(Rgb { r: 1.0 / f64::from(k % 97 + 1), g: f64::from(k) * 0.3, b: 0.1 }));
        let mut tile = TileBuffer::new(BOUNDS);
        tile.row_mut(0)[0] = sum.total();
        tile
    }

    fn rendered(samples: Range<u32>) -> Film {
        let mut assembly = Assembly::new(1, 1, samples.clone()).unwrap();
        assembly.add(&samples.clone(), part(samples));
        assembly.finish()
    }

    fn extend(film: &mut ProgressiveFilm, spp: u32) {
        let missing = film.missing(spp);
        let mut sections = Sections::new(1, 1, &missing).unwrap();
        // Backwards, because pieces may come in any order.
        missing.iter().rev().for_each(|samples| sections.add(samples, part(samples.clone())));
        for (samples, part) in missing.into_iter().zip(sections.finish()) {
            film.add(samples, part);
        }
    }

    #[test]
    fn sections_are_subtrees_and_cover_everything_once() {
        assert_eq!(sections(&(0..100)), [0..64, 64..96, 96..100]);
        assert_eq!(sections(&(48..128)), [48..64, 64..128]);
        assert_eq!(sections(&(48..55)).first(), Some(&(48..55)));
        for start in (0..400).step_by(16) {
            for end in start..400 {
                let found = sections(&(start..end));
                let mut at = start;
                for Range { start, end } in found.iter().cloned() {
                    let length = end - start;
                    assert!(start == at && start.is_multiple_of(length.next_power_of_two()), "{found:?}");
                    assert!(length < SAMPLE_BLOCK || length.is_power_of_two(), "{found:?}");
                    at = end;
                }
                assert_eq!(at, end);
            }
        }
    }

    /// Two and three rounds with any numbers of samples give the same bits as one.
    #[test]
    fn rounds_give_the_undivided_sum() {
        for spp in 1..=140 {
            let expected = rendered(0..spp);
            for first in 1..=spp {
                let mut film = ProgressiveFilm::new(1, 1, 0);
                extend(&mut film, first);
                assert_eq!((film.film(), film.spp()), (rendered(0..first), first));
                extend(&mut film, first.midpoint(spp));
                extend(&mut film, spp);
                assert_eq!((film.film(), film.spp()), (expected.clone(), spp), "{first} of {spp}");
                let again = ProgressiveFilm::from_parts(1, 1, film.parts().to_vec(), |_, _| true).unwrap();
                assert_eq!(again, film);
            }
        }
    }

    /// Films of successive ranges, each rendered in two rounds, are combined: the result has the bits of one film.
    #[test]
    fn ranges_give_the_undivided_sum() {
        for spp in [33, 64, 100, 160, 200] {
            for cut in (0..spp).step_by(16) {
                for second in (cut..spp).step_by(16) {
                    let mut whole = ProgressiveFilm::new(1, 1, 0);
                    for range in [0..cut, cut..second, second..spp] {
                        let mut film = ProgressiveFilm::new(1, 1, range.start);
                        extend(&mut film, range.start.midpoint(range.end));
                        extend(&mut film, range.end);
                        let found: Vec<_> = film.parts().iter().map(|(samples, _)| samples.clone()).collect();
                        assert_eq!(found, sections(&range));
                        film.parts().iter().cloned().for_each(|(samples, part)| whole.add(samples, part));
                    }
                    assert_eq!(whole.film(), rendered(0..spp), "{spp} cut at {cut} and {second}");
                }
            }
        }
    }

    #[test]
    fn a_film_does_not_shrink_and_parts_that_are_no_subtrees_are_refused() {
        let mut film = ProgressiveFilm::new(1, 1, 0);
        assert_eq!(film.film(), Film::new(1, 1));
        extend(&mut film, 100);
        assert!(film.missing(100).is_empty() && film.missing(3).is_empty());
        let refused = |parts| assert!(ProgressiveFilm::from_parts(1, 1, parts, |_, _| true).is_none());
        refused(vec![(0..48, rendered(0..48))]);
        refused(vec![(0..16, rendered(0..16)), (32..64, rendered(32..64))]);
        refused(vec![(8..16, rendered(8..16))]);
        refused(vec![(0..16, rendered(0..32))]);
        refused(film.parts().iter().rev().cloned().collect());
        assert!(ProgressiveFilm::from_parts(2, 1, film.parts().to_vec(), |_, _| true).is_none());
    }
}
