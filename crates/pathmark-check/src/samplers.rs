//! The samplers of the table, for cases that test all of them.

use crate::sampling::{SAMPLERS, Sampler, keyed_sampler};

/// The samplers whose random numbers depend on the address alone, each with its name.
pub(super) fn keyed() -> impl Iterator<Item = (&'static str, Box<dyn Sampler>)> {
    SAMPLERS.iter().filter_map(|entry| keyed_sampler(entry.name).map(|sampler| (entry.name, sampler)))
}
