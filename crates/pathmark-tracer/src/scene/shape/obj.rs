//! The faces of a Wavefront OBJ file (Wavefront Technologies, "Object Files", appendix B1 of the Advanced Visualizer
//! manual): lines `v`, `f`, `o` and `g`. A backslash at its end continues a line, and a word that begins with `#`
//! begins a comment. The rest of the file is not used.
//!
//! A file is read line by line and never in memory as a whole.

use super::polygon::MOST_CORNERS;
use crate::digest::Fingerprint;
use crate::error::{Error, InputError, Result};
use crate::input::{BYTE_ORDER_MARK, coordinate_limit, unreadable};
use crate::math::Vec3;
use std::collections::BTreeSet;
use std::io::BufRead;
use std::path::Path;

/// The longest line of a text in bytes; real lines are far shorter.
pub(super) const LONGEST_LINE: u64 = 1 << 20;

/// First words of unused lines, and the contents of such lines.
const UNUSED: [(&str, &str); 5] = [
    ("vn", "normals"),
    ("vt", "texture coordinates"),
    ("mtllib", "materials"),
    ("usemtl", "materials"),
    ("l", "lines"),
];

/// The parts of a file besides its faces.
#[derive(Default)]
pub(super) struct Found {
    /// The names of the parts that are not used.
    pub(super) unused: Vec<&'static str>,
    /// The names of objects and groups.
    pub(super) objects: BTreeSet<String>,
}

/// Reads a file and passes on the corners of each face, or only those of one object. The whole contents go into `hash`.
pub(super) fn read(
    file: impl BufRead,
    name: &str,
    object: Option<&str>,
    hash: &mut Fingerprint,
    face: impl FnMut(&[Vec3]) -> Result<()>,
) -> Result<Found> {
    let mut statements = Statements { file, name, hash, text: Vec::new(), first: 1, lines: 0, before: 0 };
    let mut obj = Obj {
        object,
        is_wanted: object.is_none(),
        vertices: Vec::new(),
        corners: Vec::new(),
        face,
        found: Found::default(),
    };
    while statements.next()? {
        let statement = statements.current()?;
        obj.take(&statement)?;
    }
    Ok(obj.found)
}

/// A reader of statements: lines with the lines that continue them.
struct Statements<'a, R> {
    file: R,
    /// The file's name in errors.
    name: &'a str,
    hash: &'a mut Fingerprint,
    /// The current statement with its line ends. Backslashes that continue it are blank.
    text: Vec<u8>,
    /// The number of its first line, and of its last one.
    first: usize,
    lines: usize,
    before: usize,
}

/// Whether a statement holds numbers. Other statements hold names and paths, which may end in a backslash.
fn has_numbers(statement: &[u8]) -> bool {
    let statement = statement.strip_prefix(BYTE_ORDER_MARK.as_bytes()).unwrap_or(statement).trim_ascii_start();
    let keyword = statement.split(u8::is_ascii_whitespace).next().unwrap_or_default();
    matches!(keyword, b"v" | b"vt" | b"vn" | b"vp" | b"f" | b"l" | b"p")
}

/// Whether the next line continues this one: it ends in a backslash outside of a comment.
fn is_continued(line: &[u8]) -> bool {
    let line = line.trim_ascii_end();
    let mut words = line.split(u8::is_ascii_whitespace);
    line.ends_with(b"\\") && !words.any(|word| word.starts_with(b"#"))
}

impl<R: BufRead> Statements<'_, R> {
    /// Reads the next statement; returns whether there was one.
    fn next(&mut self) -> Result<bool> {
        self.before += self.text.len();
        self.text.clear();
        self.first = self.lines + 1;
        loop {
            let start = self.text.len();
            let read = self.file.read_until(b'\n', &mut self.text);
            read.map_err(|error| unreadable(Path::new(self.name), error))?;
            let line = &mut self.text[start..];
            if line.is_empty() {
                return Ok(start > 0);
            }
            self.hash.update(line);
            self.lines += 1;
            let is_continued = is_continued(line) && (start > 0 || has_numbers(line));
            if is_continued && let Some(backslash) = line.iter_mut().rfind(|byte| **byte == b'\\') {
                *backslash = b' ';
            }
            if self.lines == 1 && line.starts_with(BYTE_ORDER_MARK.as_bytes()) {
                self.text.drain(..BYTE_ORDER_MARK.len());
                self.before += BYTE_ORDER_MARK.len();
            }
            if !is_continued {
                return Ok(true);
            }
            if self.text.len() as u64 > LONGEST_LINE {
                let error = InputError::new("line", "", "is continued to more than 1 MiB");
                return Err(error.in_file(self.name, Some((self.first, 1))).into());
            }
        }
    }

    fn current(&self) -> Result<Statement<'_>> {
        let text = std::str::from_utf8(&self.text).map_err(|e| {
            let at = self.before + e.valid_up_to();
            Error::from(InputError::new("file", self.name, format!("is not UTF-8 text at byte {at}")))
        })?;
        Ok(Statement { text, line: self.first, name: self.name })
    }
}

