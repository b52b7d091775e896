//! Files that are given as meshes by mistake, by how they begin.

use crate::input::BYTE_ORDER_MARK;

/// How a file begins, and the kind of such files. Lower case stands for either case.
const KINDS: [(&[u8], &str); 10] = [
    (b"version https://git-lfs", "is a pointer of Git LFS, not the mesh itself: `git lfs pull` fetches the mesh"),
    (b"<!doctype html", "is a web page"),
    (b"<html", "is a web page"),
    (b"<?xml", "is an XML file"),
    (b"solid", "is an STL file"),
    (b"off", "is an OFF file"),
    (b"coff", "is an OFF file"),
    (b"noff", "is an OFF file"),
    (b"gltf", "is a glTF file"),
    (b"{", "is a JSON file, such as glTF"),
];

/// Returns the problem of a mesh file that begins with these bytes; `None` if it may be a mesh. `is_ply` says whether
/// its name is one of a PLY file.
pub(super) fn problem(start: &[u8], is_ply: bool) -> Option<&'static str> {
    let start = start.strip_prefix(BYTE_ORDER_MARK.as_bytes()).unwrap_or(start).trim_ascii_start();
    // A keyword ends there; the name of a group may begin like it. In glTF a number follows as bytes.
    let is_word = |of: &[u8]| of.iter().all(u8::is_ascii_lowercase) && of != b"gltf";
    let is_start = |of: &[u8]| {
        start.get(..of.len()).is_some_and(|start| start.eq_ignore_ascii_case(of))
            && (!is_word(of) || start.get(of.len()).is_none_or(u8::is_ascii_whitespace))
    };
    if let Some((_, problem)) = KINDS.iter().find(|(start, _)| is_start(start)) {
        return Some(problem);
    }
    if is_ply {
        return None;
    }
    if start.starts_with(b"ply\n") || start.starts_with(b"ply\r\n") {
        return Some("is a PLY file, whose name must end in .ply");
    }
    start.contains(&0).then_some("is a binary file, such as STL")
}

/// Returns the first line as text, for a message.
pub(super) fn first_line(start: &[u8]) -> String {
    let line = start.trim_ascii_start().split(|byte| *byte == b'\n').next().unwrap_or_default();
    String::from_utf8_lossy(line).trim_end().chars().take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_keyword_ends_where_its_word_ends() {
        for foreign in ["off\n8 6 12", "OFF", "solid cube\nfacet", "\u{feff}<html>", "glTF\u{2}"] {
            assert!(problem(foreign.as_bytes(), false).is_some(), "{foreign}");
        }
        for own in ["offset 1\nv 0 0 0", "solids\nv 0 0 0", "\u{feff}v 0 0 0", "# off"] {
            assert_eq!(problem(own.as_bytes(), false), None, "{own}");
        }
    }
}
