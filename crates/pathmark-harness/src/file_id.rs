//! File identity: the file that a path leads to, also through links, parent folders or another name of the same file.

use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// The longest chain of links that is followed, as in the system.
const MOST_LINKS: usize = 40;

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FileId {
    device: u64,
    inode: u64,
    /// For a file that does not exist yet: its path below the nearest existing folder.
    below: Vec<OsString>,
}

impl FileId {
    /// Returns the identity of the file that reading or writing `path` would open or create.
    pub fn of(path: &Path) -> io::Result<Self> {
        let path = followed(path)?;
        match fs::metadata(&path) {
            Ok(data) => Ok(Self { device: data.dev(), inode: data.ino(), below: Vec::new() }),
            // Errors on creating it there are reported by the code that creates it.
            Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                let name = path.file_name().ok_or(e)?;
                let mut id = Self::of(folder_of(&path))?;
                id.below.push(name.to_os_string());
                Ok(id)
            }
            Err(e) => Err(e),
        }
    }
}

pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Returns the path that a link leads to, even if the target does not exist yet; a path that is not a link is returned
/// unchanged.
pub fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(target) => path = folder_of(&path).join(target),
            // Not a link, or no such file.
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::from_raw_os_error(libc::ELOOP))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn spellings_of_one_file_are_one() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir_all(at("sub")).unwrap();
        fs::write(at("there"), "").unwrap();
        fs::hard_link(at("there"), at("hard")).unwrap();
        for (link, target) in [("link", "there"), ("far", "link"), ("dangling", "sub/new"), ("up", "sub")] {
            symlink(target, at(link)).unwrap();
        }
        let id = |name: &str| FileId::of(&at(name)).unwrap();
        for spelling in ["./there", "sub/../there", "link", "far", "hard", "up/../there"] {
            assert_eq!(id(spelling), id("there"), "{spelling}");
        }
        for spelling in ["sub/./new", "dangling", "up/new", "sub/../sub/new"] {
            assert_eq!(id(spelling), id("sub/new"), "{spelling}");
        }
        assert_eq!(id("no/such/folder"), id("sub/../no/such/folder"));
        for other in ["sub", "sub/there", "new", "sub/new2"] {
            assert!(id(other) != id("there") && id(other) != id("sub/new"), "{other}");
        }
        symlink("loop", at("loop")).unwrap();
        assert!(FileId::of(&at("loop")).is_err());
    }
}
