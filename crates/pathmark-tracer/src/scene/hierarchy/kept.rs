//! Trees that outlast the process that built them: `--cache FOLDER`.
//!
//! The key is the SHA-256 of what a tree is built from, the accelerator's name and the padded boxes of the primitives. So a scene that is edited,
//! scaled or generated anew has another key, and one whose materials, lights or camera change keeps its tree. Numbers are little-endian:
//!
//! ```text
//! pathmark tree 1\n   16 bytes
//! nodes, primitives   64 bits each
//! a node              six faces of 64 bits, the smallest coordinates first; `at` and `count` of 32 bits
//! a primitive         its number, 32 bits, in the order of the leaves
//! SHA-256             of everything before it, 32 bytes
//! ```

use super::build::DEEPEST;
use super::{Hierarchy, Item, Node};
use crate::error::Result;
use sha2::digest::Output;
use sha2::{Digest, Sha256};
use std::fmt::{self, Write as _};
use std::io::{self, ErrorKind, Read, Write};

/// A folder, or whatever else holds bytes by key.
pub trait TreeStore: fmt::Debug + Send + Sync {
    /// Gives the bytes of that key to `read`, whose error means that they are damaged; `false` if there are none.
    fn find(&self, key: &str, read: &mut dyn FnMut(&mut dyn Read) -> io::Result<()>) -> Result<bool>;

    /// Keeps what `write` writes, all of it or nothing.
    fn keep(&self, key: &str, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()>;
}

/// How files begin. The number is raised when the same primitives give another tree.
const MAGIC: &[u8; 16] = b"pathmark tree 1\n";

/// Fewer primitives have a tree within milliseconds, sooner than a file is opened on many systems.
const WORTH_KEEPING: usize = 4096;

const NODE_BYTES: usize = 56;
/// Nodes that are read or written at once.
const BLOCK: usize = 1024;

/// The tree of the store, or else the one that `build` makes of the primitives, which the store then keeps.
pub(super) fn found_or_built(
    name: &str,
    items: Vec<Item>,
    store: &dyn TreeStore,
    build: impl FnOnce(Vec<Item>) -> Option<Hierarchy>,
) -> Result<Option<Hierarchy>> {
    if items.len() < WORTH_KEEPING {
        return Ok(build(items));
    }
    let key = key(name, &items);
    let mut found = None;
    let mut read = |file: &mut dyn Read| {
        found = Some(Hierarchy::read(file, &items)?);
        Ok(())
    };
    if store.find(&key, &mut read)? {
        return Ok(found);
    }
    let built = build(items);
    if let Some(tree) = &built {
        store.keep(&key, &mut |file| tree.write(file))?;
    }
    Ok(built)
}

/// The name of a tree: 32 hexadecimal digits.
fn key(name: &str, items: &[Item]) -> String {
    let mut hash = Sha256::new_with_prefix(MAGIC);
    hash.update(name);
    let mut bytes = Vec::new();
    for block in items.chunks(BLOCK) {
        bytes.clear();
        for Item { bounds, number } in block {
            bytes.extend(bounds.low.iter().chain(&bounds.high).flat_map(|x| x.to_le_bytes()));
            bytes.extend(number.to_le_bytes());
        }
        hash.update(&bytes);
    }
    hash.finalize().iter().take(16).fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Writes or reads, and hashes all of it.
struct Hashed<'a, F: ?Sized> {
    file: &'a mut F,
    hash: Sha256,
}

impl<F: Write + ?Sized> Hashed<'_, F> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.file.write_all(bytes)
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
}

fn damaged(problem: &str) -> io::Error {
    io::Error::new(
        ErrorKind::InvalidData,
        format!("the tree in it is damaged ({problem}); without the file it is built again"),
    )
}

impl Hierarchy {
    fn write(&self, file: &mut dyn Write) -> io::Result<()> {
        let mut file = Hashed { file, hash: Sha256::new() };
        file.put(MAGIC)?;
        file.put(&(self.nodes.len() as u64).to_le_bytes())?;
        file.put(&(self.order.len() as u64).to_le_bytes())?;
        let mut bytes = Vec::with_capacity(BLOCK * NODE_BYTES);
        for block in self.nodes.chunks(BLOCK) {
            bytes.clear();
            for Node { faces, at, count } in block {
                bytes.extend(faces.iter().flatten().flat_map(|x| x.to_le_bytes()));
                bytes.extend([at, count].into_iter().flat_map(|number| number.to_le_bytes()));
            }
            file.put(&bytes)?;
        }
        for block in self.order.chunks(BLOCK) {
            bytes.clear();
            bytes.extend(block.iter().flat_map(|number| number.to_le_bytes()));
            file.put(&bytes)?;
        }
        let Hashed { file, hash } = file;
        file.write_all(&hash.finalize())
    }

