//! Repetitions: counts of values that have occurred before.

fn repeats<T: Ord>(mut all: Vec<T>) -> u64 {
    all.sort_unstable();
    all.windows(2).filter(|two| two[0] == two[1]).count() as u64
}

/// Counts the keys, of at most 128 bits, that have occurred before.
pub fn repeated(all: Vec<u128>) -> u64 {
    repeats(all)
}

/// Counts the words of 32 bits that have occurred before.
pub fn repeated_words(all: Vec<u32>) -> u64 {
    repeats(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_counts_but_the_first_of_its_kind() {
        assert_eq!(repeated(vec![3, 1 << 100, 3, 3, 0, 1 << 100]), 3);
        assert_eq!(repeated_words(vec![7, 8, 9]), 0);
        assert_eq!(repeated(Vec::new()), 0);
    }
}
