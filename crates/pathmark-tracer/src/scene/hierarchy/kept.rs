//! Stored hierarchies, for later processes: `--cache FOLDER`.
//!
//! The key depends on the input of the construction: the accelerator's name and the padded boxes of the primitives. A
//! scene that is edited, scaled or generated anew therefore has another key. A scene whose materials, lights or camera
//! change keeps its hierarchy.

use super::tree_file::{BLOCK, MAGIC};
use super::{Hierarchy, Item};
use crate::error::Result;
use sha2::{Digest, Sha256};
use std::fmt::{self, Write as _};
use std::io::{self, Read, Write};

/// A store of bytes by key, such as a folder. Scenes of few primitives are not stored, because building is faster than
/// reading.
pub trait TreeStore: fmt::Debug + Send + Sync {
    /// Passes the bytes of that key to `read`, whose error means that they are damaged. Returns `false` if there are
    /// none.
    fn find(&self, key: &str, read: &mut dyn FnMut(&mut dyn Read) -> io::Result<()>) -> Result<bool>;

    /// Stores the output of `write`, all of it or nothing.
    fn keep(&self, key: &str, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()>;
}

/// The least number of primitives whose hierarchy is stored. With fewer, building takes milliseconds, less than opening
/// a file on many systems.
pub(super) const WORTH_KEEPING: usize = 4096;

/// Returns the stored hierarchy; if there is none, builds and stores it.
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
    let numbers: Vec<u32> = items.iter().map(|item| item.number).collect();
    let built = build(items);
    if let Some(tree) = &built {
        store.keep(&key, &mut |file| tree.write(file, &numbers))?;
    }
    Ok(built)
}

/// Returns the key: the first half of a SHA-256, 32 hexadecimal digits.
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

#[cfg(test)]
mod tests {
    use super::super::tree_file::tests::items;
    use super::*;
    use crate::error::Error;
    use crate::scene::{Scene, load};
    use std::collections::HashMap;
    use std::sync::Mutex;

    /// A store in memory.
    #[derive(Debug, Default)]
    struct Shelf(Mutex<HashMap<String, Vec<u8>>>);

    impl TreeStore for Shelf {
        fn find(&self, key: &str, read: &mut dyn FnMut(&mut dyn Read) -> io::Result<()>) -> Result<bool> {
            let bytes = self.0.lock().unwrap().get(key).cloned();
            bytes.map_or(Ok(false), |bytes| {
                read(&mut bytes.as_slice()).map(|()| true).map_err(|e| Error::system("reading", key, e))
            })
        }

        fn keep(&self, key: &str, write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<()> {
            let mut bytes = Vec::new();
            write(&mut bytes).unwrap();
            assert!(self.0.lock().unwrap().insert(key.to_string(), bytes).is_none(), "{key} is kept already");
            Ok(())
        }
    }

    #[test]
    fn a_kept_hierarchy_equals_the_built_one() {
        let shelf = Shelf::default();
        for name in ["spheres:5000", "bumpy-ball:5000"] {
            let scene = load(name).unwrap();
            for accelerator in ["median", "sah"] {
                let built = scene.hierarchy_by(accelerator, None).unwrap();
                assert!(built.is_some());
                // The first call builds and stores the tree, the second finds it: the shelf refuses to store a key
                // twice.
                for _ in 0..2 {
                    assert!(scene.hierarchy_by(accelerator, Some(&shelf)).unwrap() == built, "{name}, {accelerator}");
                }
            }
            assert_eq!(scene.hierarchy_by("none", Some(&shelf)).unwrap(), None);
        }
        assert_eq!(shelf.0.lock().unwrap().len(), 4);
    }

    #[test]
    fn a_kept_hierarchy_is_not_built_again() {
        let (scene, shelf) = (load("spheres:5000").unwrap(), Shelf::default());
        let built = found_or_built("sah", items(&scene), &shelf, |_| scene.hierarchy_by("sah", None).unwrap()).unwrap();
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
}
