//! Sums of no samples, in memory that the allocator has cleared already.

#![expect(unsafe_code, reason = "the allocator's zeros become sums without a pass over them")]

use super::{PixelSum, team};
use std::alloc::{Layout, alloc_zeroed};
use std::hint::black_box;

/// Sums that begin in different pages, if no more than these lie between them. Pages have at least 4096 bytes.
const IN_PAGE: usize = 4096 / size_of::<PixelSum>();
/// Sums that one thread touches at a time: the memory of seven large pages.
const TOUCHED_AT_ONCE: usize = 1 << 18;

/// Empty sums; `None` if the system refuses the memory. Large memory is not touched: the system hands out a page of
/// zeros when something is first written to it.
pub(super) fn sums(count: usize) -> Option<Vec<PixelSum>> {
    if count == 0 {
        return Some(Vec::new());
    }
    let layout = Layout::array::<PixelSum>(count).ok()?;
    // SAFETY: the layout is not empty.
    let first = unsafe { alloc_zeroed(layout) };
    if first.is_null() {
        return None;
    }
    #[cfg(target_os = "linux")]
    ask_for_large_pages(first, layout.size());
    // SAFETY: the global allocator made this memory for so many sums, and bytes of zero are a sum of no samples.
    Some(unsafe { Vec::from_raw_parts(first.cast::<PixelSum>(), count, count) })
}

/// Asks the system for pages of 2 MiB where they fit: one takes the place of 512 small ones, each of which has its own
/// fault and its own entry in the processor's table. A system without them refuses, and nothing changes.
#[cfg(target_os = "linux")]
fn ask_for_large_pages(first: *mut u8, bytes: usize) {
    const LARGE: usize = 1 << 21;
    let before = first.addr().next_multiple_of(LARGE) - first.addr();
    let large = bytes.saturating_sub(before) / LARGE * LARGE;
    if large > 0 {
        // SAFETY: the range lies within the new memory, and the call changes none of its bytes.
        unsafe { libc::madvise(first.add(before).cast(), large, libc::MADV_HUGEPAGE) };
    }
}

/// Makes the system hand out the pages of empty sums now, with up to `threads` threads.
pub(super) fn touch(sums: &mut [PixelSum], threads: usize) {
    let threads = threads.min(sums.len() / TOUCHED_AT_ONCE);
    team::for_each(sums.chunks_mut(TOUCHED_AT_ONCE), threads, |part: &mut [PixelSum]| {
        // The compiler must not know that nothing changes.
        part.iter_mut().step_by(IN_PAGE).for_each(|sum| *black_box(sum) = PixelSum::default());
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_sums_of_nothing() {
        for count in [0, 1, 1000, 300_000] {
            let mut found = sums(count).unwrap();
            touch(&mut found, 2);
            assert_eq!(found, vec![PixelSum::default(); count]);
        }
    }

    #[test]
    fn more_than_any_memory_is_refused() {
        for count in [usize::MAX, isize::MAX as usize / size_of::<PixelSum>()] {
            assert_eq!(sums(count), None);
        }
    }
}
