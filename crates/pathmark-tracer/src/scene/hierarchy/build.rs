//! From boxes to a tree, whatever the rule by which nodes are split.
//!
//! A node of many primitives is divided by what the rule sees without sorting them, its two halves side by side. A node of few is a part: its
//! primitives are sorted, and parts are built by as many threads as there are processors. No thread sees what another one does, so the tree is the
//! same for any number of them.

use super::bounds::Faces;
use super::sorted::sorted;
use super::{Bounds, Hierarchy, Node, Split};
use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, available_parallelism, scope};

/// Deeper than this the middle is taken instead of the rule's answer, so that a traversal never needs more than [`DEEPEST`] places.
pub(super) const UNBALANCED: usize = 32;

/// The deepest level: halving 2^32 primitives after [`UNBALANCED`] levels.
pub(crate) const DEEPEST: usize = UNBALANCED + 32;

/// Up to so many primitives of a node are sorted and every place between two of them tried. Of a million triangles the tree that is divided by bins
/// above that has within a few percent the cost of the one that is sorted throughout.
const SORTED: usize = 4096;

/// A node whose place in the list is taken, and which is not yet known.
pub(super) const UNKNOWN: Node = Node { faces: Bounds::EMPTY.faces(), at: 0, count: 0 };

/// Primitives of which a node is to be built.
struct Task<'a> {
    own: &'a mut [u32],
    /// The first one's place in the order of the leaves.
    first: usize,
    depth: usize,
}

/// The tree above the parts.
enum Top {
    Inner {
        faces: Faces,
        children: Box<[Top; 2]>,
    },
    /// The next part, in the order of the leaves.
    Part,
}

/// The tree over the primitives that have a box; `None` if none has.
pub(super) fn build(boxes: Vec<Option<Bounds>>, rule: &impl Split) -> Option<Hierarchy> {
    let threads = if boxes.len() > SORTED { available_parallelism().map_or(1, std::num::NonZero::get) } else { 1 };
    build_with(boxes, rule, SORTED, threads)
}

fn build_with(boxes: Vec<Option<Bounds>>, rule: &impl Split, most: usize, threads: usize) -> Option<Hierarchy> {
    let mut order: Vec<u32> =
        (0u32..).zip(&boxes).filter(|(_, bounds)| bounds.is_some()).map(|(index, _)| index).collect();
    let bounds: Vec<Bounds> =
        boxes.into_iter().map(|bounds| bounds.map_or(Bounds::EMPTY, |bounds| bounds.padded())).collect();
    if order.is_empty() {
        return None;
    }
    let (top, tasks) = divided(&bounds, Task { own: &mut order, first: 0, depth: 0 }, rule, most, threads);
    let parts = parts(&bounds, tasks, rule, threads);
    let mut nodes = Vec::with_capacity(2 * parts.len() + parts.iter().map(Vec::len).sum::<usize>());
    nodes.push(UNKNOWN);
    assemble(top, &mut parts.into_iter(), &mut nodes, 0);
    Some(Hierarchy { nodes, order })
}

/// Divides nodes until they have `most` primitives or the rule needs them sorted.
fn divided<'a>(
    bounds: &[Bounds],
    task: Task<'a>,
    rule: &impl Split,
    most: usize,
    threads: usize,
) -> (Top, Vec<Task<'a>>) {
    let Task { own, first, depth } = task;
    if own.len() <= most || depth >= UNBALANCED {
        return (Top::Part, vec![Task { own, first, depth }]);
    }
    let whole = own.iter().fold(Bounds::EMPTY, |whole, k| whole.and(&bounds[*k as usize]));
    let Some(left) = rule.divide(bounds, &whole, own) else {
        return (Top::Part, vec![Task { own, first, depth }]);
    };
    let faces = whole.faces();
    let (own, others) = own.split_at_mut(left);
    let half = |own, first, threads| divided(bounds, Task { own, first, depth: depth + 1 }, rule, most, threads);
    let ((a, mut tasks), (b, more)) =
        both(threads, || half(own, first, threads.div_ceil(2)), || half(others, first + left, threads / 2));
    tasks.extend(more);
    (Top::Inner { faces, children: Box::new([a, b]) }, tasks)
}

/// Does both, on two threads if there are to be several and the system gives one.
fn both<A: Send, B>(threads: usize, first: impl FnOnce() -> A + Send, second: impl FnOnce() -> B) -> (A, B) {
    if threads < 2 {
        return (first(), second());
    }
    let waiting = Mutex::new(Some(first));
    let run = || waiting.lock().unwrap_or_else(PoisonError::into_inner).take().map(|first| first());
    scope(|scope| {
        let other = Builder::new().spawn_scoped(scope, run).ok();
        let second = second();
        let first = other.map_or_else(run, |other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        (first.expect("nobody else has done it"), second)
    })
}

/// The nodes of each task, in the order of the tasks, by so many threads.
fn parts<S: Split>(bounds: &[Bounds], tasks: Vec<Task<'_>>, rule: &S, threads: usize) -> Vec<Vec<Node>> {
    let count = tasks.len();
    let waiting = Mutex::new(tasks.into_iter().enumerate());
    let work = || {
        let (mut rule, mut done) = (rule.clone(), Vec::new());
        loop {
            let next = waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((number, Task { own, first, depth })) = next else { return done };
            done.push((number, sorted(bounds, own, first, depth, &mut rule)));
        }
    };
    let mut done = scope(|scope| {
        let others: Vec<_> =
            (1..threads.min(count)).map_while(|_| Builder::new().spawn_scoped(scope, work).ok()).collect();
        let mut done = work();
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        done
    });
    done.sort_unstable_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, nodes)| nodes).collect()
}

