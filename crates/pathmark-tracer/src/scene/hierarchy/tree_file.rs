//! The file format of a hierarchy. It has no boxes: they are computed from the primitives, so whatever a file contains,
//! rays find the same hits. Numbers are little-endian and have 32 bits unless stated otherwise:
//!
//! ```text
//! pathmark tree 1\n   16 bytes
//! nodes, primitives   64 bits each
//! a node              `at` and `count`
//! a primitive         how many with a box stand before it in the scene; in the order of the leaves
//! SHA-256             of everything before it, 32 bytes
//! ```

use super::bounds::Faces;
use super::build::DEEPEST;
use super::{Bounds, Hierarchy, Item, Node};
use sha2::digest::Output;
use sha2::{Digest, Sha256};
use std::io::{self, ErrorKind, Read, Write};

/// The first bytes of a file. The number is raised when the same primitives give another hierarchy.
pub(super) const MAGIC: &[u8; 16] = b"pathmark tree 1\n";

/// Numbers that are read or written at once.
pub(super) const BLOCK: usize = 1 << 14;

/// A writer or reader that hashes all its bytes.
struct Hashed<'a, F: ?Sized> {
    file: &'a mut F,
    hash: Sha256,
}

impl<F: Write + ?Sized> Hashed<'_, F> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.file.write_all(bytes)
    }

    fn put_all(&mut self, numbers: impl Iterator<Item = u32>) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(BLOCK * size_of::<u32>());
        for number in numbers {
            bytes.extend(number.to_le_bytes());
            if bytes.len() == BLOCK * size_of::<u32>() {
                self.put(&bytes)?;
                bytes.clear();
            }
        }
        self.put(&bytes)
    }
}

impl<F: Read + ?Sized> Hashed<'_, F> {
    fn fill(&mut self, bytes: &mut [u8]) -> io::Result<()> {
        self.file.read_exact(bytes)?;
        self.hash.update(bytes);
        Ok(())
    }

    fn number(&mut self) -> io::Result<u64> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes)?;
        Ok(u64::from_le_bytes(bytes))
    }

    fn take_all(&mut self, count: usize) -> io::Result<Vec<u32>> {
        let mut numbers = Vec::with_capacity(count);
        let mut bytes = vec![0; BLOCK * size_of::<u32>()];
        while numbers.len() < count {
            let block = &mut bytes[..BLOCK.min(count - numbers.len()) * size_of::<u32>()];
            self.fill(block)?;
            numbers.extend(block.as_chunks().0.iter().map(|number| u32::from_le_bytes(*number)));
        }
        Ok(numbers)
    }
}

fn damaged(problem: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, problem)
}

impl Hierarchy {
    /// Writes the hierarchy; `numbers` are the numbers of all primitives that have a box.
    pub(super) fn write(&self, file: &mut dyn Write, numbers: &[u32]) -> io::Result<()> {
        let mut file = Hashed { file, hash: Sha256::new() };
        file.put(MAGIC)?;
        file.put(&(self.nodes.len() as u64).to_le_bytes())?;
        file.put(&(self.order.len() as u64).to_le_bytes())?;
        file.put_all(self.nodes.iter().flat_map(|node| [node.at, node.count]))?;
        let mut places = vec![0; numbers.last().map_or(0, |last| *last as usize + 1)];
        for (place, number) in (0..).zip(numbers) {
            places[*number as usize] = place;
        }
        file.put_all(self.order.iter().map(|number| places[*number as usize]))?;
        let Hashed { file, hash } = file;
        file.write_all(&hash.finalize())
    }

    /// Reads a hierarchy over these primitives.
    pub(super) fn read(file: &mut dyn Read, items: &[Item]) -> io::Result<Self> {
        let mut file = Hashed { file, hash: Sha256::new() };
        let mut magic = [0; MAGIC.len()];
        file.fill(&mut magic)?;
        if magic != *MAGIC {
            return Err(damaged("it has another format"));
        }
        let [nodes, order] = [file.number()?, file.number()?];
        if !(1..2 * items.len() as u64).contains(&nodes) || order != items.len() as u64 {
            return Err(damaged("it belongs to another scene"));
        }
        let [nodes, order] = [file.take_all(2 * nodes as usize)?, file.take_all(items.len())?];
        let Hashed { file, hash } = file;
        let mut told = Output::<Sha256>::default();
        file.read_exact(&mut told)?;
        if told != hash.finalize() {
            return Err(damaged("its SHA-256 does not match"));
        }
        if file.read(&mut [0])? > 0 {
            return Err(damaged("it continues after its SHA-256"));
        }
        Self::assembled(nodes.as_chunks().0, &order, items).map_err(damaged)
    }

