//! Films: the image as sums of samples, and its decomposition into pieces.
//!
//! Samples are added along a fixed tree, so no bit depends on who rendered which piece or in which order.

mod assembly;
mod decomposition;
mod image;
mod noise;
mod order;
mod plan;
mod progressive;
mod sample_grid;
mod shard;
mod sum;
mod team;
mod tile_buffer;
mod whole;

pub use assembly::Assembly;
pub use decomposition::{DECOMPOSITIONS, Decomposition, Entry};
pub use image::Image;
pub use noise::{FEWEST_PIXELS, Noise};
pub use order::TileOrder;
pub use plan::{Bounds, Piece, Plan, PlanSize};
pub use progressive::{ProgressiveFilm, Sections, sections};
pub use sample_grid::SampleGrid;
pub use shard::{Shard, ShardCut};
pub use sum::{PixelSum, SAMPLE_BLOCK, SampleSum};
pub use tile_buffer::TileBuffer;
pub use whole::{Film, LARGEST_SIDE, Reserve, check_size, room};
