//! Names: the properties that a name needs so that different items have different names.

use std::collections::HashMap;
use std::hash::Hash;

/// A property of an item, in words.
pub(crate) type Part<T> = fn(&T) -> String;

/// Returns the parts that distinguish items which are equal in `told` and in all earlier parts. `told` is in every name
/// anyway. `word` is the word of a part.
pub(crate) fn needed<T, K: Hash + Eq, P: Copy>(
    things: &[&T],
    told: impl Fn(&T) -> K,
    parts: impl IntoIterator<Item = P>,
    word: impl Fn(P, &T) -> String,
) -> Vec<P> {
    let mut groups = numbered(things.iter().map(|thing| told(thing)));
    let mut count = distinct(&groups);
    let mut needed = Vec::new();
    for part in parts {
        let finer = numbered(things.iter().zip(&groups).map(|(thing, group)| (*group, word(part, thing))));
        let finer_count = distinct(&finer);
        if finer_count > count {
            (groups, count) = (finer, finer_count);
            needed.push(part);
        }
    }
    needed
}

/// The words that are not empty, separated by commas.
pub(crate) fn joined(words: impl IntoIterator<Item = String>) -> String {
    words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ")
}

/// Numbers the keys from 0 in order of appearance; equal keys get equal numbers.
fn numbered<K: Hash + Eq>(keys: impl Iterator<Item = K>) -> Vec<usize> {
    let mut numbers = HashMap::new();
    keys.map(|key| {
        let next = numbers.len();
        *numbers.entry(key).or_insert(next)
    })
    .collect()
}

fn distinct(numbers: &[usize]) -> usize {
    numbers.iter().max().map_or(0, |most| most + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_needed_where_it_alone_tells_rows_apart() {
        let parts: [Part<[&'static str; 3]>; 2] = [|thing| thing[1].to_string(), |thing| thing[2].to_string()];
        let needed_of = |things: &[[&'static str; 3]]| {
            let found = needed(
                &things.iter().collect::<Vec<_>>(),
                |thing| thing[0].to_string(),
                parts,
                |part, thing| part(thing),
            );
            joined(found.iter().map(|part| part(&things[0])))
        };
        assert_eq!(needed_of(&[["a", "x", "1"], ["b", "y", "2"]]), "");
        assert_eq!(needed_of(&[["a", "x", "1"], ["a", "y", "1"]]), "x");
        assert_eq!(needed_of(&[["a", "x", "1"], ["a", "y", "2"]]), "x");
        assert_eq!(needed_of(&[["a", "x", "1"], ["a", "x", "2"], ["b", "y", "1"]]), "1");
        assert_eq!(needed_of(&[["a", "x", "1"], ["a", "y", "1"], ["a", "x", "2"]]), "x, 1");
    }
}
