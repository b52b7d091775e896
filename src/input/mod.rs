//! Reading what users write: TOML with the place of every mistake, and numbers with the range they may have.

mod numbers;
mod toml_text;

pub use numbers::{albedo, direction, length, point, positive, radiance, refractive_index};
pub use toml_text::{locate, locate_in, parse, read_text, read_text_up_to};
