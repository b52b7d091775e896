//! How many are enough, found by halving.

/// The smallest number above `few` and up to `many` that is enough, if every larger one is enough, too; `None` if `many`
/// is not.
pub(crate) fn smallest(mut few: usize, mut many: usize, is_enough: impl Fn(usize) -> bool) -> Option<usize> {
    if !is_enough(many) {
        return None;
    }
    while many - few > 1 {
        let middle = few.midpoint(many);
        if is_enough(middle) { many = middle } else { few = middle }
    }
    Some(many)
}