/// A statement and its position.
struct Statement<'a> {
    text: &'a str,
    line: usize,
    name: &'a str,
}

impl<'a> Statement<'a> {
    /// Its words before a comment.
    fn words(&self) -> impl Iterator<Item = &'a str> + Clone {
        // A comment may follow a number without a blank; a name may contain the sign.
        let end = if has_numbers(self.text.as_bytes()) { self.text.find('#') } else { None };
        let text = &self.text[..end.unwrap_or(self.text.len())];
        text.split_whitespace().take_while(|word| !word.starts_with('#'))
    }

    /// Creates an error at the words `from` and all after it; at the statement's first line if there is none.
    fn error(&self, field: &str, from: Option<&str>, value: &str, problem: &str, allowed: String) -> Error {
        // Words are slices of the text.
        let at = from.map_or(0, |from| from.as_ptr() as usize - self.text.as_ptr() as usize);
        let before = &self.text[..at];
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        let place = (self.line + before.matches('\n').count(), column);
        let value: String = value.chars().take(80).collect();
        InputError::new(field, value, problem).allowed(allowed).in_file(self.name, Some(place)).into()
    }
}

/// The state of the reader.
struct Obj<'a, F> {
    /// The wanted object; all if `None`.
    object: Option<&'a str>,
    /// Whether the current object is wanted.
    is_wanted: bool,
    vertices: Vec<Vec3>,
    corners: Vec<Vec3>,
    face: F,
    found: Found,
}

impl<F: FnMut(&[Vec3]) -> Result<()>> Obj<'_, F> {
    fn take(&mut self, statement: &Statement<'_>) -> Result<()> {
        let mut words = statement.words();
        match words.next() {
            Some("v") => self.vertices.push(vertex(statement, words)?),
            Some("f") => self.take_face(statement, words)?,
            Some("o" | "g") => {
                let name = words.collect::<Vec<_>>().join(" ");
                self.is_wanted = self.object.is_none_or(|object| object == name);
                self.found.objects.insert(name);
            }
            Some(word) => {
                let left_out = UNUSED.iter().find(|(own, _)| *own == word).map(|(_, what)| *what);
                self.found.unused.extend(left_out.filter(|what| !self.found.unused.contains(what)));
            }
            None => {}
        }
        Ok(())
    }

    fn take_face<'t>(&mut self, statement: &Statement<'_>, words: impl Iterator<Item = &'t str> + Clone) -> Result<()> {
        self.corners.clear();
        for word in words.clone() {
            let index = word.split('/').next().and_then(|index| index.parse::<i64>().ok()).unwrap_or(0);
            // Negative numbers count from the last vertex.
            let from = if index < 0 { self.vertices.len() as i64 } else { -1 };
            let vertex = usize::try_from(index.saturating_add(from)).ok().and_then(|at| self.vertices.get(at));
            let Some(vertex) = vertex else {
                let allowed = match self.vertices.len() {
                    0 => "the number of a vertex in an earlier line".to_string(),
                    most => format!("1 to {most}, or -{most} to -1: the vertices of earlier lines"),
                };
                return Err(statement.error("f", Some(word), word, "refers to a vertex that does not exist", allowed));
            };
            self.corners.push(*vertex);
        }
        if !(3..=MOST_CORNERS).contains(&self.corners.len()) {
            let first = words.clone().next();
            let corners = words.collect::<Vec<_>>().join(" ");
            let allowed = if self.corners.len() < 3 {
                "at least three corners".to_string()
            } else {
                format!("at most {MOST_CORNERS} corners")
            };
            return Err(statement.error("f", first, &corners, "is not a face", allowed));
        }
        if self.is_wanted { (self.face)(&self.corners) } else { Ok(()) }
    }
}

