//! Construction of a tree from boxes, with any rule for splitting nodes.
//!
//! The rule divides a node of many primitives without sorting them; its two halves are built in parallel. A node of few
//! primitives is a part: its primitives are sorted, and as many threads as there are processors build the parts. No
//! thread depends on another one's results, so the tree is the same for any number of threads.

use super::bounds::Faces;
use super::sorted::{UNBALANCED, UNKNOWN, sorted};
use super::{Bounds, Hierarchy, Item, Node, Split};
use std::collections::BTreeMap;
use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, available_parallelism, scope};

/// The deepest level: halving 2^32 primitives after `UNBALANCED` levels.
pub const DEEPEST: usize = UNBALANCED + 32;

/// The most primitives of a node that are sorted, with every place between two of them tried. For a million triangles,
/// the tree whose larger nodes are divided by bins costs within a few percent of the fully sorted tree.
const SORTED: usize = 4096;

/// Primitives from which a node is to be built.
struct Task<'a> {
    own: &'a mut [Item],
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

/// Builds the tree over primitives; `None` if there are none.
pub(super) fn build(items: Vec<Item>, rule: &impl Split) -> Option<Hierarchy> {
    let threads = if items.len() > SORTED { available_parallelism().map_or(1, std::num::NonZero::get) } else { 1 };
    build_with(items, rule, SORTED, threads)
}

fn build_with(mut items: Vec<Item>, rule: &impl Split, most: usize, threads: usize) -> Option<Hierarchy> {
    if items.is_empty() {
        return None;
    }
    let count = items.len();
    let (top, tasks) = divided(Task { own: &mut items, first: 0, depth: 0 }, rule, most, threads);
    let mut nodes = nodes(Assembly::of(top, count), tasks, rule, threads);
    nodes.shrink_to_fit();
    Some(Hierarchy { nodes, order: items.into_iter().map(|item| item.number).collect() })
}

/// Divides nodes until they have at most `most` primitives or the rule needs them sorted.
fn divided<'a>(task: Task<'a>, rule: &impl Split, most: usize, threads: usize) -> (Top, Vec<Task<'a>>) {
    let Task { own, first, depth } = task;
    if own.len() <= most || depth >= UNBALANCED {
        return (Top::Part, vec![Task { own, first, depth }]);
    }
    let (mut whole, mut middles) = (Bounds::EMPTY, Bounds::EMPTY);
    for Item { bounds, .. } in own.iter() {
        let middle = [0, 1, 2].map(|axis| bounds.middle(axis));
        whole = whole.and(bounds);
        middles = middles.and(&Bounds { low: middle, high: middle });
    }
    let Some(left) = rule.divide(&whole, &middles, own) else {
        return (Top::Part, vec![Task { own, first, depth }]);
    };
    let faces = whole.faces();
    let (own, others) = own.split_at_mut(left);
    let half = |own, first, threads| divided(Task { own, first, depth: depth + 1 }, rule, most, threads);
    let ((a, mut tasks), (b, more)) =
        both(threads, || half(own, first, threads.div_ceil(2)), || half(others, first + left, threads / 2));
    tasks.extend(more);
    (Top::Inner { faces, children: Box::new([a, b]) }, tasks)
}

/// Runs both functions, on two threads if `threads` is at least 2 and the system provides one.
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

