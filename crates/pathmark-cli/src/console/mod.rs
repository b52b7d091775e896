//! The terminal: results, messages and progress, and the end if memory is refused.

pub(crate) mod markdown;
mod out_of_memory;
pub(crate) mod output;
mod progress;

pub use out_of_memory::Allocator;
pub(crate) use out_of_memory::watch as watch_memory;
pub(crate) use progress::Console;
