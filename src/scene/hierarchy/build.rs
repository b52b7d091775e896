//! From boxes to a tree, whatever the rule by which nodes are split.

use super::bounds::Margin;
use super::{Bounds, Hierarchy, Node, Split};

/// Deeper than this the middle is taken instead of the rule's answer, so that a traversal never needs more than [`DEEPEST`] places.
const UNBALANCED: usize = 40;

/// The deepest level: halving 2^32 primitives after [`UNBALANCED`] levels.
pub(super) const DEEPEST: usize = UNBALANCED + 32;

/// So many are split whatever the rule says.
const LARGEST_LEAF: usize = u16::MAX as usize;

/// What is still to be built: a range of the sorted primitives, its depth, and the parent whose second child it is.
struct Task {
    first: usize,
    count: usize,
    depth: usize,
    second_of: Option<usize>,
}

/// The tree over the primitives that have a box; `None` if none has.
pub(super) fn build(boxes: &[Option<Bounds>], mut rule: impl Split) -> Option<Hierarchy> {
    let bounds: Vec<Bounds> = boxes.iter().map(|bounds| bounds.unwrap_or(Bounds::EMPTY)).collect();
    let bounded: Vec<u32> =
        (0u32..).zip(boxes).filter(|(_, bounds)| bounds.is_some()).map(|(index, _)| index).collect();
    if bounded.is_empty() {
        return None;
    }
    // Ties go by number: a total order, so one tree.
    let mut sorted = [0, 1, 2].map(|axis| {
        let mut order: Vec<(f64, u32)> = bounded.iter().map(|&k| (bounds[k as usize].middle(axis), k)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.into_iter().map(|(_, k)| k).collect::<Vec<u32>>()
    });
    let mut to_first = vec![false; bounds.len()];
    let mut aside = Vec::with_capacity(bounded.len());
    let mut nodes = Vec::with_capacity(2 * bounded.len());
    let mut tasks = vec![Task { first: 0, count: bounded.len(), depth: 0, second_of: None }];
    while let Some(Task { first, count, depth, second_of }) = tasks.pop() {
        if let Some(parent) = second_of {
            let at = nodes.len() as u32;
            let parent: &mut Node = &mut nodes[parent];
            parent.at = at;
        }
        let range = first..first + count;
        let node = sorted[0][range.clone()].iter().fold(Bounds::EMPTY, |node, k| node.and(&bounds[*k as usize]));
        let wanted = match count {
            1 => None,
            _ if depth >= UNBALANCED => Some((widest(&node), count / 2)),
            _ => rule.split(&bounds, &node, [0, 1, 2].map(|axis| &sorted[axis][range.clone()])),
        };
        let wanted = if count > LARGEST_LEAF { wanted.or(Some((widest(&node), count / 2))) } else { wanted };
        let Some((axis, left)) = wanted else {
            nodes.push(Node { bounds: node, at: first as u32, count: count as u16, axis: 0 });
            continue;
        };
        for (place, k) in sorted[axis][range.clone()].iter().enumerate() {
            to_first[*k as usize] = place < left;
        }
        for other in (0..3).filter(|other| *other != axis) {
            partition(&mut sorted[other][range.clone()], &to_first, &mut aside);
        }
        let index = nodes.len();
        nodes.push(Node { bounds: node, at: 0, count: 0, axis: axis as u16 });
        let depth = depth + 1;
        tasks.push(Task { first: first + left, count: count - left, depth, second_of: Some(index) });
        tasks.push(Task { first, count: left, depth, second_of: None });
    }
    let margin = Margin::of(&nodes[0].bounds);
    let [order, ..] = sorted;
    Some(Hierarchy { nodes, order, margin })
}

/// Those of the first child to the front; both keep their order.
fn partition(range: &mut [u32], to_first: &[bool], aside: &mut Vec<u32>) {
    aside.clear();
    let mut front = 0;
    for place in 0..range.len() {
        let k = range[place];
        if to_first[k as usize] {
            range[front] = k;
            front += 1;
        } else {
            aside.push(k);
        }
    }
    range[front..].copy_from_slice(aside);
}

/// The axis along which a box is longest.
fn widest(bounds: &Bounds) -> usize {
    let length = |axis: usize| bounds.high[axis] - bounds.low[axis];
    (1..3).fold(0, |widest, axis| if length(axis) > length(widest) { axis } else { widest })
}
