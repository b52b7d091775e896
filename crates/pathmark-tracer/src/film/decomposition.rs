//! Decompositions of a film into jobs: `--decomposition rows | bands:N | grid:N | tiles:WxH[:ORDER] | samples:B[:WxH]`.
//!
//! A new decomposition needs a line in `DECOMPOSITIONS` and a function that parses its parameters.

use super::order::ORDERS;
use super::{Plan, PlanSize, SAMPLE_BLOCK, TileOrder};
use crate::error::{InputError, Result};
use std::ops::Range;

/// One line of the table of decompositions.
pub struct Entry {
    /// Its name, the part before the first colon.
    pub name: &'static str,
    pub about: &'static str,
    /// An example that can be run as it is, with the default parameters.
    pub example: &'static str,
    /// Parses the parameters; `None` if they are invalid.
    parse: fn(Option<&str>) -> Option<Cut>,
}

/// The decompositions, in the order in which they are listed.
pub const DECOMPOSITIONS: &[Entry] = &[
    Entry { name: "rows", about: "one job per row of pixels (report A)", example: "rows", parse: parse_rows },
    Entry {
        name: "bands",
        about: "N bands of rows whose sizes differ by at most one (report B)",
        example: "bands:20",
        parse: parse_bands,
    },
    Entry {
        name: "grid",
        about: "N rectangles; columns and rows are the most nearly square factors of N (report D)",
        example: "grid:16",
        parse: parse_grid,
    },
    Entry {
        name: "tiles",
        about: "tiles of WxH pixels, handed out in scanline (the default), hilbert, spiral or cost order",
        example: "tiles:32x32:hilbert",
        parse: parse_tiles,
    },
    Entry {
        name: "samples",
        about: "tiles of WxH pixels (32x32 by default), each cut into jobs of B = 16, 32, 64, ... samples (proposed by report D)",
        example: "samples:16:32x32",
        parse: parse_samples,
    },
];

/// The meaning of a name and its parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Cut {
    columns: Parts,
    rows: Parts,
    order: TileOrder,
    /// Number of a pixel's samples in one job; `None` for all of them.
    block: Option<u32>,
}

/// The division of a side of the film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Parts {
    /// Into this many parts, whose sizes differ by at most one.
    Even(u32),
    /// Into parts of this many pixels; the last part takes the rest.
    Every(u32),
}

/// A way to cut a film into jobs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decomposition {
    text: String,
    cut: Cut,
}

fn cut(columns: Parts, rows: Parts) -> Cut {
    Cut { columns, rows, order: TileOrder::Scanline, block: None }
}

fn parse_rows(parameter: Option<&str>) -> Option<Cut> {
    parameter.is_none().then_some(cut(Parts::Even(1), Parts::Every(1)))
}

fn parse_bands(parameter: Option<&str>) -> Option<Cut> {
    Some(cut(Parts::Even(1), Parts::Even(count(parameter.unwrap_or("20"))?)))
}

fn parse_grid(parameter: Option<&str>) -> Option<Cut> {
    let (columns, rows) = nearly_square_factors(count(parameter.unwrap_or("16"))?);
    Some(cut(Parts::Even(columns), Parts::Even(rows)))
}

fn parse_tiles(parameter: Option<&str>) -> Option<Cut> {
    let parameter = parameter.unwrap_or("32x32");
    let (size, order) = parameter.split_once(':').unwrap_or((parameter, "scanline"));
    let order = ORDERS.iter().find(|(name, _)| *name == order)?.1;
    Some(Cut { order, ..tiles(size)? })
}

fn parse_samples(parameter: Option<&str>) -> Option<Cut> {
    let parameter = parameter.unwrap_or("16");
    let (block, size) = parameter.split_once(':').unwrap_or((parameter, "32x32"));
    // Other numbers of samples would not be a subtree of a pixel's sum.
    let block = count(block).filter(|block| block.is_power_of_two() && *block >= SAMPLE_BLOCK)?;
    Some(Cut { block: Some(block), ..tiles(size)? })
}

fn tiles(size: &str) -> Option<Cut> {
    let (width, height) = size.split_once('x')?;
    Some(cut(Parts::Every(count(width)?), Parts::Every(count(height)?)))
}

fn count(text: &str) -> Option<u32> {
    text.parse().ok().filter(|count| (1..=1 << 24).contains(count))
}

impl Decomposition {
    /// Parses the command line's notation.
    pub fn parse(text: &str) -> Result<Self> {
        let (name, parameter) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
        let entry = DECOMPOSITIONS.iter().find(|entry| entry.name == name);
        if let Some(cut) = entry.and_then(|entry| (entry.parse)(parameter)) {
            return Ok(Self { text: text.to_string(), cut });
        }
        let examples: Vec<&str> = DECOMPOSITIONS.iter().map(|entry| entry.example).collect();
        let problem = if entry.is_some() { "has invalid parameters" } else { "there is no decomposition of that name" };
        Err(InputError::new("decomposition", text, problem)
            .allowed(format!(
                "for example {}; numbers are at least 1, and B of samples:B is 16, 32, 64, ...",
                examples.join(", ")
            ))
            .into())
    }

    /// The text that it was read from.
    pub fn name(&self) -> &str {
        &self.text
    }

    /// Whether the jobs should come in the order of [`Plan::longest_first`].
    pub fn is_by_cost(&self) -> bool {
        self.cut.order == TileOrder::Cost
    }

    /// Whether a pixel's samples may belong to several jobs.
    pub fn splits_samples(&self) -> bool {
        self.sample_block().is_some()
    }

