//! The strategies, each in its own file, and their table.

mod adaptive_factoring;
mod awf_b;
mod awf_c;
mod chili;
mod dynamic;
mod factoring;
mod fixed_pool;
#[cfg(feature = "more-pools")]
mod forkunion;
mod guided;
mod mfac;
mod mutex_queue;
#[cfg(feature = "openmp")]
mod openmp;
#[cfg(feature = "openmp")]
mod openmp_dynamic;
#[cfg(feature = "openmp")]
mod openmp_guided;
#[cfg(feature = "openmp")]
mod openmp_static;
#[cfg(feature = "more-pools")]
mod orx_parallel;
mod paralight;
mod range_stealing;
mod rayon;
mod rayon_join;
mod rayon_pool;
mod rayon_scope;
mod serial;
mod shared_counter;
mod static_blocks;
mod static_cyclic;
mod steal_half;
mod steal_one;
mod thread_per_job;
mod trapezoid;
mod weighted_factoring;
mod work_stealing;

use crate::Entry;

pub use static_blocks::block;

/// All strategies, in the order in which they are listed.
pub static STRATEGIES: &[Entry] = &[
    serial::ENTRY,
    thread_per_job::ENTRY,
    static_blocks::ENTRY,
    static_cyclic::ENTRY,
    shared_counter::ENTRY,
    dynamic::ENTRY,
    guided::ENTRY,
    trapezoid::ENTRY,
    factoring::ENTRY,
    mfac::ENTRY,
    weighted_factoring::ENTRY,
    awf_b::ENTRY,
    awf_c::ENTRY,
    adaptive_factoring::ENTRY,
    mutex_queue::ENTRY,
    fixed_pool::ENTRY,
    work_stealing::ENTRY,
    steal_one::ENTRY,
    steal_half::ENTRY,
    rayon::ENTRY,
    rayon_join::ENTRY,
    rayon_scope::ENTRY,
    chili::ENTRY,
    paralight::ENTRY,
    #[cfg(feature = "more-pools")]
    orx_parallel::ENTRY,
    #[cfg(feature = "more-pools")]
    forkunion::ENTRY,
    #[cfg(feature = "openmp")]
    openmp_static::ENTRY,
    #[cfg(feature = "openmp")]
    openmp_dynamic::ENTRY,
    #[cfg(feature = "openmp")]
    openmp_guided::ENTRY,
];

/// The strategies that this build lacks, each with the feature that adds it.
pub static LEFT_OUT: &[(&str, &str)] = &[
    #[cfg(not(feature = "more-pools"))]
    ("orx-parallel", "more-pools"),
    #[cfg(not(feature = "more-pools"))]
    ("forkunion", "more-pools"),
    #[cfg(not(feature = "openmp"))]
    ("openmp-static", "openmp"),
    #[cfg(not(feature = "openmp"))]
    ("openmp-dynamic", "openmp"),
    #[cfg(not(feature = "openmp"))]
    ("openmp-guided", "openmp"),
];

/// Returns the strategy called `name`.
pub fn find(name: &str) -> Option<&'static Entry> {
    STRATEGIES.iter().find(|entry| entry.name == name)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn names_are_unique_and_are_found() {
        let names: HashSet<_> = STRATEGIES.iter().map(|entry| entry.name).collect();
        assert_eq!(names.len(), STRATEGIES.len());
        assert!(STRATEGIES.iter().all(|entry| find(entry.name).is_some_and(|found| found.about == entry.about)));
        assert!(find("no-such-strategy").is_none());
        assert!(LEFT_OUT.iter().all(|(name, _)| find(name).is_none()));
        // Of all features together, a build has a strategy or knows that it lacks it.
        assert_eq!(STRATEGIES.len() + LEFT_OUT.len(), 29);
    }
}
