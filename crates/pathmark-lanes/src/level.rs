//! The choice of an instruction set by name.

use crate::simd::{Entry as LevelEntry, LEVELS, Level};
use pathmark_tracer::error::{InputError, Result};
use pathmark_tracer::kernel::unknown;

/// The instruction set of that name, or the fastest one of this processor.
pub(crate) fn level(wanted: Option<&str>) -> Result<Level> {
    level_among(LEVELS, wanted)
}

fn level_among(levels: &'static [LevelEntry], wanted: Option<&str>) -> Result<Level> {
    let available = || levels.iter().filter_map(LevelEntry::here);
    if let Some(level) = available().find(|level| wanted.is_none_or(|name| level.name() == name)) {
        return Ok(level);
    }
    let name = wanted.unwrap_or_default();
    if levels.iter().any(|level| level.name == name) {
        let allowed: Vec<&str> = available().map(Level::name).collect();
        let error = InputError::new("simd", name, "is not supported by this processor");
        return Err(error.allowed(allowed.join(", ")).into());
    }
    Err(unknown("simd", name, available().map(Level::name)).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If the processor lacks the first instruction set, the next one is chosen. A request for the first is an error
    /// that lists the available ones.
    #[test]
    fn a_level_that_the_processor_lacks_is_refused() {
        let [mut first, last] = [&LEVELS[0], &LEVELS[LEVELS.len() - 1]].map(LevelEntry::clone);
        (first.name, first.is_available) = ("first", || false);
        let table = Box::leak(Box::new([first, last]));
        assert_eq!(level_among(table, None).unwrap().name(), "baseline");
        let error = level_among(table, Some("first")).unwrap_err().to_string();
        assert!(error.contains("first") && error.contains("is not supported by this processor"), "{error}");
        assert!(error.contains("baseline"), "{error}");
        let error = level_among(table, Some("mmx")).unwrap_err().to_string();
        assert!(error.contains("there is none of that name"), "{error}");
    }
}
