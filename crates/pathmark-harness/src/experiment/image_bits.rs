//! Images bit for bit: the checksums of some rows beside those of earlier ones.

use crate::measure::{ImageKey, Record};
use std::collections::{BTreeMap, BTreeSet};

/// The checksums of images. A sound measurement has one for each image.
#[derive(Debug, Default)]
pub struct ImageBits {
    checksums: BTreeMap<ImageKey, BTreeSet<String>>,
}

/// How an image of earlier rows came out again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SameBits {
    Same,
    /// Both checksums, in words.
    Other(String),
    /// There is no such image now.
    Lacking,
}

impl ImageBits {
    /// Adds the images of some rows. Failed rows have none. Samplers that draw other random numbers in each run leave no
    /// checksum.
    pub fn add<'a>(&mut self, rows: impl IntoIterator<Item = &'a Record>) {
        for row in rows.into_iter().filter(|row| row.error.is_empty() && !row.checksum.is_empty()) {
            self.checksums.entry(row.image_key()).or_default().insert(row.checksum.clone());
        }
    }

    /// The images of earlier rows in the order of their keys, each with its bits now.
    pub fn beside<'a>(&'a self, earlier: &'a Self) -> impl Iterator<Item = (&'a ImageKey, SameBits)> {
        let told = |sums: &BTreeSet<String>| sums.iter().cloned().collect::<Vec<String>>().join(" and ");
        earlier.checksums.iter().map(move |(image, old)| {
            let bits = match self.checksums.get(image) {
                None => SameBits::Lacking,
                Some(now) if now == old => SameBits::Same,
                Some(now) => SameBits::Other(format!("checksum {} instead of {}", told(now), told(old))),
            };
            (image, bits)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_the_same_others_or_lacking() {
        let row = |seed: u64, checksum: &str| Record { seed, checksum: checksum.to_string(), ..Record::default() };
        let failed = Record { error: "killed".to_string(), ..row(4, "a") };
        let of = |rows: &[Record]| {
            let mut images = ImageBits::default();
            images.add(rows);
            images
        };
        let earlier = of(&[row(1, "a"), row(1, "a"), row(2, "b"), row(3, "c"), row(5, ""), failed]);
        let now = of(&[row(1, "a"), row(2, "d"), row(2, "b"), row(6, "e")]);
        let found: Vec<(u64, SameBits)> = now.beside(&earlier).map(|(image, bits)| (image.seed, bits)).collect();
        let other = SameBits::Other("checksum b and d instead of b".to_string());
        assert_eq!(found, [(1, SameBits::Same), (2, other), (3, SameBits::Lacking)]);
    }
}
