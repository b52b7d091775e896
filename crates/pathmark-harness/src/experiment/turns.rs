//! Which runs of adjacent pairs followed each other. Groups of compared cells all count their pairs from 0, so the number
//! of a pair is not enough: two groups of one experiment ran minutes apart.

use crate::analysis::ranking::Turn;
use crate::measure::Record;
use std::borrow::Borrow;

/// The turn of each row: its process, and in pairs a number that only rows share which ran one after another. The pairs
/// of a group follow each other, and the places of a pair are counted from 0. Rows of other programs, which have no
/// places, have the number of their pair.
pub fn turns(records: &[impl Borrow<Record>]) -> Vec<Turn> {
    let records: Vec<&Record> = records.iter().map(Borrow::borrow).collect();
    let mut turns: Vec<Turn> = records.iter().map(|record| (record.repetition, record.pair)).collect();
    let mut order: Vec<usize> = (0..records.len()).filter(|at| records[*at].pair.is_some()).collect();
    if order.iter().any(|at| records[*at].place.is_none()) {
        return turns;
    }
    order.sort_by_key(|at| (records[*at].repetition, records[*at].run_order));
    let mut last: Option<&Record> = None;
    let mut number = 0;
    for at in order {
        let own = records[at];
        let goes_on =
            |last: &Record| (last.repetition, last.pair) == (own.repetition, own.pair) && last.place < own.place;
        number += u32::from(last.is_some_and(|last| !goes_on(last)));
        turns[at].1 = Some(number);
        last = Some(own);
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(repetition: u32, pair: Option<u32>, place: Option<u32>, run_order: u64) -> Record {
        Record { repetition, pair, place, run_order, ..Record::default() }
    }

    /// Two groups of two cells, each with two pairs, in two processes, and a cell that is compared with none.
    #[test]
    fn pairs_of_two_groups_differ() {
        let group = |first: u64, repetition: u32| {
            (0..4).map(move |at| row(repetition, Some((at / 2) as u32), Some((at % 2) as u32), first + at))
        };
        let alone = std::iter::once(row(0, None, None, 4));
        let rows: Vec<Record> =
            group(0, 0).chain(alone).chain(group(5, 0)).chain(group(9, 1)).chain(group(13, 1)).collect();
        let pairs = |rows: &[Record]| turns(rows).into_iter().map(|(_, pair)| pair).collect::<Vec<Option<u32>>>();
        let found = pairs(&rows);
        let expected = [Some(0), Some(0), Some(1), Some(1), None, Some(2), Some(2), Some(3), Some(3)];
        assert_eq!(found[..9], expected);
        assert_eq!(found[9..], [4, 4, 5, 5, 6, 6, 7, 7].map(Some));
        // In whatever order the file has them.
        let backwards: Vec<Record> = rows.into_iter().rev().collect();
        assert_eq!(pairs(&backwards), found.into_iter().rev().collect::<Vec<_>>());
    }

    /// Long runs have one pair in each process, and the next group begins with the same number.
    #[test]
    fn groups_of_one_pair_differ() {
        let rows = [(0, 0), (1, 1), (0, 2), (1, 3), (2, 4)].map(|(place, order)| row(0, Some(0), Some(place), order));
        assert_eq!(turns(&rows), [0, 0, 1, 1, 1].map(|number| (0, Some(number))));
    }

    #[test]
    fn rows_without_places_have_their_pairs() {
        let rows = [row(0, Some(3), None, 0), row(0, Some(4), Some(1), 0)];
        assert_eq!(turns(&rows), [(0, Some(3)), (0, Some(4))]);
    }
}
