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

impl Hierarchy {
    /// Nodes of at most `width` children, which must be 2 or more; the first is the root. Of the boxes with too many primitives the largest is opened
    /// until there are so many.
    pub fn gathered(&self, width: usize) -> Vec<Vec<Child>> {
        let sizes = self.sizes();
        let is_open = |index: usize| self.nodes[index].count == 0 && sizes[index] > width;
        let mut gathered = vec![Vec::new()];
        let mut waiting = vec![(0, 0)];
        while let Some((root, place)) = waiting.pop() {
            let mut children = vec![root];
            while children.len() < width {
                let open = children.iter().enumerate().filter(|(_, index)| is_open(**index));
                let areas = open.map(|(k, index)| (k, self.bounds(*index).half_area()));
                let Some((largest, _)) = areas.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
                let first = self.nodes[children[largest]].at as usize;
                children.splice(largest..=largest, [first, first + 1]);
            }
            for index in children {
                let content = if is_open(index) {
                    gathered.push(Vec::new());
                    waiting.push((index, gathered.len() - 1));
                    Content::Node(gathered.len() - 1)
                } else {
                    Content::Primitives(self.primitives(index))
                };
                gathered[place].push(Child { bounds: self.bounds(index), content });
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
