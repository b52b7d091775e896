//! Wide trees: the same tree with many children per node, for code that tests as many boxes or primitives at a time
//! (Dammertz, Hanika and Keller, "Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays",
//! 2008).

use pathmark_tracer::scene::{Bounds, Hierarchy, Node};

/// A child of a wide node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Child {
    /// Its bounding box, padding included.
    pub(super) bounds: Bounds,
    pub(super) content: Content,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Content {
    Node(u32),
    /// Consecutive primitives in the order of the leaves: at most as many as a node has children, unless a leaf of the
    /// binary tree holds more.
    Primitives {
        /// The place of the first one.
        first: u32,
        count: u32,
    },
}

/// A tree whose nodes have many children; the first node is the root, and each node comes after its parent.
pub(super) struct CollapsedBvh {
    /// For each node, its first child and the number of its children.
    nodes: Vec<[u32; 2]>,
    children: Vec<Child>,
    /// Primitives in the order of the leaves.
    order: Vec<u32>,
}

impl CollapsedBvh {
    /// Creates the tree whose nodes have at most `width` children, which must be 2 or more; the first node is the root.
    /// Of all such trees over this one, it has the least expected cost. It consumes the binary tree, so that its nodes
    /// are freed before the primitives are laid out anew.
    pub(super) fn of(hierarchy: Hierarchy, width: usize) -> Self {
        let choices = Choices::of(&hierarchy, width);
        let binary = hierarchy.nodes();
        let (mut nodes, mut children) = (vec![[0; 2]], Vec::new());
        let mut waiting = vec![(0, 0)];
        let mut parts = Vec::new();
        while let Some((root, place)) = waiting.pop() {
            let first = children.len();
            parts.push((root, if choices.is_node(root) { choices.width } else { 1 }));
            while let Some((index, count)) = parts.pop() {
                if count > 1 {
                    match choices.to_first(index, count) {
                        Some(to_first) => {
                            let first = binary[index].at as usize;
                            parts.extend([(first + 1, count - to_first), (first, to_first)]);
                        }
                        None => parts.push((index, count - 1)),
                    }
                    continue;
                }
                let content = if choices.is_node(index) {
                    let number = nodes.len();
                    nodes.push([0; 2]);
                    waiting.push((index, number));
                    Content::Node(number as u32)
                } else {
                    primitives(binary, index)
                };
                children.push(Child { bounds: bounds(&binary[index]), content });
            }
            nodes[place] = [first as u32, (children.len() - first) as u32];
        }
        Self { nodes, children, order: hierarchy.into_order() }
    }

    /// Creates a tree from the children of each node and the order of the primitives.
    #[cfg(test)]
    pub(super) fn new(nodes: impl IntoIterator<Item = Vec<Child>>, order: Vec<u32>) -> Self {
        let mut made = Self { nodes: Vec::new(), children: Vec::new(), order };
        for children in nodes {
            made.nodes.push([made.children.len() as u32, children.len() as u32]);
            made.children.extend(children);
        }
        made
    }

    /// The children of each node.
    pub(super) fn nodes(&self) -> impl DoubleEndedIterator<Item = &[Child]> + ExactSizeIterator {
        self.nodes.iter().map(|[first, count]| &self.children[*first as usize..][..*count as usize])
    }

    /// The children of all nodes.
    pub(super) fn children(&self) -> &[Child] {
        &self.children
    }

    /// Returns `count` primitives from place `first` on, in the order of the leaves.
    pub(super) fn primitives(&self, first: u32, count: u32) -> &[u32] {
        &self.order[first as usize..][..count as usize]
    }
}

/// The most children that a node may have.
const MOST_CHILDREN: usize = 16;

/// Expected costs of rays below a node of the binary tree, in visits of the root. Children of a wide node replace that
/// node in the wide tree: its *stand-ins*. Entry k - 1 is the cost with at most k stand-ins, for k below the width. A
/// visit of a leaf costs as much as a visit of a node, once for each group of primitives as large as the width.
type Costs = [f32; MOST_CHILDREN - 1];

/// The choices that make the wide tree of least cost from the binary one. Costs are not kept for each node: they would
/// take four times as much memory.
struct Choices {
    /// For each node, entry 0 is 1 if a single stand-in for it is a wide node. Entry k - 1 says how many of k stand-ins
    /// replace its first child; 0 if fewer than k have the same cost. The last entry, for k = width, is for its
    /// children as a wide node.
    of: Vec<[u8; MOST_CHILDREN]>,
    width: usize,
}

