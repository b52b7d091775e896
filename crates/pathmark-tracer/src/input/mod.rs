//! The user's input: TOML text with the position of every mistake, and numbers with their allowed ranges.

mod numbers;
mod text;
mod toml_text;

pub use numbers::{
    albedo, array, coordinate_limit, degrees, direction, field_of_view, length, optional_array, out_of_range, point,
    positive, radiance, refractive_index, roughness, share,
};
pub use text::{BYTE_ORDER_MARK, Limits, Text, open_text, read_text, read_text_up_to, unreadable};
pub use toml_text::parse_within;
pub use toml_text::{line_and_column, locate, locate_in, parse};
