//! Letters for groups: entries of a ranking that share a letter cannot be told apart.

/// The letter of a group: a to z, then aa, ab and so on.
fn letter(group: usize) -> String {
    let last = char::from(b'a' + (group % 26) as u8);
    if group < 26 { last.to_string() } else { format!("{}{last}", letter(group / 26 - 1)) }
}

/// The letters of an entry's groups.
pub(super) fn letters(groups: &[usize]) -> String {
    groups.iter().map(|group| letter(*group)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_has_its_letter() {
        let found: Vec<String> = [0, 1, 25, 26, 27, 51, 52, 701, 702].into_iter().map(letter).collect();
        assert_eq!(found, ["a", "b", "z", "aa", "ab", "az", "ba", "zz", "aaa"]);
        assert_eq!(letters(&[0, 2]), "a c");
    }
}