    /// Assembles a hierarchy from `at` and `count` of the nodes and the order of the primitives. A forged file can
    /// carry a valid SHA-256, so every property that a search relies on is checked.
    fn assembled(nodes: &[[u32; 2]], order: &[u32], items: &[Item]) -> std::result::Result<Self, &'static str> {
        let mut is_missing = vec![true; items.len()];
        let mut is_new = |place: &u32| is_missing.get_mut(*place as usize).is_some_and(std::mem::take);
        if !order.iter().all(&mut is_new) {
            return Err("its primitives are not those of the scene");
        }
        // Levels below the root; 0 if no parent has been seen.
        let mut levels = vec![0_u8; nodes.len()];
        for (index, [at, count]) in nodes.iter().enumerate() {
            let (at, level) = (*at as usize, levels[index]);
            if index > 0 && level == 0 {
                return Err("a node has no parent");
            }
            if *count > 0 {
                continue;
            }
            // Children come after their parent, so no node is its own ancestor.
            let children = levels.get_mut(at..at + 2).filter(|_| at > index && usize::from(level) < DEEPEST);
            match children {
                Some(children) if *children == [0, 0] => children.fill(level + 1),
                _ => return Err("a node has invalid children"),
            }
        }
        let mut all = vec![Node { faces: Bounds::EMPTY.faces(), at: 0, count: 0 }; nodes.len()];
        // The begin and end of each node's primitives in the order of the leaves.
        let mut ranges = vec![[0; 2]; nodes.len()];
        for (index, &[at, count]) in nodes.iter().enumerate().rev() {
            let (first, mut bounds) = (at as usize, Bounds::EMPTY);
            if count > 0 {
                let own = order.get(first..first + count as usize).ok_or("a leaf has invalid primitives")?;
                for place in own {
                    bounds = bounds.and(&items[*place as usize].bounds);
                }
                ranges[index] = [at, at + count];
            } else {
                let [[begin, middle], [next, end]] = [ranges[first], ranges[first + 1]];
                if middle != next {
                    return Err("leaves are out of order");
                }
                bounds = bounds_of(all[first].faces).and(&bounds_of(all[first + 1].faces));
                ranges[index] = [begin, end];
            }
            all[index] = Node { faces: bounds.faces(), at, count };
        }
        if ranges.first() != Some(&[0, items.len() as u32]) {
            return Err("leaves are out of order");
        }
        Ok(Self { nodes: all, order: order.iter().map(|place| items[*place as usize].number).collect() })
    }
}

