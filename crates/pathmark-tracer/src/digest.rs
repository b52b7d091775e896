//! Fingerprints: the first 64 bits of a SHA-256 as a short name of some content.

use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Collects bytes and computes their fingerprint.
#[derive(Default)]
pub struct Fingerprint(Sha256);

impl Fingerprint {
    pub fn update(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Returns the fingerprint: 16 hexadecimal digits.
    pub fn finish(self) -> String {
        let mut text = String::with_capacity(16);
        for byte in self.0.finalize().iter().take(8) {
            // Writing to a string cannot fail.
            let _ = write!(text, "{byte:02x}");
        }
        text
    }
}

pub fn of_text(text: &str) -> String {
    let mut fingerprint = Fingerprint::default();
    fingerprint.update(text.as_bytes());
    fingerprint.finish()
}

#[cfg(test)]
mod tests {
    /// The standard's own example: SHA-256 of "abc" begins ba7816bf 8f01cfea (FIPS 180-4).
    #[test]
    fn is_sha_256() {
        assert_eq!(super::of_text("abc"), "ba7816bf8f01cfea");
    }
}