/// Reads three coordinates; more numbers are weights or colours.
fn vertex<'t>(statement: &Statement<'_>, words: impl Iterator<Item = &'t str> + Clone) -> Result<Vec3> {
    let mut place = [0.0; 3];
    let mut coordinates = words.clone();
    for coordinate in &mut place {
        let Some(word) = coordinates.next() else {
            let (first, found) = (words.clone().next(), words.collect::<Vec<_>>().join(" "));
            return Err(statement.error("v", first, &found, "is not a point", "three coordinates".to_string()));
        };
        let number = word.parse().ok().filter(|number| coordinate_limit(*number));
        *coordinate = number.ok_or_else(|| {
            let allowed = "-1e100 to 1e100 in each coordinate".to_string();
            statement.error("v", Some(word), word, "is not a number in the allowed range", allowed)
        })?;
    }
    Ok(place.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";

    fn faces(text: &str, object: Option<&str>) -> Result<Vec<Vec<Vec3>>> {
        let mut found = Vec::new();
        read(text.as_bytes(), "thing.obj", object, &mut Fingerprint::default(), |face| {
            found.push(face.to_vec());
            Ok(())
        })?;
        Ok(found)
    }

    fn square(corners: &[usize]) -> Vec<Vec3> {
        let vertices = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        corners.iter().map(|corner| vertices[*corner].into()).collect()
    }

    /// Every way to write the square's four corners.
    #[test]
    fn a_face_may_be_continued_commented_and_counted_from_the_end() {
        let faces_of = |text: &str| faces(&format!("{SQUARE}{text}"), None).unwrap();
        for text in [
            "f 1 2 3 4",
            "f 1 2 3 4 # floor\n",
            "f 1 2 3 4#floor\n",
            "g right\\\nusemtl C:\\dir\\\nf 1 2 3 4\n",
            "f 1 2 3 4 #floor \\\n#\n",
            "f 1 2 3 \\\n  4\n",
            "f 1 \\\r\n2\\ \n 3 4\r\n",
            "f \\\n\\\n 1 2 3 4",
            "f -4 -3 -2 -1\n",
            "f 1/1 2//2 3/3/3 -1/7\n",
        ] {
            assert_eq!(faces_of(text), [square(&[0, 1, 2, 3])], "{text:?}");
        }
        assert_eq!(faces_of("# a path \\\nf 1 2 3\nf 2 3 4\n"), [square(&[0, 1, 2]), square(&[1, 2, 3])]);
        assert_eq!(faces(&format!("v 9 9 \\\n9\n{SQUARE}f 2 3 4"), None).unwrap(), [square(&[0, 1, 2])]);
    }

    /// The mark hides neither a vertex nor an object.
    #[test]
    fn a_byte_order_mark_is_no_part_of_the_first_line() {
        assert_eq!(faces(&format!("\u{feff}{SQUARE}f 1 2 3"), None).unwrap(), [square(&[0, 1, 2])]);
        let text = format!("\u{feff}o near\n{SQUARE}f 1 2 3\no far\nf 2 3 4\nf 1 2 4\ng near\nf 1 3 4");
        assert_eq!(faces(&text, Some("near")).unwrap(), [square(&[0, 1, 2]), square(&[0, 2, 3])]);
        assert_eq!(faces(&text, Some("far")).unwrap(), [square(&[1, 2, 3]), square(&[0, 1, 3])]);
        assert!(faces(&text, Some("none")).unwrap().is_empty());
    }

    /// A mistake behind a continued line is on its own line.
    #[test]
    fn mistakes_have_a_line_and_a_column() {
        let said = |text: &str| faces(&format!("{SQUARE}{text}"), None).unwrap_err().to_string();
        assert!(said("f 1 2 \\\n 3 9\n").starts_with("thing.obj:6:4: f = 9: "), "{}", said("f 1 2 \\\n 3 9\n"));
        assert!(said("f 11 1 2").starts_with("thing.obj:5:3: f = 11: "));
        assert!(said("f \u{e4} 1 2").starts_with("thing.obj:5:3: f = \u{e4}: "));
        assert!(said("v 1 2 \\\n#\nf").starts_with("thing.obj:5:3: v = 1 2: "));
        assert!(said("f 1 2").starts_with("thing.obj:5:3: f = 1 2: "));
        assert!(said(&format!("f{}", " 1".repeat(MOST_CORNERS + 1))).contains("at most 4096 corners"));
        assert!(said(&"f 1 2 \\\n".repeat(200_000)).contains("is continued to more than 1 MiB"));
    }
}
