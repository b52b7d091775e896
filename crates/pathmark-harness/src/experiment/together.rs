//! Schedules that were measured together: only they can be compared.
//!
//! A repetition is a block of rows that were measured shortly after each other. Parts of a sweep (`run --shard`) have no
//! repetition in common, because each ran on its own, perhaps on another machine. Every part has the serial runs that its
//! cells are compared with.

use super::diff::Times;
use std::collections::{BTreeMap, BTreeSet};

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Timed {
    pub(super) times: Times,
    /// Whether it belongs to each part with which it shares a repetition, and connects none.
    pub(super) is_serial: bool,
    /// Whether its matrix has fewer repetitions than the experiment.
    pub(super) is_shown_only: bool,
}

pub(super) type Schedules = BTreeMap<String, Timed>;

/// Joins all sets of repetitions in which a schedule has times to one set.
fn join(sets: &mut Vec<BTreeSet<u32>>, times: &Times) {
    let mut joined: BTreeSet<u32> = times.keys().map(|(repetition, _)| *repetition).collect();
    sets.retain(|set| {
        let is_apart = set.is_disjoint(&joined);
        if !is_apart {
            joined.extend(set);
        }
        is_apart
    });
    sets.push(joined);
}

/// Divides the schedules of an image into the parts that were measured together, in the order of their first
/// repetitions. A serial schedule is in each part with which it shares a repetition; every other one is in one part.
pub(super) fn parts(schedules: &Schedules) -> Vec<Schedules> {
    let mut sets = Vec::new();
    schedules.values().filter(|own| !own.is_serial).for_each(|own| join(&mut sets, &own.times));
    let is_in = |sets: &[BTreeSet<u32>], repetition: &u32| sets.iter().any(|set| set.contains(repetition));
    let is_alone = |own: &&Timed| own.is_serial && !own.times.keys().any(|(repetition, _)| is_in(&sets, repetition));
    // Serial schedules that were measured with no other are compared with each other.
    let alone: Vec<&Timed> = schedules.values().filter(is_alone).collect();
    for own in alone {
        join(&mut sets, &own.times);
    }
    sets.sort_by_key(|set| set.first().copied());
    let part = |set: &BTreeSet<u32>| {
        let within = |(name, own): (&String, &Timed)| {
            let mut own = own.clone();
            own.times.retain(|(repetition, _), _| set.contains(repetition));
            (!own.times.is_empty()).then(|| (name.clone(), own))
        };
        schedules.iter().filter_map(within).collect()
    };
    sets.iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timed(repetitions: &[u32], is_serial: bool) -> Timed {
        let times = repetitions.iter().map(|at| ((*at, None), 1.0)).collect();
        Timed { times, is_serial, is_shown_only: false }
    }

    fn divided(schedules: &[(&str, &[u32], bool)]) -> Vec<Vec<(String, usize)>> {
        let all = schedules.iter().map(|(name, at, is_serial)| ((*name).to_string(), timed(at, *is_serial))).collect();
        let count = |part: Schedules| part.into_iter().map(|(name, own)| (name, own.times.len())).collect();
        parts(&all).into_iter().map(count).collect()
    }

    fn named(parts: &[&[(&str, usize)]]) -> Vec<Vec<(String, usize)>> {
        parts.iter().map(|part| part.iter().map(|(name, count)| ((*name).to_string(), *count)).collect()).collect()
    }

    /// Two parts of a sweep: repetitions 0, 2 and 4 of the first, 1, 3 and 5 of the second. The serial runs belong to
    /// both.
    #[test]
    fn a_part_has_the_schedules_of_its_repetitions() {
        let found = divided(&[
            ("d", &[1, 3, 5], false),
            ("a", &[0, 2, 4], false),
            ("b", &[0, 2, 4], false),
            ("c", &[1, 5], false),
            ("serial", &[0, 1, 2, 3, 4, 5], true),
        ]);
        assert_eq!(found, named(&[&[("a", 3), ("b", 3), ("serial", 3)], &[("c", 2), ("d", 3), ("serial", 3)]]));
    }

    /// Schedules that share no repetition are together if a third one shares repetitions with both.
    #[test]
    fn schedules_are_together_through_others() {
        let found = divided(&[("a", &[0, 1], false), ("b", &[1, 2], false), ("c", &[2, 3], false), ("d", &[9], false)]);
        assert_eq!(found, named(&[&[("a", 2), ("b", 2), ("c", 2)], &[("d", 1)]]));
    }

    #[test]
    fn serial_schedules_are_compared_with_each_other_where_there_are_no_others() {
        let found = divided(&[("rows", &[0, 1], true), ("tiles", &[0, 1], true)]);
        assert_eq!(found, named(&[&[("rows", 2), ("tiles", 2)]]));
        let found = divided(&[("a", &[0], false), ("rows", &[0, 7], true), ("tiles", &[7, 8], true)]);
        assert_eq!(found, named(&[&[("a", 1), ("rows", 1)], &[("rows", 1), ("tiles", 2)]]));
    }
}