impl Choices {
    /// Chooses from the leaves up, since children come after their parents (Ylitie, Karras and Laine, "Efficient
    /// Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017, find the tree of least cost in this way).
    fn of(hierarchy: &Hierarchy, width: usize) -> Self {
        debug_assert!((2..=MOST_CHILDREN).contains(&width));
        let nodes = hierarchy.nodes();
        let sizes = sizes(nodes);
        let whole = nodes.first().map_or(0.0, |root| bounds(root).half_area());
        let mut choices = Self { of: vec![[0; MOST_CHILDREN]; nodes.len()], width };
        // The costs of the few nodes whose parents are still to come, and each node's place among these costs.
        let (mut costs, mut free): (Vec<Costs>, Vec<u32>) = (Vec::new(), Vec::new());
        let mut place = vec![0_u32; nodes.len()];
        for (index, node) in nodes.iter().enumerate().rev() {
            let area = if whole > 0.0 { (bounds(node).half_area() / whole) as f32 } else { 0.0 };
            let as_leaf = if node.count > 0 || sizes[index] as usize <= width {
                area * (sizes[index] as usize).div_ceil(width) as f32
            } else {
                f32::INFINITY
            };
            let mut own = [as_leaf; MOST_CHILDREN - 1];
            let of = &mut choices.of[index];
            if node.count == 0 {
                let places = [0, 1].map(|child| place[node.at as usize + child]);
                let children = places.map(|place| &costs[place as usize]);
                let (divided, to_first) = least(children, width);
                let as_node = area + divided;
                of[0] = u8::from(as_node <= as_leaf);
                of[width - 1] = to_first;
                own[0] = as_leaf.min(as_node);
                for count in 2..width {
                    let (divided, to_first) = least(children, count);
                    own[count - 1] = own[count - 2].min(divided);
                    of[count - 1] = if own[count - 1] < own[count - 2] { to_first } else { 0 };
                }
                free.extend(places);
            }
            place[index] = free.pop().unwrap_or(costs.len() as u32);
            match costs.get_mut(place[index] as usize) {
                Some(costs) => *costs = own,
                None => costs.push(own),
            }
        }
        choices
    }

    fn is_node(&self, index: usize) -> bool {
        self.of[index][0] == 1
    }

    /// Returns how many of `count` stand-ins for this node replace its first child; `None` if fewer have the same cost.
    fn to_first(&self, index: usize, count: usize) -> Option<usize> {
        Some(usize::from(self.of[index][count - 1])).filter(|count| *count > 0)
    }
}

/// Returns the least cost of two siblings with at most `count` stand-ins together, and how many of those replace the
/// first.
fn least([first, second]: [&Costs; 2], count: usize) -> (f32, u8) {
    let mut least = (f32::INFINITY, 1);
    for to_first in 1..count {
        let cost = first[to_first - 1] + second[count - to_first - 1];
        if cost < least.0 {
            least = (cost, to_first as u8);
        }
    }
    least
}

/// The number of primitives below each node.
fn sizes(nodes: &[Node]) -> Vec<u32> {
    let mut sizes = vec![0; nodes.len()];
    // Children come after their parents.
    for (index, node) in nodes.iter().enumerate().rev() {
        let at = node.at as usize;
        sizes[index] = if node.count == 0 { sizes[at] + sizes[at + 1] } else { node.count };
    }
    sizes
}

fn bounds(node: &Node) -> Bounds {
    let [low, high] = node.faces;
    Bounds { low, high }
}

