//! Paths of files as addresses: folders are named by users.

use std::path::{Component, Path, PathBuf};

/// A path as the target of a link. Bytes with a meaning of their own in an address are percent-encoded (RFC 3986, 2.1).
pub(crate) fn href(path: &str) -> String {
    let encoded = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    path.bytes().map(encoded).collect()
}

/// The way from a folder to another one, both as complete paths.
pub(crate) fn way(from: &Path, to: &Path) -> PathBuf {
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) = (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[common..].iter().map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(to[common..].iter().copied()).collect();
    if way.as_os_str().is_empty() { PathBuf::from(".") } else { way }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_paths_stay_as_they_are() {
        assert_eq!(href("../thread-scaling/records_1.csv~"), "../thread-scaling/records_1.csv~");
    }

    /// The codes are those of ASCII; ü has two bytes in UTF-8.
    #[test]
    fn bytes_that_an_address_would_read_are_encoded() {
        assert_eq!(href("a #1/50 %?ü"), "a%20%231/50%20%25%3F%C3%BC");
        assert_eq!(href("a:b(c)"), "a%3Ab%28c%29");
    }

    #[test]
    fn ways_between_folders_are_relative() {
        let of = |from: &str, to: &str| way(Path::new(from), Path::new(to)).display().to_string();
        assert_eq!(of("/a/b", "/a/b"), ".");
        assert_eq!(of("/a/b", "/a/b/out"), "out");
        assert_eq!(of("/a/paper", "/a/out"), "../out");
    }
}