    /// A tree over these primitives.
    fn read(file: &mut dyn Read, items: &[Item]) -> io::Result<Self> {
        let mut file = Hashed { file, hash: Sha256::new() };
        let mut magic = [0; MAGIC.len()];
        file.fill(&mut magic)?;
        let [nodes, order] = [file.number()?, file.number()?];
        let is_possible = (1..2 * items.len() as u64).contains(&nodes) && order == items.len() as u64;
        if magic != *MAGIC || !is_possible {
            return Err(damaged("it is of another scene"));
        }
        let mut tree = Self { nodes: Vec::with_capacity(nodes as usize), order: Vec::with_capacity(items.len()) };
        let mut bytes = vec![0; BLOCK * NODE_BYTES];
        while tree.nodes.len() < nodes as usize {
            let block = &mut bytes[..BLOCK.min(nodes as usize - tree.nodes.len()) * NODE_BYTES];
            file.fill(block)?;
            tree.nodes.extend(block.as_chunks().0.iter().map(node));
        }
        while tree.order.len() < items.len() {
            let block = &mut bytes[..BLOCK.min(items.len() - tree.order.len()) * size_of::<u32>()];
            file.fill(block)?;
            tree.order.extend(block.as_chunks().0.iter().map(|number| u32::from_le_bytes(*number)));
        }
        let Hashed { file, hash } = file;
        let mut told = Output::<Sha256>::default();
        file.read_exact(&mut told)?;
        if told != hash.finalize() {
            return Err(damaged("its SHA-256 is another"));
        }
        tree.check(items).map_err(damaged)?;
        Ok(tree)
    }

    /// Whether a search can go down it: whoever writes a file can write its SHA-256, too.
    fn check(&self, items: &[Item]) -> std::result::Result<(), &'static str> {
        // Below the root; 0 where no parent has been seen.
        let mut levels = vec![0; self.nodes.len()];
        let mut in_leaves = 0;
        for (index, node) in self.nodes.iter().enumerate() {
            let (at, count, level) = (node.at as usize, node.count as usize, levels[index]);
            if index > 0 && level == 0 {
                return Err("a node has no parent");
            }
            if count > 0 {
                in_leaves += count;
                if at + count > self.order.len() {
                    return Err("a leaf has no primitives");
                }
                continue;
            }
            // Children stand behind their parent, so none is its own ancestor.
            let children = levels.get_mut(at..at + 2).filter(|_| at > index && level < DEEPEST);
            match children {
                Some(children) if *children == [0, 0] => children.fill(level + 1),
                _ => return Err("a node has no children of its own"),
            }
        }
        let mut missing = vec![false; items.last().map_or(0, |item| item.number as usize + 1)];
        for item in items {
            missing[item.number as usize] = true;
        }
        let mut is_missing = |number: &u32| missing.get_mut(*number as usize).is_some_and(std::mem::take);
        let has_all = self.order.iter().all(&mut is_missing) && in_leaves == items.len();
        if has_all { Ok(()) } else { Err("its primitives are others") }
    }
}