/// Returns all nodes, built by `threads` threads. A part enters the list as soon as those before it are there, so that
/// few parts wait.
fn nodes<S: Split>(assembly: Assembly, tasks: Vec<Task<'_>>, rule: &S, threads: usize) -> Vec<Node> {
    let count = tasks.len();
    let waiting = Mutex::new(tasks.into_iter().enumerate());
    let assembly = Mutex::new(assembly);
    let work = || {
        let mut rule = rule.clone();
        loop {
            let next = waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((number, Task { own, first, depth })) = next else { return };
            let part = sorted(own, first, depth, &mut rule);
            assembly.lock().unwrap_or_else(PoisonError::into_inner).take(number, part);
        }
    };
    scope(|scope| {
        // If the system provides no thread, this one builds the remaining parts.
        for _ in 1..threads.min(count) {
            if Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
    assembly.into_inner().unwrap_or_else(PoisonError::into_inner).nodes
}

/// The list of nodes while it is assembled.
struct Assembly {
    nodes: Vec<Node>,
    /// The subtrees that are not in it yet, last one first, with the places of their roots.
    rest: Vec<(Top, usize)>,
    /// The number of the next part, and the finished parts behind it.
    next: usize,
    done: BTreeMap<usize, Vec<Node>>,
}

impl Assembly {
    /// Creates an empty list for that many primitives.
    fn of(top: Top, primitives: usize) -> Self {
        let mut nodes = Vec::with_capacity(2 * primitives);
        nodes.push(UNKNOWN);
        Self { nodes, rest: vec![(top, 0)], next: 0, done: BTreeMap::new() }
    }

    /// Takes the part of that number, and adds every part whose turn it is. A root already has a place in the list; the
    /// nodes below it are appended.
    fn take(&mut self, number: usize, part: Vec<Node>) {
        self.done.insert(number, part);
        while let Some((top, place)) = self.rest.pop() {
            match top {
                Top::Inner { faces, children } => {
                    let at = self.nodes.len();
                    self.nodes[place] = Node { faces, at: at as u32, count: 0 };
                    self.nodes.extend([UNKNOWN; 2]);
                    let [a, b] = *children;
                    self.rest.extend([(b, at + 1), (a, at)]);
                }
                Top::Part => {
                    let Some(part) = self.done.remove(&self.next) else {
                        self.rest.push((Top::Part, place));
                        return;
                    };
                    self.next += 1;
                    // A part numbers its nodes from its root, which is not among the appended ones.
                    let offset = self.nodes.len() as u32 - 1;
                    let moved =
                        |node: Node| Node { at: if node.count == 0 { node.at + offset } else { node.at }, ..node };
                    let mut own = part.into_iter().map(moved);
                    self.nodes[place] = own.next().unwrap_or(UNKNOWN);
                    self.nodes.extend(own);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::median::Median;
    use super::super::sah::Sah;
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Mcg;

    /// Returns boxes in a cube, some with the same centre, most of them in one corner; some primitives have no box.
    fn items(count: u32) -> Vec<Item> {
        let mut numbers = Pcg64Mcg::new(7);
        let mut unit = || (numbers.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let mut one = |index: u32| {
            if index % 100 == 3 {
                return None;
            }
            let middle = [0, 1, 2].map(|_| if index.is_multiple_of(7) { 0.25 } else { unit() * unit() * unit() });
            let size = 1e-3 * unit();
            let bounds = Bounds { low: middle.map(|x| x - size), high: middle.map(|x| x + size) };
            Some(Item { bounds: bounds.padded(), number: index })
        };
        (0..count).filter_map(&mut one).collect()
    }

    /// Returns the expected cost of a search: the sum of the nodes' surfaces, for leaves times their primitives,
    /// divided by the root's surface.
    fn cost(tree: &Hierarchy) -> f64 {
        let area = |node: &Node| Bounds { low: node.faces[0], high: node.faces[1] }.half_area();
        let of = |node: &Node| area(node) * f64::from(node.count.max(1));
        tree.nodes.iter().map(of).sum::<f64>() / area(&tree.nodes[0])
    }

    /// Halving gives the same tree with and without sorting.
    #[test]
    fn dividing_at_the_median_is_sorting() {
        let items = items(3000);
        let sorted = build_with(items.clone(), &Median, usize::MAX, 1).unwrap();
        for most in [1, 2, 10, 700] {
            assert!(build_with(items.clone(), &Median, most, 2).unwrap() == sorted, "{most}");
        }
    }

    #[test]
    fn threads_do_not_change_the_tree() {
        let items = items(20_000);
        let alone = build_with(items.clone(), &Sah::new(), 500, 1).unwrap();
        for threads in [2, 3, 8] {
            assert!(build_with(items.clone(), &Sah::new(), 500, threads).unwrap() == alone, "{threads} threads");
        }
        let mut order = alone.order.clone();
        order.sort_unstable();
        let bounded: Vec<u32> = (0..20_000).filter(|index| index % 100 != 3).collect();
        assert_eq!(order, bounded);
        let leaves = alone.nodes.iter().filter(|node| node.count > 0);
        assert_eq!(leaves.map(|node| node.count as usize).sum::<usize>(), bounded.len());
    }

    /// Bins try 31 places on each axis; sorting tries all.
    #[test]
    fn dividing_by_bins_costs_little() {
        let items = items(20_000);
        let tree = |most| build_with(items.clone(), &Sah::new(), most, 2).unwrap();
        let ratio = cost(&tree(500)) / cost(&tree(usize::MAX));
        println!("cost of the tree by bins over that by sorting: {ratio:.4}");
        assert!((0.9..1.05).contains(&ratio), "{ratio}");
    }

    /// If all centres coincide, no rule can separate the boxes, and the tree still holds all of them.
    #[test]
    fn boxes_in_one_place_are_all_kept() {
        let bounds = Bounds { low: [0.0; 3], high: [1.0; 3] };
        let same: Vec<Item> = (0..5000).map(|number| Item { bounds, number }).collect();
        for tree in [build_with(same.clone(), &Sah::new(), 100, 2), build_with(same.clone(), &Median, 100, 2)] {
            let tree = tree.unwrap();
            assert_eq!(tree.order.len(), 5000);
            assert!(tree.depth() <= DEEPEST);
        }
        assert!(build_with(Vec::new(), &Median, 1, 2).is_none());
    }
}
