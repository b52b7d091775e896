//! Shards: parts of an image that machines render without communication: `--shard 2/4`.
//!
//! Cut by samples, a shard has a range of all pixels' samples that begins and ends at a block of the sum
//! ([`super::SAMPLE_BLOCK`]), so that its subtrees are subtrees of the whole sum. Cut by tiles, it has all samples of
//! every n-th tile. In both cases the combined shards equal the image rendered at once, bit for bit.

use super::{Bounds, Piece, Plan, PlanSize, SAMPLE_BLOCK};
use crate::error::{InputError, Result};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// Side of the tiles that shards get in turn, in pixels.
const TILE: u32 = 32;

/// The property of the film that is divided among shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ShardCut {
    /// The samples of every pixel.
    Samples,
    /// The pixels.
    Tiles,
}

/// The name in files and on the command line.
impl fmt::Display for ShardCut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Samples => "samples",
            Self::Tiles => "tiles",
        })
    }
}

/// One of several shards of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Shard {
    index: u32,
    count: u32,
    cut: ShardCut,
}

/// A shard as read from a file, unchecked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    index: u32,
    count: u32,
    cut: ShardCut,
}

impl TryFrom<Unchecked> for Shard {
    type Error = String;

    fn try_from(Unchecked { index, count, cut }: Unchecked) -> std::result::Result<Self, String> {
        Self::new(index, count, cut).ok_or_else(|| format!("there is no shard {index} of {count}"))
    }
}

