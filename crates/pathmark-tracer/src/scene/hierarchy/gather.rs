//! The same tree with many children a node, for those who test as many boxes or primitives at a time (Dammertz, Hanika and Keller, "Shallow
//! Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", 2008).

use super::{Bounds, Hierarchy};

/// A child of a node with many.
#[derive(Debug, Clone, PartialEq)]
pub struct Child {
    /// Its box, with its padding.
    pub bounds: Bounds,
    /// What is in it.
    pub content: Content,
}

/// What is in a box.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A node by its number.
    Node(usize),
    /// Primitives: no more than a node has children, unless the tree keeps more together.
    Primitives(Vec<u32>),
}

/// What rays are expected to cost below a node, in looks at the root. A look at a leaf costs as much as one at a node, for each time that it has `width`
/// primitives.
struct Costs {
    /// Of each node of the binary tree, when one, two and so on up to `width - 1` children of a wide node stand for it, at most.
    by_children: Vec<f32>,
    /// When it is a wide node itself.
    as_node: Vec<f32>,
    width: usize,
}

impl Costs {
    /// From the leaves up, since children stand behind their parents (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs
    /// Through Compressed Wide BVHs", 2017, who find the tree of least cost in this way).
    fn of(hierarchy: &Hierarchy, width: usize) -> Self {
        let nodes = &hierarchy.nodes;
        let sizes = hierarchy.sizes();
        let whole = hierarchy.bounds(0).half_area();
        let mut costs = Self {
            by_children: vec![0.0; nodes.len() * (width - 1)],
            as_node: vec![f32::INFINITY; nodes.len()],
            width,
        };
        for (index, node) in nodes.iter().enumerate().rev() {
            let area = if whole > 0.0 { (hierarchy.bounds(index).half_area() / whole) as f32 } else { 0.0 };
            let is_inner = node.count == 0;
            let as_leaf = match (sizes[index] <= width, is_inner) {
                (false, true) => f32::INFINITY,
                _ => area * sizes[index].div_ceil(width) as f32,
            };
            if is_inner {
                costs.as_node[index] = area + costs.divided(node.at as usize, width).0;
            }
            let mut least = as_leaf.min(costs.as_node[index]);
            for children in 1..width {
                if is_inner && children > 1 {
                    least = least.min(costs.divided(node.at as usize, children).0);
                }
                costs.by_children[index * (width - 1) + children - 1] = least;
            }
        }
        costs
    }

    fn with(&self, index: usize, children: usize) -> f32 {
        self.by_children[index * (self.width - 1) + children - 1]
    }

    /// The least cost of a node whose first child in the binary tree is `first`, with so many children at most, and how many of them stand for `first`.
    fn divided(&self, first: usize, children: usize) -> (f32, usize) {
        (1..children)
            .map(|to_first| (self.with(first, to_first) + self.with(first + 1, children - to_first), to_first))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("two children or more")
    }
}

impl Hierarchy {
    /// Nodes of at most `width` children, which must be 2 or more; the first is the root. Of all such trees over this one it is the one that rays are
    /// expected to go through at the least cost.
    pub fn gathered(&self, width: usize) -> Vec<Vec<Child>> {
        let costs = Costs::of(self, width);
        let is_node = |index: usize| costs.as_node[index] <= costs.with(index, 1);
        let mut gathered = vec![Vec::new()];
        let mut waiting = vec![(0, 0)];
        while let Some((root, place)) = waiting.pop() {
            let mut parts = vec![(root, if is_node(root) { width } else { 1 })];
            while let Some((index, children)) = parts.pop() {
                let is_same_with_fewer =
                    || index != root && costs.with(index, children) == costs.with(index, children - 1);
                if children > 1 && is_same_with_fewer() {
                    parts.push((index, children - 1));
                } else if children > 1 {
                    let first = self.nodes[index].at as usize;
                    let (_, to_first) = costs.divided(first, children);
                    parts.extend([(first + 1, children - to_first), (first, to_first)]);
                } else {
                    let content = if is_node(index) {
                        gathered.push(Vec::new());
                        waiting.push((index, gathered.len() - 1));
                        Content::Node(gathered.len() - 1)
                    } else {
                        Content::Primitives(self.primitives(index))
                    };
                    gathered[place].push(Child { bounds: self.bounds(index), content });
                }
            }
        }
        gathered
    }