/// Puts a tree into the list: its root in a place that is there, what is below it behind the others.
fn assemble(top: Top, parts: &mut impl Iterator<Item = Vec<Node>>, nodes: &mut Vec<Node>, place: usize) {
    match top {
        Top::Inner { faces, children } => {
            let at = nodes.len();
            nodes[place] = Node { faces, at: at as u32, count: 0 };
            nodes.extend([UNKNOWN; 2]);
            let [a, b] = *children;
            assemble(a, parts, nodes, at);
            assemble(b, parts, nodes, at + 1);
        }
        Top::Part => {
            // A part counts its nodes from its root, which is not among those that follow.
            let offset = nodes.len() as u32 - 1;
            let moved = |node: Node| Node { at: if node.count == 0 { node.at + offset } else { node.at }, ..node };
            let mut own = parts.next().into_iter().flatten().map(moved);
            nodes[place] = own.next().unwrap_or(UNKNOWN);
            nodes.extend(own);
        }
    }
}

/// Those for which it holds to the front, where all keep their order; gives their number.
pub(super) fn to_front(own: &mut [u32], is_first: impl Fn(u32) -> bool) -> usize {
    let (mut front, mut aside) = (0, Vec::new());
    for place in 0..own.len() {
        let k = own[place];
        if is_first(k) {
            own[front] = k;
            front += 1;
        } else {
            aside.push(k);
        }
    }
    own[front..].copy_from_slice(&aside);
    front
}

#[cfg(test)]
mod tests {
    use super::super::median::Median;
    use super::super::sah::Sah;
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Mcg;

    /// Boxes in a cube, some of them alike, most of them in one corner, and some primitives without one.
    fn boxes(count: u32) -> Vec<Option<Bounds>> {
        let mut numbers = Pcg64Mcg::new(7);
        let mut unit = || (numbers.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let mut one = |index: u32| {
            if index % 100 == 3 {
                return None;
            }
            let middle = [0, 1, 2].map(|_| if index.is_multiple_of(7) { 0.25 } else { unit() * unit() * unit() });
            let size = 1e-3 * unit();
            Some(Bounds { low: middle.map(|x| x - size), high: middle.map(|x| x + size) })
        };
        (0..count).map(&mut one).collect()
    }

    /// The expected cost of a search: the surfaces of nodes, and of leaves times their primitives, over that of the root.
    fn cost(tree: &Hierarchy) -> f64 {
        let area = |node: &Node| Bounds { low: node.faces[0], high: node.faces[1] }.half_area();
        let of = |node: &Node| area(node) * f64::from(node.count.max(1));
        tree.nodes.iter().map(of).sum::<f64>() / area(&tree.nodes[0])
    }

    /// Halves are the same whether they are found by sorting or not.
    #[test]
    fn dividing_at_the_median_is_sorting() {
        let boxes = boxes(3000);
        let sorted = build_with(boxes.clone(), &Median, usize::MAX, 1).unwrap();
        for most in [1, 2, 10, 700] {
            assert!(build_with(boxes.clone(), &Median, most, 2).unwrap() == sorted, "{most}");
        }
    }

    #[test]
    fn threads_do_not_change_the_tree() {
        let boxes = boxes(20_000);
        let alone = build_with(boxes.clone(), &Sah::new(), 500, 1).unwrap();
        for threads in [2, 3, 8] {
            assert!(build_with(boxes.clone(), &Sah::new(), 500, threads).unwrap() == alone, "{threads} threads");
        }
        let mut order = alone.order.clone();
        order.sort_unstable();
        let bounded: Vec<u32> = (0..20_000).filter(|index| index % 100 != 3).collect();
        assert_eq!(order, bounded);
        let leaves = alone.nodes.iter().filter(|node| node.count > 0);
        assert_eq!(leaves.map(|node| node.count as usize).sum::<usize>(), bounded.len());
    }

    /// Bins see 31 places on each axis where sorting sees them all.
    #[test]
    fn dividing_by_bins_costs_little() {
        let boxes = boxes(20_000);
        let tree = |most| build_with(boxes.clone(), &Sah::new(), most, 2).unwrap();
        let ratio = cost(&tree(500)) / cost(&tree(usize::MAX));
        println!("cost of the tree by bins over that by sorting: {ratio:.4}");
        assert!((0.9..1.05).contains(&ratio), "{ratio}");
    }

    /// Where all middles are one, nothing can be told apart, and the tree still holds everything.
    #[test]
    fn boxes_in_one_place_are_all_kept() {
        let same = vec![Some(Bounds { low: [0.0; 3], high: [1.0; 3] }); 5000];
        for tree in [build_with(same.clone(), &Sah::new(), 100, 2), build_with(same.clone(), &Median, 100, 2)] {
            let tree = tree.unwrap();
            assert_eq!(tree.order.len(), 5000);
            assert!(tree.depth() <= DEEPEST);
        }
        assert!(build_with(vec![None, None], &Median, 1, 2).is_none());
    }
}