fn bounds_of([low, high]: Faces) -> Bounds {
    Bounds { low, high }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::digest::Fingerprint;
    use crate::scene::{Scene, load};

    /// Returns the primitives that a hierarchy of the scene holds.
    pub(in crate::scene::hierarchy) fn items(scene: &Scene) -> Vec<Item> {
        let with_box = (0..).zip(scene.primitives.bounds());
        with_box.filter_map(|(number, bounds)| Some(Item { bounds: bounds?.padded(), number })).collect()
    }

    fn tree(scene: &Scene) -> Hierarchy {
        scene.hierarchy_by("sah", None).unwrap().unwrap()
    }

    fn written(tree: &Hierarchy, items: &[Item]) -> Vec<u8> {
        let mut bytes = Vec::new();
        tree.write(&mut bytes, &items.iter().map(|item| item.number).collect::<Vec<_>>()).unwrap();
        bytes
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let scene = load("spheres:5000").unwrap();
        let items = items(&scene);
        let whole = written(&tree(&scene), &items);
        assert!(Hierarchy::read(&mut whole.as_slice(), &items).unwrap() == tree(&scene));
        for at in (0..whole.len()).step_by(997).chain([0, 16, 24, 32, whole.len() - 1]) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            assert!(Hierarchy::read(&mut bytes.as_slice(), &items).is_err(), "byte {at}");
            assert!(Hierarchy::read(&mut &whole[..at], &items).is_err(), "the first {at} bytes");
        }
        let longer = [&whole[..], &[0]].concat();
        assert!(Hierarchy::read(&mut longer.as_slice(), &items).is_err());
    }

    /// A forged file gives an error and no panic.
    #[test]
    fn trees_that_no_search_could_go_down_are_refused() {
        let scene = load("spheres:5000").unwrap();
        let (items, whole) = (items(&scene), tree(&scene));
        let nodes: Vec<[u32; 2]> = whole.nodes.iter().map(|node| [node.at, node.count]).collect();
        let is_leaf = |index: usize| nodes[index][1] > 0;
        let leaf = (0..nodes.len()).find(|index| is_leaf(*index)).unwrap();
        let last = (0..nodes.len()).rfind(|index| !is_leaf(*index)).unwrap();
        // Two sibling leaves with the same number of primitives.
        let equal =
            (1..nodes.len()).step_by(2).find(|first| is_leaf(*first) && nodes[*first][1] == nodes[first + 1][1]);
        let equal = equal.unwrap();
        let refused = |index: usize, change: fn(&mut [[u32; 2]], &mut [u32], usize)| {
            let (mut nodes, mut order) = (nodes.clone(), whole.order.clone());
            change(&mut nodes, &mut order, index);
            Hierarchy::assembled(&nodes, &order, &items).unwrap_err()
        };
        assert!(Hierarchy::assembled(&nodes, &whole.order, &items).unwrap() == whole);
        let children = "a node has invalid children";
        let (leaves, primitives) = ("leaves are out of order", "its primitives are not those of the scene");
        let errors = [
            (children, refused(0, |nodes, _, root| nodes[root][0] = 0)),
            (children, refused(last, |nodes, _, last| nodes[last][0] = nodes.len() as u32 - 1)),
            (children, refused(last, |nodes, _, last| nodes[last][0] = u32::MAX)),
            (children, refused(1, |nodes, _, first| nodes[first][0] = nodes[first + 1][0])),
            ("a node has no parent", refused(0, |nodes, _, root| nodes[root][1] = 1)),
            ("a leaf has invalid primitives", refused(leaf, |nodes, _, leaf| nodes[leaf][0] = 5000)),
            ("a leaf has invalid primitives", refused(leaf, |nodes, _, leaf| nodes[leaf][1] = u32::MAX)),
            (leaves, refused(equal, |nodes, _, leaf| nodes.swap(leaf, leaf + 1))),
            (leaves, refused(leaf, |nodes, _, leaf| nodes[leaf][1] += 1)),
            (primitives, refused(0, |_, order, first| order[first] = order[first + 1])),
            (primitives, refused(0, |_, order, first| order[first] = 5000)),
        ];
        for (expected, error) in errors {
            assert_eq!(error, expected);
        }
    }

    /// Searches have room for only `DEEPEST` levels.
    #[test]
    fn too_many_levels_are_refused() {
        let all = items(&load("spheres:5000").unwrap());
        // Each node has a leaf and the next node; the last has two leaves.
        let chain = |levels: u32| {
            let inner = (0..levels).map(|level| [2 * level + 1, 0]);
            let leaves = (0..levels).map(|level| [level, 1]);
            let pairs = leaves.zip(inner.clone().skip(1).chain([[levels, 1]])).flat_map(|(leaf, next)| [leaf, next]);
            let nodes: Vec<[u32; 2]> = inner.take(1).chain(pairs).collect();
            let order: Vec<u32> = (0..=levels).collect();
            Hierarchy::assembled(&nodes, &order, &all[..order.len()]).map(|tree| tree.depth())
        };
        assert_eq!(chain(DEEPEST as u32), Ok(DEEPEST));
        assert_eq!(chain(DEEPEST as u32 + 1), Err("a node has invalid children"));
    }

    /// A golden digest, which changes when the same primitives give another hierarchy. Then raise the number in
    /// [`MAGIC`]; otherwise this program accepts files of older programs.
    #[test]
    fn the_same_primitives_give_the_same_tree_as_ever() {
        let mut fingerprint = Fingerprint::default();
        for name in ["spheres:5000", "bumpy-ball:5000"] {
            for accelerator in ["median", "sah"] {
                let scene = load(name).unwrap();
                let tree = scene.hierarchy_by(accelerator, None).unwrap().unwrap();
                fingerprint.update(&written(&tree, &items(&scene)));
            }
        }
        assert_eq!(fingerprint.finish(), "dc287ecb655bb782");
    }
}
