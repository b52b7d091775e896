//! The same tree with many children a node, for those who test as many boxes or primitives at a time (Dammertz, Hanika and Keller, "Shallow
//! Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", 2008).

use super::{Bounds, Hierarchy};

/// A child of a node with many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Child {
    /// Its box, with its padding.
    pub bounds: Bounds,
    /// What is in it.
    pub content: Content,
}

/// What is in a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content {
    /// A node by its number.
    Node(u32),
    /// Primitives by their places in the order of the leaves, from one on: no more than a node has children, unless the tree keeps more together.
    Primitives {
        /// The first.
        first: u32,
        /// How many.
        count: u32,
    },
}

/// A tree whose nodes have many children; the first node is the root, and each stands behind its parent.
pub struct Gathered {
    /// Of each node the first of its children, and how many it has.
    nodes: Vec<[u32; 2]>,
    children: Vec<Child>,
    /// Primitives in the order of the leaves.
    order: Vec<u32>,
}

impl Gathered {
    /// A tree of nodes with these children over primitives in that order.
    #[cfg(test)]
    pub(crate) fn new(nodes: impl IntoIterator<Item = Vec<Child>>, order: Vec<u32>) -> Self {
        let mut made = Self { nodes: Vec::new(), children: Vec::new(), order };
        for children in nodes {
            made.nodes.push([made.children.len() as u32, children.len() as u32]);
            made.children.extend(children);
        }
        made
    }

    /// The children of each node.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = &[Child]> + ExactSizeIterator {
        self.nodes.iter().map(|[first, count]| &self.children[*first as usize..][..*count as usize])
    }

    /// The children of all nodes.
    pub fn children(&self) -> &[Child] {
        &self.children
    }

    /// The primitives in these places.
    pub fn primitives(&self, first: u32, count: u32) -> &[u32] {
        &self.order[first as usize..][..count as usize]
    }
}

/// The most children that a node may have.
const MOST_CHILDREN: usize = 16;

/// What rays are expected to cost below a node of the binary tree, in looks at the root, when one, two and so on up to one less than the width of a
/// node stand for it, at most. A look at a leaf costs as much as one at a node, for each time that it has as many primitives as a node has children.
type Costs = [f32; MOST_CHILDREN - 1];

/// How the tree of least cost is made of the binary one. Only the choices are kept for each node: costs would take four times as much memory.
struct Choices {
    /// Of each node: at 0 whether it is a wide node itself where one stands for it, and at k - 1, where k stand for it, how many of them stand for its
    /// first child: 0 if fewer than k stand for it at the same cost. The last place is that of the node as a wide one.
    of: Vec<[u8; MOST_CHILDREN]>,
    width: usize,
}

