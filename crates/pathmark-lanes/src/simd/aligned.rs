//! Lists that begin with a cache line: a register as wide as a line is then loaded from one line instead of two.
#![expect(unsafe_code, reason = "lines are looked at as the numbers that were put into them")]

use super::{LINE, Number};
use std::marker::PhantomData;
use std::ops::Deref;
use std::slice::{from_raw_parts, from_raw_parts_mut};

#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([u8; LINE]);

/// A list of numbers whose first one begins a cache line.
pub struct Aligned<T> {
    /// The last one may have room for more numbers.
    lines: Vec<Line>,
    count: usize,
    numbers: PhantomData<T>,
}

impl<T: Number> Aligned<T> {
    const IN_LINE: usize = LINE / size_of::<T>();

    /// An empty list with room for `count` numbers.
    pub fn with_capacity(count: usize) -> Self {
        Self { lines: Vec::with_capacity(count.div_ceil(Self::IN_LINE)), count: 0, numbers: PhantomData }
    }

    pub fn extend(&mut self, numbers: impl IntoIterator<Item = T>) {
        for number in numbers {
            let room = self.lines.len() * Self::IN_LINE;
            if self.count == room {
                self.lines.push(Line([0; LINE]));
            }
            // SAFETY: so many numbers fit in the lines, all of whose bytes are set; any bytes are a number of either format.
            let all =
                unsafe { from_raw_parts_mut(self.lines.as_mut_ptr().cast::<T>(), self.lines.len() * Self::IN_LINE) };
            all[self.count] = number;
            self.count += 1;
        }
    }
}

impl<T: Number> Deref for Aligned<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: no more numbers are counted than the lines have.
        unsafe { from_raw_parts(self.lines.as_ptr().cast::<T>(), self.count) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_begin_with_a_line() {
        for count in [0_u16, 1, 15, 16, 1000, 50_000] {
            // A list grows if its initial room is too small.
            let (mut singles, mut doubles) = (Aligned::with_capacity(100), Aligned::with_capacity(count.into()));
            singles.extend((0..count).map(f32::from));
            doubles.extend((0..count).map(f64::from));
            assert_eq!(singles.as_ptr().cast::<u8>().align_offset(LINE), 0, "{count}");
            assert_eq!(doubles.as_ptr().cast::<u8>().align_offset(LINE), 0, "{count}");
            assert!(singles.iter().copied().eq((0..count).map(f32::from)) && doubles.len() == usize::from(count));
            assert!(doubles.iter().copied().eq((0..count).map(f64::from)));
        }
    }
}