/// The notation of the command line.
impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl Shard {
    /// Shard `index` of `count`, counted from 1; `None` if `index` is out of range.
    pub fn new(index: u32, count: u32, cut: ShardCut) -> Option<Self> {
        (1..=count).contains(&index).then_some(Self { index, count, cut })
    }

    /// Parses text such as `2/4`.
    pub fn parse(text: &str, cut: ShardCut) -> Result<Self> {
        let numbers = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        numbers.and_then(|(index, count)| Self::new(index, count, cut)).ok_or_else(|| {
            InputError::new("shard", text, "is not a valid shard").allowed("I/N with I from 1 to N, such as 2/4").into()
        })
    }

    /// The shard's number; the first is 1.
    pub fn index(&self) -> u32 {
        self.index
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// The property that is divided among them.
    pub fn cut(&self) -> ShardCut {
        self.cut
    }

    /// Returns an error if there are more shards than blocks of samples, or tiles, to divide.
    pub fn check(&self, width: u32, height: u32, spp: u32) -> Result<()> {
        let (most, problem, allowed) = match self.cut {
            ShardCut::Samples => {
                let most = spp.div_ceil(SAMPLE_BLOCK);
                (most, format!("there are more parts than blocks of {SAMPLE_BLOCK} samples"), "--shard-by tiles")
            }
            ShardCut::Tiles => {
                let most = width.div_ceil(TILE) * height.div_ceil(TILE);
                (most, format!("there are more parts than tiles of {TILE}x{TILE} pixels"), "--shard-by samples")
            }
        };
        if self.count <= most {
            return Ok(());
        }
        let allowed = format!("I/N with N at most {most}, or {allowed}");
        Err(InputError::new("shard", self.to_string(), problem).allowed(allowed).into())
    }

    /// The range of the shard's samples if the whole image has `spp`: lengths differ by at most one block.
    pub fn samples(&self, spp: u32) -> Range<u32> {
        if self.cut == ShardCut::Tiles {
            return 0..spp;
        }
        let blocks = u64::from(spp.div_ceil(SAMPLE_BLOCK));
        let edge = |index: u32| {
            let block = blocks * u64::from(index) / u64::from(self.count);
            u32::try_from(block * u64::from(SAMPLE_BLOCK)).map_or(spp, |sample| sample.min(spp))
        };
        edge(self.index - 1)..edge(self.index)
    }

    /// Whether the shard has samples of this pixel. Tiles are dealt along diagonals: with as many columns of tiles as
    /// shards, dealing them row by row would give each shard one column.
    pub fn owns(&self, x: u32, y: u32) -> bool {
        self.cut == ShardCut::Samples || (x / TILE + y / TILE) % self.count == self.index - 1
    }

    /// The number of pixels that the shard has samples of.
    pub fn pixels(&self, width: u32, height: u32) -> u64 {
        let rows = (0..height).map(|y| (0..width).filter(|x| self.owns(*x, y)).count() as u64);
        if self.cut == ShardCut::Samples { u64::from(width) * u64::from(height) } else { rows.sum() }
    }

    /// The size of the parts of all shards together.
    pub fn size_of_parts(&self, plan: &Plan) -> PlanSize {
        let tiles = |from: u32, to: u32| u64::from(to.div_ceil(TILE) - from / TILE);
        let size = |Piece { bounds, .. }: &Piece| {
            let pieces = match self.cut {
                ShardCut::Samples => 1,
                ShardCut::Tiles => tiles(bounds.x0, bounds.x1) * tiles(bounds.y0, bounds.y1),
            };
            PlanSize { pieces, pixels: bounds.area() as u64 }
        };
        plan.pieces().iter().map(size).fold(PlanSize::default(), PlanSize::plus)
    }

    /// The shard's part of a plan's pieces, in the same order.
    #[must_use]
    pub fn part_of(&self, plan: &Plan) -> Plan {
        if self.cut == ShardCut::Samples {
            return plan.clone();
        }
        let pieces = plan.pieces().iter().flat_map(|piece| {
            let tiles = tiles_in(piece.bounds).filter(|bounds| self.owns(bounds.x0, bounds.y0));
            tiles.map(|bounds| Piece { bounds, samples: piece.samples.clone() })
        });
        Plan::from_pieces(pieces.collect())
    }
}

/// Cuts a rectangle along tile boundaries.
fn tiles_in(bounds: Bounds) -> impl Iterator<Item = Bounds> {
    let parts = |from: u32, to: u32| {
        (from / TILE..to.div_ceil(TILE)).map(move |tile| (from.max(tile * TILE), to.min(tile.saturating_add(1) * TILE)))
    };
    parts(bounds.y0, bounds.y1)
        .flat_map(move |(y0, y1)| parts(bounds.x0, bounds.x1).map(move |(x0, x1)| Bounds { x0, y0, x1, y1 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Decomposition, sections};

    fn shards(count: u32, cut: ShardCut) -> impl Iterator<Item = Shard> {
        (1..=count).map(move |index| Shard::new(index, count, cut).unwrap())
    }

    #[test]
    fn samples_are_divided_in_blocks_and_each_belongs_to_one_shard() {
        for spp in [1, 16, 20, 200, 1000, 1 << 24] {
            for count in [1, 2, 3, 7, 20] {
                let parts: Vec<_> = shards(count, ShardCut::Samples).map(|shard| shard.samples(spp)).collect();
                let fits = shards(count, ShardCut::Samples).next().unwrap().check(1, 1, spp).is_ok();
                assert_eq!(fits, parts.iter().all(|part| !part.is_empty()), "{spp} among {count}");
                assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
                assert_eq!((parts[0].start, parts[count as usize - 1].end), (0, spp));
                assert!(parts.iter().all(|part| part.start.is_multiple_of(SAMPLE_BLOCK) || part.is_empty()));
                assert!(parts.iter().all(|part| part.is_empty() || !sections(part).is_empty()));
            }
        }
    }

    #[test]
    fn every_pixel_belongs_to_one_shard_however_the_film_is_cut() {
        for (width, height) in [(100, 70), (32, 32), (128, 64), (33, 1)] {
            for text in ["rows", "tiles:16x16", "tiles:48x40:hilbert", "samples:16:32x32", "grid:5"] {
                let plan = Decomposition::parse(text).unwrap().plan(width, height, &(0..32));
                for count in [1, 2, 3, 7] {
                    let (mut seen, mut pieces) = (vec![0; (width * height) as usize], 0);
                    for shard in shards(count, ShardCut::Tiles) {
                        pieces += shard.part_of(&plan).len();
                        let mut own = 0;
                        for piece in shard.part_of(&plan).pieces() {
                            let Bounds { x0, y0, x1, y1 } = piece.bounds;
                            for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                                assert!(shard.owns(x, y));
                                seen[(y * width + x) as usize] += piece.samples.len();
                                own += piece.samples.len() as u64;
                            }
                        }
                        assert_eq!(own, 32 * shard.pixels(width, height), "{text}, {shard}");
                    }
                    assert!(seen.iter().all(|samples| *samples == 32), "{text} among {count}");
                    let size = Shard::new(1, count, ShardCut::Tiles).unwrap().size_of_parts(&plan);
                    assert_eq!(size.pieces, pieces as u64, "{text} among {count}");
                }
            }
        }
    }

    #[test]
    fn invalid_shards_are_refused() {
        assert_eq!(Shard::parse("2/4", ShardCut::Tiles).unwrap(), Shard::new(2, 4, ShardCut::Tiles).unwrap());
        for text in ["0/4", "5/4", "4", "/4", "1/0", "-1/4", "1/4/2", "a/b", ""] {
            assert_eq!(Shard::parse(text, ShardCut::Samples).unwrap_err().exit_code(), 2, "{text}");
        }
    }
}
