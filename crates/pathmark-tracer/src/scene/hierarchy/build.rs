//! From boxes to a tree, whatever the rule by which nodes are split.

use super::{Bounds, Hierarchy, Node, Split};

/// Deeper than this the middle is taken instead of the rule's answer, so that a traversal never needs more than [`DEEPEST`] places.
const UNBALANCED: usize = 32;

/// The deepest level: halving 2^32 primitives after [`UNBALANCED`] levels.
pub(super) const DEEPEST: usize = UNBALANCED + 32;

/// What is still to be built: a node, its range of the sorted primitives, and its depth.
struct Task {
    node: usize,
    first: usize,
    count: usize,
    depth: usize,
}

/// The tree over the primitives that have a box; `None` if none has.
pub(super) fn build(boxes: &[Option<Bounds>], mut rule: impl Split) -> Option<Hierarchy> {
    let bounds: Vec<Bounds> =
        boxes.iter().map(|bounds| bounds.map_or(Bounds::EMPTY, |bounds| bounds.padded())).collect();
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
    let unknown = Node { faces: Bounds::EMPTY.faces(), at: 0, count: 0 };
    let mut nodes = Vec::with_capacity(2 * bounded.len());
    nodes.push(unknown);
    let mut tasks = vec![Task { node: 0, first: 0, count: bounded.len(), depth: 0 }];
    while let Some(Task { node, first, count, depth }) = tasks.pop() {
        let range = first..first + count;
        let own = sorted[0][range.clone()].iter().fold(Bounds::EMPTY, |own, k| own.and(&bounds[*k as usize]));
        let wanted = match count {
            1 => None,
            _ if depth >= UNBALANCED => Some((widest(&own), count / 2)),
            _ => rule.split(&bounds, &own, [0, 1, 2].map(|axis| &sorted[axis][range.clone()])),
        };
        let Some((axis, left)) = wanted else {
            nodes[node] = Node { faces: own.faces(), at: first as u32, count: count as u32 };
            continue;
        };
        for (place, k) in sorted[axis][range.clone()].iter().enumerate() {
            to_first[*k as usize] = place < left;
        }
        for other in (0..3).filter(|other| *other != axis) {
            partition(&mut sorted[other][range.clone()], &to_first, &mut aside);
        }
        let at = nodes.len();
        nodes[node] = Node { faces: own.faces(), at: at as u32, count: 0 };
        nodes.extend([unknown; 2]);
        let depth = depth + 1;
        tasks.push(Task { node: at + 1, first: first + left, count: count - left, depth });
        tasks.push(Task { node: at, first, count: left, depth });
    }
    let [order, ..] = sorted;
    Some(Hierarchy { nodes, order })
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