/// The primitives below a node, which are consecutive in the order of the leaves.
fn primitives(nodes: &[Node], root: usize) -> Content {
    let leaf = |second: usize| {
        let mut node = &nodes[root];
        while node.count == 0 {
            node = &nodes[node.at as usize + second];
        }
        node
    };
    let (first, last) = (leaf(0), leaf(1));
    Content::Primitives { first: first.at, count: last.at + last.count - first.at }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pathmark_tracer::scene::load;

    /// Returns all sets of up to `most` nodes of the binary tree that can stand in for node `index`.
    fn stand_ins(tree: &Hierarchy, index: usize, most: usize) -> Vec<Vec<usize>> {
        let mut all = vec![vec![index]];
        if tree.nodes()[index].count == 0 && most > 1 {
            let first = tree.nodes()[index].at as usize;
            for left in stand_ins(tree, first, most - 1) {
                for right in stand_ins(tree, first + 1, most - left.len()) {
                    all.push([left.clone(), right].concat());
                }
            }
        }
        all
    }

    /// Returns the least cost of a node, found by trying all trees.
    fn least_of_all(tree: &Hierarchy, sizes: &[u32], index: usize, width: usize) -> f64 {
        let area = bounds(&tree.nodes()[index]).half_area();
        let is_leaf = tree.nodes()[index].count > 0;
        let size = sizes[index] as usize;
        let is_whole = is_leaf || size <= width;
        let as_leaf = if is_whole { area * size.div_ceil(width) as f64 } else { f64::INFINITY };
        let children = stand_ins(tree, index, width).into_iter().skip(1);
        let costs =
            children.map(|nodes| nodes.into_iter().map(|node| least_of_all(tree, sizes, node, width)).sum::<f64>());
        as_leaf.min(area + costs.fold(f64::INFINITY, f64::min))
    }

    fn cost(nodes: &[&[Child]], node: u32, area: f64, width: usize) -> f64 {
        let of_child = |child: &Child| {
            let area = child.bounds.half_area();
            match &child.content {
                Content::Node(inner) => cost(nodes, *inner, area, width),
                Content::Primitives { count, .. } => area * (*count as usize).div_ceil(width) as f64,
            }
        };
        area + nodes[node as usize].iter().map(of_child).sum::<f64>()
    }

    /// No other tree over the binary one costs less.
    #[test]
    fn cost_is_the_least_of_all_trees() {
        for (name, width) in [("spheres:9", 2), ("spheres:11", 3), ("spheres:13", 4), ("cornell-tall", 3)] {
            for accelerator in ["median", "sah"] {
                let tree = load(name).unwrap().accelerated(accelerator).unwrap().hierarchy.unwrap();
                let collapsed = CollapsedBvh::of(tree.clone(), width);
                let nodes: Vec<&[Child]> = collapsed.nodes().collect();
                let found = cost(&nodes, 0, bounds(&tree.nodes()[0]).half_area(), width);
                let expected = least_of_all(&tree, &sizes(tree.nodes()), 0, width);
                assert!((found / expected - 1.0).abs() < 1e-5, "{name}, {accelerator}: {found} instead of {expected}");
            }
        }
    }

    /// Every primitive is in exactly one box, all boxes that it is in contain its own, and no node has more than
    /// `width` children.
    #[test]
    fn all_primitives_are_kept() {
        for (name, width) in [("spheres:1000", 16), ("spheres:1000", 4), ("spheres:3", 16), ("cornell-mesh", 8)] {
            let scene = load(name).unwrap();
            let boxes: Vec<Option<Bounds>> = scene.primitives.bounds().collect();
            for accelerator in ["median", "sah"] {
                let hierarchy = scene.accelerated(accelerator).unwrap().hierarchy.unwrap();
                let collapsed = CollapsedBvh::of(hierarchy, width);
                let nodes: Vec<&[Child]> = collapsed.nodes().collect();
                let mut found: Vec<u32> = Vec::new();
                let mut waiting = vec![(0_u32, None)];
                while let Some((node, around)) = waiting.pop() {
                    let node = node as usize;
                    assert!((1..=width).contains(&nodes[node].len()), "{name}: {} children", nodes[node].len());
                    for Child { bounds: own, content } in nodes[node] {
                        assert!(
                            around.is_none_or(|around: Bounds| around.and(own) == around),
                            "{name}: a box sticks out"
                        );
                        match content {
                            Content::Node(inner) => waiting.push((*inner, Some(*own))),
                            Content::Primitives { first, count } => {
                                let primitives = collapsed.primitives(*first, *count);
                                for primitive in primitives {
                                    let inner = boxes[*primitive as usize].unwrap();
                                    assert_eq!(own.and(&inner), *own, "{name}: {primitive} sticks out");
                                }
                                found.extend(primitives);
                            }
                        }
                    }
                }
                found.sort_unstable();
                assert!(found.into_iter().eq(0..boxes.len() as u32), "{name}");
            }
        }
    }
}