    /// The primitives below each node.
    fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.nodes.len()];
        // Children stand behind their parents.
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let at = node.at as usize;
            sizes[index] = if node.count == 0 { sizes[at] + sizes[at + 1] } else { node.count as usize };
        }
        sizes
    }

    fn bounds(&self, index: usize) -> Bounds {
        let [low, high] = self.nodes[index].faces;
        Bounds { low, high }
    }

    fn primitives(&self, root: usize) -> Vec<u32> {
        let mut found = Vec::new();
        let mut waiting = vec![root];
        while let Some(index) = waiting.pop() {
            let node = &self.nodes[index];
            let at = node.at as usize;
            if node.count == 0 {
                waiting.extend([at + 1, at]);
            } else {
                found.extend(&self.order[at..at + node.count as usize]);
            }
        }
        found
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
    fn least(tree: &Hierarchy, sizes: &[usize], index: usize, width: usize) -> f64 {
        let area = tree.bounds(index).half_area();
        let is_leaf = tree.nodes[index].count > 0;
        let is_whole = is_leaf || sizes[index] <= width;
        let as_leaf = if is_whole { area * sizes[index].div_ceil(width) as f64 } else { f64::INFINITY };
        let children = stand_ins(tree, index, width).into_iter().skip(1);
        let costs = children.map(|nodes| nodes.into_iter().map(|node| least(tree, sizes, node, width)).sum::<f64>());
        as_leaf.min(area + costs.fold(f64::INFINITY, f64::min))
    }

    fn cost(nodes: &[Vec<Child>], node: usize, area: f64, width: usize) -> f64 {
        let of_child = |child: &Child| {
            let area = child.bounds.half_area();
            match &child.content {
                Content::Node(inner) => cost(nodes, *inner, area, width),
                Content::Primitives(primitives) => area * primitives.len().div_ceil(width) as f64,
            }
        };
        area + nodes[node].iter().map(of_child).sum::<f64>()
    }

    /// No other tree over the binary one costs less.
    #[test]
    fn cost_is_the_least_of_all_trees() {
        for (name, width) in [("spheres:9", 2), ("spheres:11", 3), ("spheres:13", 4), ("cornell-tall", 3)] {
            for accelerator in ["median", "sah"] {
                let tree = load(name).unwrap().accelerated(accelerator).unwrap().hierarchy.unwrap();
                let found = cost(&tree.gathered(width), 0, tree.bounds(0).half_area(), width);
                let expected = least(&tree, &tree.sizes(), 0, width);
                assert!((found / expected - 1.0).abs() < 1e-5, "{name}, {accelerator}: {found} instead of {expected}");
            }
        }
    }

    /// Every primitive is in exactly one box, its own box in all that it is in, and no node is wider than asked for.
    #[test]
    fn all_primitives_are_kept() {
        for (name, width) in [("spheres:1000", 16), ("spheres:1000", 4), ("spheres:3", 16), ("cornell-mesh", 8)] {
            let scene = load(name).unwrap();
            let bounds = scene.primitives.bounds();
            for accelerator in ["median", "sah"] {
                let hierarchy = scene.accelerated(accelerator).unwrap().hierarchy.unwrap();
                let nodes = hierarchy.gathered(width);
                let mut found: Vec<u32> = Vec::new();
                let mut waiting = vec![(0, None)];
                while let Some((node, around)) = waiting.pop() {
                    assert!((1..=width).contains(&nodes[node].len()), "{name}: {} children", nodes[node].len());
                    for Child { bounds: own, content } in &nodes[node] {
                        assert!(
                            around.is_none_or(|around: Bounds| around.and(own) == around),
                            "{name}: a box sticks out"
                        );
                        match content {
                            Content::Node(inner) => waiting.push((*inner, Some(*own))),
                            Content::Primitives(primitives) => {
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