impl Choices {
    /// From the leaves up, since children stand behind their parents (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs
    /// Through Compressed Wide BVHs", 2017, who find the tree of least cost in this way).
    fn of(hierarchy: &Hierarchy, width: usize) -> Self {
        debug_assert!((2..=MOST_CHILDREN).contains(&width));
        let nodes = &hierarchy.nodes;
        let sizes = hierarchy.sizes();
        let whole = hierarchy.bounds(0).half_area();
        let mut choices = Self { of: vec![[0; MOST_CHILDREN]; nodes.len()], width };
        // Costs of nodes whose parents are still to come, which are few, and where those of each node are.
        let (mut costs, mut free): (Vec<Costs>, Vec<u32>) = (Vec::new(), Vec::new());
        let mut place = vec![0_u32; nodes.len()];
        for (index, node) in nodes.iter().enumerate().rev() {
            let area = if whole > 0.0 { (hierarchy.bounds(index).half_area() / whole) as f32 } else { 0.0 };
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

    /// How many of so many nodes that stand for this one stand for its first child; `None` if fewer nodes do as well.
    fn to_first(&self, index: usize, count: usize) -> Option<usize> {
        Some(usize::from(self.of[index][count - 1])).filter(|count| *count > 0)
    }
}

/// The least cost of two siblings for which so many nodes stand at most, and how many of those stand for the first.
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

impl Hierarchy {
    /// Nodes of at most `width` children, which must be 2 or more; the first is the root. Of all such trees over this one it is the one that rays are
    /// expected to go through at the least cost. Nobody needs the binary one any more, so its nodes are gone before the primitives are laid out anew.
    pub fn gathered(self, width: usize) -> Gathered {
        let choices = Choices::of(&self, width);
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
                            let first = self.nodes[index].at as usize;
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
                    self.primitives(index)
                };
                children.push(Child { bounds: self.bounds(index), content });
            }
            nodes[place] = [first as u32, (children.len() - first) as u32];
        }
        Gathered { nodes, children, order: self.order }
    }

    /// The primitives below each node.
    fn sizes(&self) -> Vec<u32> {
        let mut sizes = vec![0; self.nodes.len()];
        // Children stand behind their parents.
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let at = node.at as usize;
            sizes[index] = if node.count == 0 { sizes[at] + sizes[at + 1] } else { node.count };
        }
        sizes
    }

    fn bounds(&self, index: usize) -> Bounds {
        let [low, high] = self.nodes[index].faces;
        Bounds { low, high }
    }

    /// Those below a node, which stand side by side in the order of the leaves.
    fn primitives(&self, root: usize) -> Content {
        let leaf = |second: usize| {
            let mut node = &self.nodes[root];
            while node.count == 0 {
                node = &self.nodes[node.at as usize + second];
            }
            node
        };
        let (first, last) = (leaf(0), leaf(1));
        Content::Primitives { first: first.at, count: last.at + last.count - first.at }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    /// All ways to have up to `most` nodes of the binary tree stand for one of them.
    fn stand_ins(tree: &Hierarchy, index: usize, most: usize) -> Vec<Vec<usize>> {
        let mut all = vec![vec![index]];
        if tree.nodes[index].count == 0 && most > 1 {
            let first = tree.nodes[index].at as usize;
            for left in stand_ins(tree, first, most - 1) {
                for right in stand_ins(tree, first + 1, most - left.len()) {
                    all.push([left.clone(), right].concat());
                }
            }
        }
        all
    }

    /// The least cost of a node by trying all trees.
    fn least_of_all(tree: &Hierarchy, sizes: &[u32], index: usize, width: usize) -> f64 {
        let area = tree.bounds(index).half_area();
        let is_leaf = tree.nodes[index].count > 0;
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
                let gathered = tree.clone().gathered(width);
                let nodes: Vec<&[Child]> = gathered.nodes().collect();
                let found = cost(&nodes, 0, tree.bounds(0).half_area(), width);
                let expected = least_of_all(&tree, &tree.sizes(), 0, width);
                assert!((found / expected - 1.0).abs() < 1e-5, "{name}, {accelerator}: {found} instead of {expected}");
            }
        }
    }

    /// Every primitive is in exactly one box, its own box in all that it is in, and no node is wider than asked for.
    #[test]
    fn all_primitives_are_kept() {
        for (name, width) in [("spheres:1000", 16), ("spheres:1000", 4), ("spheres:3", 16), ("cornell-mesh", 8)] {
            let scene = load(name).unwrap();
            let bounds: Vec<Option<Bounds>> = scene.primitives.bounds().collect();
            for accelerator in ["median", "sah"] {
                let hierarchy = scene.accelerated(accelerator).unwrap().hierarchy.unwrap();
                let gathered = hierarchy.gathered(width);
                let nodes: Vec<&[Child]> = gathered.nodes().collect();
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
                                let primitives = gathered.primitives(*first, *count);
                                for primitive in primitives {
                                    let inner = bounds[*primitive as usize].unwrap();
                                    assert_eq!(own.and(&inner), *own, "{name}: {primitive} sticks out");
                                }
                                found.extend(primitives);
                            }
                        }
                    }
                }
                found.sort_unstable();
                assert!(found.into_iter().eq(0..bounds.len() as u32), "{name}");
            }
        }
    }
}