    /// Number of a pixel's samples in one job, if they may belong to several jobs.
    pub(super) fn sample_block(&self) -> Option<u32> {
        self.cut.block
    }

    pub fn plan_size(&self, width: u32, height: u32, samples: &Range<u32>) -> PlanSize {
        let parts = self.parts(samples);
        let tiles = self.cut.columns.count(width) * self.cut.rows.count(height);
        PlanSize { pieces: tiles * parts, pixels: u64::from(width) * u64::from(height) * parts }
    }

    /// The number of jobs among which these samples of a pixel are divided.
    pub(super) fn parts(&self, samples: &Range<u32>) -> u64 {
        let count = samples.end.saturating_sub(samples.start);
        u64::from(self.cut.block.map_or(1, |block| count.div_ceil(block)))
    }

    /// Cuts a film of `width` x `height` pixels with the samples in `samples`.
    pub fn plan(&self, width: u32, height: u32, samples: &Range<u32>) -> Plan {
        let (columns, rows) = (self.cut.columns.boundaries(width), self.cut.rows.boundaries(height));
        let order = self.cut.order.permutation(columns.len() - 1, rows.len() - 1);
        let plan = Plan::from_boundaries(&columns, &rows, samples).reordered(&order);
        if let Some(block) = self.cut.block { plan.split_samples(block) } else { plan }
    }
}

impl Parts {
    /// The number of parts of a side.
    fn count(self, length: u32) -> u64 {
        u64::from(match self {
            Self::Even(parts) => parts.min(length),
            Self::Every(step) => length.div_ceil(step),
        })
    }

    /// The start of each part of a side, and the end of the last one.
    fn boundaries(self, length: u32) -> Vec<u32> {
        match self {
            // Boundary k is k · length / parts, rounded up.
            Self::Even(parts) => {
                let parts = parts.min(length);
                (0..=parts).map(|k| (u64::from(length) * u64::from(k)).div_ceil(u64::from(parts)) as u32).collect()
            }
            Self::Every(step) => (0..length).step_by(step as usize).chain(std::iter::once(length)).collect(),
        }
    }
}

/// The two factors of `n` that are closest to each other, the larger first: more columns than rows, because images are
/// usually wide.
fn nearly_square_factors(n: u32) -> (u32, u32) {
    let rows = (1..=n.isqrt()).rev().find(|rows| n.is_multiple_of(*rows)).unwrap_or(1);
    (n / rows, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Report D's own numbers (P16): 815 pixels over a 4 x 4 grid.
    #[test]
    fn report_d_grid() {
        assert_eq!(Parts::Even(4).boundaries(815), [0, 204, 408, 612, 815]);
        assert_eq!(
            (nearly_square_factors(16), nearly_square_factors(12), nearly_square_factors(7)),
            ((4, 4), (4, 3), (7, 1))
        );
    }

    #[test]
    fn samples_are_cut_into_blocks_and_a_rest() {
        let plan = Decomposition::parse("samples:32:8x8").unwrap().plan(16, 8, &(0..80));
        let parts: Vec<(u32, Range<u32>)> =
            plan.pieces().iter().map(|piece| (piece.bounds.x0, piece.samples.clone())).collect();
        let of_tile = |x0| [(x0, 0..32), (x0, 32..64), (x0, 64..80)];
        assert_eq!(parts, [of_tile(0), of_tile(8)].concat());
    }

    #[test]
    fn the_size_of_a_plan_is_known_without_it() {
        for text in ["rows", "bands:5", "bands:99", "grid:12", "tiles:8x3:spiral", "samples:16", "samples:32:5x7"] {
            for (width, height, samples) in [(1, 1, 0..1), (16, 8, 0..80), (37, 11, 16..100), (8, 64, 0..64)] {
                let cut = Decomposition::parse(text).unwrap();
                let plan = cut.plan(width, height, &samples);
                let pixels = plan.pieces().iter().map(|piece| piece.bounds.area() as u64).sum();
                let expected = PlanSize { pieces: plan.len() as u64, pixels };
                assert_eq!(cut.plan_size(width, height, &samples), expected, "{text}, {width}x{height}");
            }
        }
        let enormous = Decomposition::parse("samples:16:1x1").unwrap();
        assert_eq!(enormous.plan_size(2048, 2048, &(0..1 << 24)), PlanSize { pieces: 1 << 42, pixels: 1 << 42 });
    }

    #[test]
    fn the_dearest_comes_first_and_equal_ones_keep_their_order() {
        let plan = Decomposition::parse("tiles:1x1:cost").unwrap().plan(4, 1, &(0..1));
        let columns = |plan: &Plan| plan.pieces().iter().map(|piece| piece.bounds.x0).collect::<Vec<_>>();
        assert_eq!(columns(&plan), [0, 1, 2, 3]);
        assert_eq!(columns(&plan.longest_first(&[1.0, 3.0, 2.0, 3.0])), [1, 3, 2, 0]);
    }

    #[test]
    fn every_listed_example_parses_and_junk_does_not() {
        for entry in DECOMPOSITIONS {
            assert!(Decomposition::parse(entry.example).is_ok() && Decomposition::parse(entry.name).is_ok());
        }
        for junk in [
            "",
            "row",
            "rows:3",
            "bands:0",
            "bands:-1",
            "grid:x",
            "tiles:0x4",
            "tiles:4",
            "tiles:4x4:zigzag",
            "tiles:99999999x1",
            "samples:8",
            "samples:24",
            "samples:16:4",
            "samples:16:32x32:cost",
        ] {
            assert!(Decomposition::parse(junk).is_err(), "{junk}");
        }
    }
}
