//! The samplers of the table, for cases that try all of them.

use crate::sampling::{SAMPLERS, Sampler, SamplerVisitor, with_keyed_sampler};

struct Boxed;

impl SamplerVisitor for Boxed {
    type Output = Box<dyn Sampler>;
    fn visit<S: Sampler + 'static>(self, sampler: S) -> Box<dyn Sampler> {
        Box::new(sampler)
    }
}

/// Those whose numbers depend on the address alone, each with its name.
pub(super) fn keyed() -> impl Iterator<Item = (&'static str, Box<dyn Sampler>)> {
    SAMPLERS.iter().filter_map(|entry| with_keyed_sampler(entry.name, Boxed).map(|sampler| (entry.name, sampler)))
}
