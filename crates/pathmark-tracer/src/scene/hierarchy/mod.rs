//! A bounding volume hierarchy over the primitives, so that a ray is tested against few of them: `--accelerator median` and `sah`, which
//! report B describes.
//!
//! It finds the same hits as testing every primitive, to the bit. Boxes have a padding that covers the rounding errors
//! of the box and primitive tests; triangle hits that it may not cover are searched again (`shape/doubt.rs`). A box
//! exactly as far as the nearest hit is still opened, and among equally near primitives the lowest number wins. It is
//! built from total orders, so the same scene gives the same tree for any number of threads that build it.
//!
//! To add a way of splitting: write its file with a type that implements [`Split`], and give it a line in `accelerators!` below.

mod bounds;
mod build;
mod median;
mod sah;
mod sorted;
mod traverse;

pub use bounds::{Bounds, Faces, Slabs, padding};
pub use build::DEEPEST;

/// Boxes and primitives that rays were tested against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tests {
    pub boxes: u64,
    /// Primitives in boxes.
    pub primitives: u64,
}

/// A node: a box, and where its children or primitives are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    pub faces: Faces,
    /// For an inner node, the first child (the second one follows it); for a leaf, its first entry in
    /// [`Hierarchy::order`].
    pub at: u32,
    /// Entries of a leaf; 0 in an inner node.
    pub count: u32,
}

/// The binary tree. Children are stored in pairs, depth first.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    nodes: Vec<Node>,
    /// Primitives in the order of the leaves.
    order: Vec<u32>,
}

/// A primitive with its box, padding included.
#[derive(Debug, Clone, Copy)]
struct Item {
    bounds: Bounds,
    number: u32,
}

/// A rule that divides a node's primitives between its children.
trait Split: Clone + Send + Sync {
    /// Splits a node of few primitives: returns the axis, and how many primitives, in the order of their centroids
    /// along it, go to the first child; `None` makes it a leaf. `sorted` holds them three times, in the order of each
    /// axis.
    fn split(&mut self, bounds: &[Bounds], node: &Bounds, sorted: [&[u32]; 3]) -> Option<(usize, usize)>;

    /// Divides a node of many unsorted primitives: moves the first child's primitives to the front and returns their
    /// number, at least one and not all; `None` if they must be sorted. `middles` is the bounding box of their
    /// centroids.
    fn divide(&self, node: &Bounds, middles: &Bounds, own: &mut [Item]) -> Option<usize>;
}

/// Builds a tree over primitives; `None` if there are none.
type Build = fn(Vec<Item>) -> Option<Hierarchy>;

/// One line of the table of accelerators.
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    pub about: &'static str,
    build: Option<Build>,
}

macro_rules! accelerators {
    ($($name:literal, $about:literal => $build:expr;)*) => {
        /// The accelerators, in the order in which they are listed.
        pub const ACCELERATORS: &[Entry] = &[$(Entry { name: $name, about: $about, build: $build }),*];
    };
}

accelerators! {
    "none", "every primitive is tested" => None;
    "median", "a bounding volume hierarchy, split at the median of the widest axis" => Some(|items| build::build(items, &median::Median));
    "sah", "a bounding volume hierarchy, split by the surface area heuristic" => Some(|items| build::build(items, &sah::Sah::new()));
}

/// The least number of primitives for which a hierarchy is faster than testing all of them (experiment `acceleration`).
/// Of the shipped scenes those with 12 and more gain, also `furnace` with 12 triangles and 2 spheres and `vista` with
/// spheres in spheres; those with up to 9 lose.
const WORTH_A_HIERARCHY: usize = 12;

/// Likewise, in multiples of the register width, where lanes test spheres side by side in registers of single
/// precision. With registers of 16, `spheres:100` is 1.2 times as fast without a hierarchy and `spheres:200` with one.
/// With registers of 8, `spheres:50` is as fast, and `spheres:100` is 1.4 times as fast with one.
const REGISTERS_WORTH_A_HIERARCHY: usize = 8;

/// Likewise, in multiples of the number of lanes, where lanes of double precision test any primitives side by side:
/// testing all triangles of `bumpy-ball:N` is as fast at some 100 triangles in 16 lanes, and at 45 in 8.
const DOUBLES_WORTH_A_HIERARCHY: usize = 6;

/// Likewise, in single precision: at some 130 triangles in 32 lanes, and at 60 in 16.
const SINGLES_WORTH_A_HIERARCHY: usize = 4;

/// The tests of primitives without a hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scan {
    /// One after the other.
    OneByOne,
    /// Spheres, each against the rays of many lanes; registers hold this many numbers of single precision.
    Spheres(usize),
    /// Any primitives, each against the rays of this many lanes of double precision.
    Doubles(usize),
    /// Likewise, with lanes of single precision.
    Singles(usize),
}

impl Entry {
    /// Whether it needs the code of a hierarchy.
    pub fn is_hierarchy(&self) -> bool {
        self.build.is_some()
    }

    /// Builds the hierarchy over primitives with these boxes; `None` if there is nothing to build.
    pub fn build(&self, bounds: impl Iterator<Item = Option<Bounds>>) -> Option<Hierarchy> {
        let build = self.build?;
        let mut items = Vec::with_capacity(bounds.size_hint().1.unwrap_or_default());
        let with_box = (0..).zip(bounds).filter_map(|(number, bounds)| Some(Item { bounds: bounds?.padded(), number }));
        items.extend(with_box);
        build(items)
    }
}

/// Returns the accelerator of that name; without a name, the default for that many primitives.
pub fn accelerator(name: Option<&str>, primitives: usize, scan: Scan) -> Option<&'static Entry> {
    let worth = match scan {
        Scan::OneByOne => WORTH_A_HIERARCHY,
        Scan::Spheres(width) => REGISTERS_WORTH_A_HIERARCHY * width,
        Scan::Doubles(lanes) => DOUBLES_WORTH_A_HIERARCHY * lanes,
        Scan::Singles(lanes) => SINGLES_WORTH_A_HIERARCHY * lanes,
    };
    let fitting = if primitives < worth { "none" } else { "sah" };
    let wanted = name.unwrap_or(fitting);
    ACCELERATORS.iter().find(|entry| entry.name == wanted)
}

impl Hierarchy {
    /// Returns the nodes, the root first and children after their parents.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Primitives in the order of the leaves.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Primitives in the order of the leaves; the nodes are freed.
    pub fn into_order(self) -> Vec<u32> {
        self.order
    }

    /// Returns the tree with every length multiplied by `factor`.
    #[must_use]
    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.nodes.iter_mut().flat_map(|node| node.faces.as_flattened_mut()).for_each(|face| *face *= factor);
        self
    }

    /// Levels below the root.
    pub fn depth(&self) -> usize {
        let mut deepest = 0;
        let mut waiting = vec![(0, 0)];
        while let Some((index, depth)) = waiting.pop() {
            deepest = deepest.max(depth);
            let node = &self.nodes[index];
            if node.count == 0 {
                waiting.extend([0, 1].map(|child| (node.at as usize + child, depth + 1)));
            }
        }
        deepest
    }
}
