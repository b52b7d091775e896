//! Damage to inputs: bits, bytes, numbers, words and parts of other files, several at a time. The same seed gives the
//! same inputs.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The largest input in bytes: the search is for mistakes, not for slow inputs.
const LONGEST: usize = 1 << 14;
const BYTES: &[u8] = &[0, 1, 0x7f, 0x80, 0xff, b'\n', b' ', b'"', b',', b'.', b'-', b'0', b'9', b'=', b'[', b']', b'#'];
const INTEGERS: &[u32] =
    &[0, 1, 2, 0x7f, 0x100, 0xffff, 0x1_0000, 0x1_0001, 1 << 24, i32::MAX as u32, 1 << 31, u32::MAX];
const NUMBERS: &[&str] = &[
    "0",
    "-0.0",
    "1",
    "-1",
    "0.5",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "NaN",
    "1e400",
    "1e-400",
    "5e-324",
    "1e100",
    "1e101",
    "-1e100",
    "1e-100",
    "1e308",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "99999999999999999999",
    "16384",
    "65536",
    "65537",
    "1_0",
    "0x10",
    "1.",
    ".5",
    "+1",
    "",
    "1.7976931348623157e308",
    "2147483648",
];

/// An endless source of damaged inputs.
pub(crate) struct Mutator<'a> {
    seeds: &'a [Vec<u8>],
    words: &'a [&'a str],
    random: Pcg64,
}

impl<'a> Mutator<'a> {
    pub(crate) fn new(seeds: &'a [Vec<u8>], words: &'a [&'a str]) -> Self {
        Self { seeds, words, random: Pcg64::seed_from_u64(1) }
    }

    /// A seed with some mutations, mostly few: a reader refuses a file with many mutations for its first.
    pub(crate) fn next(&mut self) -> Vec<u8> {
        let mut bytes = self.seed().to_vec();
        self.mutate(&mut bytes);
        while self.random.random_bool(0.4) {
            self.mutate(&mut bytes);
        }
        bytes.truncate(LONGEST);
        bytes
    }

    fn seed(&mut self) -> &'a [u8] {
        &self.seeds[self.random.random_range(0..self.seeds.len())]
    }

    fn one<T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.random.random_range(0..of.len())]
    }

    /// A position between two bytes.
    fn place(&mut self, bytes: &[u8]) -> usize {
        self.random.random_range(0..=bytes.len())
    }

    /// A range of bytes, mostly a short one.
    fn stretch(&mut self, bytes: &[u8]) -> std::ops::Range<usize> {
        let start = self.place(bytes);
        let most = if self.random.random_bool(0.8) { 16 } else { bytes.len() };
        start..(start + self.random.random_range(0..=most)).min(bytes.len())
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>) {
        let at = self.place(bytes);
        match self.random.random_range(0..12) {
            0 | 1 if at < bytes.len() => bytes[at] ^= 1 << self.random.random_range(0..8),
            2 if at < bytes.len() => bytes[at] = *self.one(BYTES),
            3 => bytes.insert(at, *self.one(BYTES)),
            4 => drop(bytes.drain(self.stretch(bytes))),
            5 => {
                let copy = bytes[self.stretch(bytes)].to_vec();
                bytes.splice(at..at, copy);
            }
            6 => {
                let other = self.seed();
                let part = other[self.stretch(other)].to_vec();
                bytes.splice(at..at, part);
            }
            7 if !self.words.is_empty() => {
                let word = self.one(self.words).bytes();
                bytes.splice(at..at, word);
            }
            8 | 9 => self.other_number(bytes, at),
            10 => {
                let integer = *self.one(INTEGERS);
                let word = if self.random.random_bool(0.7) { integer.to_le_bytes() } else { integer.to_be_bytes() };
                bytes.splice(at..bytes.len().min(at + 4), word);
            }
            _ => self.swap_lines(bytes),
        }
    }

    /// Replaces the next number written in digits by another.
    fn other_number(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let is_digit = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-');
        let Some(start) = bytes[at..].iter().position(is_digit).map(|skipped| at + skipped) else { return };
        let length = bytes[start..].iter().take_while(|byte| is_digit(byte)).count();
        let number = self.one(NUMBERS).bytes();
        bytes.splice(start..start + length, number);
    }

    fn swap_lines(&mut self, bytes: &mut Vec<u8>) {
        let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        if lines.is_empty() {
            return;
        }
        let [a, b] = [0, 1].map(|_| self.random.random_range(0..lines.len()));
        lines.swap(a, b);
        *bytes = lines.concat();
    }
}

#[cfg(test)]
mod tests {
    use super::Mutator;
    use std::collections::HashSet;

    #[test]
    fn inputs_are_many_and_the_same_each_time() {
        let seeds = vec![b"radius = 1.0\n".to_vec(), b"center = [0, 0, 0]\nname = \"a\"\n".to_vec()];
        let inputs = |count| {
            let mut mutator = Mutator::new(&seeds, &["sphere"]);
            (0..count).map(|_| mutator.next()).collect::<Vec<_>>()
        };
        let found = inputs(1000);
        assert_eq!(found, inputs(1000));
        assert!(found.iter().collect::<HashSet<_>>().len() > 800, "mutations that change something");
        assert!(found.iter().any(|input| input.windows(6).any(|word| word == b"sphere")));
    }
}