fn node(bytes: &[u8; NODE_BYTES]) -> Node {
    let (faces, rest) = bytes.as_chunks::<8>();
    let face = |number: usize| f64::from_le_bytes(faces[number]);
    let [at, count] = [0, 4].map(|begin| {
        let number = &faces[6][begin..begin + 4];
        u32::from_le_bytes([number[0], number[1], number[2], number[3]])
    });
    debug_assert!(rest.is_empty(), "seven times eight bytes");
    Node { faces: [[face(0), face(1), face(2)], [face(3), face(4), face(5)]], at, count }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, load};
    use std::collections::HashMap;
    use std::sync::Mutex;

    /// Keeps trees in memory.
    #[derive(Debug, Default)]
    struct Shelf(Mutex<HashMap<String, Vec<u8>>>);

    impl TreeStore for Shelf {
        fn find(&self, key: &str, read: &mut dyn FnMut(&mut dyn Read) -> io::Result<()>) -> Result<bool> {
            let bytes = self.0.lock().unwrap().get(key).cloned();
            bytes.map_or(Ok(false), |bytes| {
                read(&mut bytes.as_slice()).map(|()| true).map_err(|e| crate::error::Error::system("reading", key, e))
            })
        }

        fn keep(&self, key: &str, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
            let mut bytes = Vec::new();
            write(&mut bytes).unwrap();
            assert!(self.0.lock().unwrap().insert(key.to_string(), bytes).is_none(), "{key} is kept already");
            Ok(())
        }
    }

    fn items(scene: &Scene) -> Vec<Item> {
        let with_box = (0..).zip(scene.primitives.bounds());
        with_box.filter_map(|(number, bounds)| Some(Item { bounds: bounds?.padded(), number })).collect()
    }

    fn tree(scene: &Scene) -> Hierarchy {
        scene.hierarchy_by("sah", None).unwrap().unwrap()
    }

    fn written(tree: &Hierarchy) -> Vec<u8> {
        let mut bytes = Vec::new();
        tree.write(&mut bytes).unwrap();
        bytes
    }

    #[test]
    fn what_is_found_is_what_was_built() {
        let shelf = Shelf::default();
        for name in ["spheres:5000", "bumpy-ball:5000"] {
            let scene = load(name).unwrap();
            for accelerator in ["median", "sah"] {
                let built = scene.hierarchy_by(accelerator, None).unwrap();
                assert!(built.is_some());
                // Built and kept, then found: the shelf refuses to keep it twice.
                for _ in 0..2 {
                    assert!(scene.hierarchy_by(accelerator, Some(&shelf)).unwrap() == built, "{name}, {accelerator}");
                }
            }
            assert_eq!(scene.hierarchy_by("none", Some(&shelf)).unwrap(), None);
        }
        assert_eq!(shelf.0.lock().unwrap().len(), 4);
    }

    #[test]
    fn what_is_found_is_not_built() {
        let (scene, shelf) = (load("spheres:5000").unwrap(), Shelf::default());
        let built = found_or_built("sah", items(&scene), &shelf, |_| Some(tree(&scene))).unwrap();
        let found = found_or_built("sah", items(&scene), &shelf, |_| unreachable!("it is kept")).unwrap();
        assert!(built.is_some() && found == built);
    }

    #[test]
    fn a_tree_is_known_by_its_boxes_and_the_way_it_is_split() {
        let scene = load("spheres:5000").unwrap();
        let of = |scene: &Scene| key("sah", &items(scene));
        assert_eq!(of(&scene.in_equilibrium()), of(&scene), "the materials are others, and the boxes the same");
        let mut moved = scene.clone();
        let x = &mut moved.primitives.spheres[4999].center.x;
        *x = x.next_up();
        let others =
            [of(&scene.scaled(2.0)), of(&load("spheres:5001").unwrap()), of(&moved), key("median", &items(&scene))];
        for other in others {
            assert_ne!(other, of(&scene));
        }
    }

    #[test]
    fn few_primitives_are_not_kept() {
        let shelf = Shelf::default();
        assert!(load("spheres:1000").unwrap().hierarchy_by("sah", Some(&shelf)).unwrap().is_some());
        assert!(shelf.0.lock().unwrap().is_empty());
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let scene = load("spheres:5000").unwrap();
        let (items, whole) = (items(&scene), written(&tree(&scene)));
        assert!(Hierarchy::read(&mut whole.as_slice(), &items).unwrap() == tree(&scene));
        for at in (0..whole.len()).step_by(997).chain([0, 16, 24, 32, whole.len() - 1]) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            assert!(Hierarchy::read(&mut bytes.as_slice(), &items).is_err(), "byte {at}");
            assert!(Hierarchy::read(&mut &whole[..at], &items).is_err(), "the first {at} bytes");
        }
    }

    /// Whoever makes such a file by hand gets an error and no panic, whatever the search would do with it.
    #[test]
    fn trees_that_no_search_could_go_down_are_refused() {
        let scene = load("spheres:5000").unwrap();
        let (items, whole) = (items(&scene), tree(&scene));
        let leaf = whole.nodes.iter().position(|node| node.count > 0).unwrap();
        let last = whole.nodes.iter().rposition(|node| node.count == 0).unwrap();
        let refused = |node: usize, change: fn(&mut Hierarchy, usize)| {
            let mut tree = whole.clone();
            change(&mut tree, node);
            Hierarchy::read(&mut written(&tree).as_slice(), &items).unwrap_err().to_string()
        };
        let children = "a node has no children of its own";
        let errors = [
            (children, refused(0, |tree, root| tree.nodes[root].at = 0)),
            (children, refused(last, |tree, last| tree.nodes[last].at = tree.nodes.len() as u32 - 1)),
            (children, refused(last, |tree, last| tree.nodes[last].at = u32::MAX)),
            (children, refused(1, |tree, first| tree.nodes[first].at = tree.nodes[first + 1].at)),
            ("a node has no parent", refused(0, |tree, root| tree.nodes[root].count = 1)),
            ("a leaf has no primitives", refused(leaf, |tree, leaf| tree.nodes[leaf].at = 5000)),
            ("a leaf has no primitives", refused(leaf, |tree, leaf| tree.nodes[leaf].count = u32::MAX)),
            ("its primitives are others", refused(0, |tree, first| tree.order[first] = tree.order[first + 1])),
            ("its primitives are others", refused(0, |tree, first| tree.order[first] = 5000)),
        ];
        for (problem, error) in errors {
            assert!(error.contains(problem), "{problem}: {error}");
        }
    }

    /// A golden digest, which says when trees of the same primitives are others: then raise the number in [`MAGIC`], or files of older programs are taken
    /// for trees of this one.
    #[test]
    fn the_same_primitives_give_the_same_tree_as_ever() {
        let mut fingerprint = crate::digest::Fingerprint::default();
        for name in ["spheres:5000", "bumpy-ball:5000"] {
            for accelerator in ["median", "sah"] {
                fingerprint.update(&written(&load(name).unwrap().hierarchy_by(accelerator, None).unwrap().unwrap()));
            }
        }
        assert_eq!(fingerprint.finish(), "71a90b74c087cb09");
    }
}
