//! Construction of the nodes over few primitives, which are sorted once along each axis.

use super::{Bounds, Item, Node, Split};

/// From this level on, nodes are split in the middle instead of by the rule, so that a traversal never needs more than
/// [`DEEPEST`](super::DEEPEST) places.
pub(super) const UNBALANCED: usize = 32;

/// A node that is not yet known; it reserves a place in the list.
pub(super) const UNKNOWN: Node = Node { faces: Bounds::EMPTY.faces(), at: 0, count: 0 };

/// A node that is still to be built: its index, its range of the sorted primitives, and its depth.
struct Task {
    node: usize,
    first: usize,
    count: usize,
    depth: usize,
}

/// Builds the nodes over these primitives, the root first. Places in the order of the leaves start at `first_place`.
/// The primitives are put into that order.
pub(super) fn sorted(own: &mut [Item], first_place: usize, depth: usize, rule: &mut impl Split) -> Vec<Node> {
    own.sort_unstable_by_key(|item| item.number);
    let numbers: Vec<u32> = own.iter().map(|item| item.number).collect();
    let bounds: Vec<Bounds> = own.iter().map(|item| item.bounds).collect();
    // Ties are broken by number: a total order gives a unique tree.
    let mut sorted = [0, 1, 2].map(|axis| {
        let mut order: Vec<(f64, u32)> = (0..).zip(&bounds).map(|(k, bounds)| (bounds.middle(axis), k)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.into_iter().map(|(_, k)| k).collect::<Vec<u32>>()
    });
    let mut to_first = vec![false; bounds.len()];
    let mut aside = Vec::with_capacity(bounds.len());
    let mut nodes = Vec::with_capacity(2 * bounds.len());
    nodes.push(UNKNOWN);
    let mut tasks = vec![Task { node: 0, first: 0, count: bounds.len(), depth }];
    while let Some(Task { node, first, count, depth }) = tasks.pop() {
        let range = first..first + count;
        let own = sorted[0][range.clone()].iter().fold(Bounds::EMPTY, |own, k| own.and(&bounds[*k as usize]));
        let wanted = match count {
            1 => None,
            _ if depth >= UNBALANCED => Some((widest(&own), count / 2)),
            _ => rule.split(&bounds, &own, [0, 1, 2].map(|axis| &sorted[axis][range.clone()])),
        };
        let Some((axis, left)) = wanted else {
            nodes[node] = Node { faces: own.faces(), at: (first_place + first) as u32, count: count as u32 };
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
        nodes.extend([UNKNOWN; 2]);
        let depth = depth + 1;
        tasks.push(Task { node: at + 1, first: first + left, count: count - left, depth });
        tasks.push(Task { node: at, first, count: left, depth });
    }
    for (item, k) in own.iter_mut().zip(&sorted[0]) {
        *item = Item { bounds: bounds[*k as usize], number: numbers[*k as usize] };
    }
    nodes
}

/// Moves the primitives of the first child to the front; the primitives of both children keep their order.
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

/// Returns the longest axis of a box.
fn widest(bounds: &Bounds) -> usize {
    let length = |axis: usize| bounds.high[axis] - bounds.low[axis];
    (1..3).fold(0, |widest, axis| if length(axis) > length(widest) { axis } else { widest })
}
