//! The used parts of a Wavefront OBJ file: vertices, faces without normals and texture coordinates, and the names of
//! objects. All are checked here, because the parser that cuts the faces into triangles does not report the position of
//! a mistake.
//!
//! A file is read line by line and never in memory as a whole.

use crate::digest::Fingerprint;
use crate::error::{Error, InputError, Result};
use crate::input::{coordinate_limit, unreadable};
use std::fmt::Write;
use std::io::{self, BufRead, ErrorKind, Read};
use std::path::Path;

/// First words of unused lines, and the contents of such lines.
const UNUSED: [(&str, &str); 5] = [
    ("vn", "normals"),
    ("vt", "texture coordinates"),
    ("mtllib", "materials"),
    ("usemtl", "materials"),
    ("l", "lines"),
];

/// A reader that passes on only the used parts of a file. The first mistake ends it: [`Essence::error`].
pub(super) struct Essence<'a, R> {
    file: R,
    /// The file's name in errors.
    name: &'a str,
    hash: &'a mut Fingerprint,
    /// The names of the parts that were left out.
    pub(super) unused: Vec<&'static str>,
    /// The error that ended it before the file's end.
    pub(super) error: Option<Error>,
    line: Vec<u8>,
    lines: usize,
    bytes: usize,
    vertices: i64,
    /// The used text of the current line; the parser has read it up to `read`.
    text: String,
    read: usize,
}

impl<'a, R: BufRead> Essence<'a, R> {
    /// Wraps a file; its whole contents go into `hash`.
    pub(super) fn new(file: R, name: &'a str, hash: &'a mut Fingerprint) -> Self {
        Self {
            file,
            name,
            hash,
            unused: Vec::new(),
            error: None,
            line: Vec::new(),
            lines: 0,
            bytes: 0,
            vertices: 0,
            text: String::new(),
            read: 0,
        }
    }

    /// Reads the next used line; returns whether there was one.
    fn next_line(&mut self) -> io::Result<bool> {
        self.text.clear();
        self.read = 0;
        while self.text.is_empty() {
            self.line.clear();
            match self.file.read_until(b'\n', &mut self.line) {
                Ok(0) => return Ok(false),
                Ok(_) => {}
                Err(e) => return Err(self.fail(unreadable(Path::new(self.name), e))),
            }
            self.hash.update(&self.line);
            self.lines += 1;
            let line = std::mem::take(&mut self.line);
            let found = self.take(&line);
            self.bytes += line.len();
            self.line = line;
            if let Err(mistake) = found {
                return Err(self.fail(mistake));
            }
        }
        Ok(true)
    }

    /// Keeps the error for the caller, and returns one that stops the parser.
    fn fail(&mut self, error: Error) -> io::Error {
        self.error = Some(error);
        ErrorKind::InvalidData.into()
    }

    /// Takes the used part of a line.
    fn take(&mut self, line: &[u8]) -> Result<()> {
        let line = std::str::from_utf8(line).map_err(|e| {
            let at = self.bytes + e.valid_up_to();
            Error::from(InputError::new("file", self.name, format!("is not UTF-8 text at byte {at}")))
        })?;
        let error = |field: &str, value: &str, problem: &str, allowed: String| {
            let value: String = value.chars().take(80).collect();
            let column = line.find(&value).map_or(1, |at| line[..at].chars().count() + 1);
            let place = Some((self.lines, column));
            Error::from(InputError::new(field, value, problem).allowed(allowed).in_file(self.name, place))
        };
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let coordinates: Vec<&str> = words.take(3).collect();
                if coordinates.len() < 3 {
                    return Err(error("v", &coordinates.join(" "), "is not a point", "three coordinates".to_string()));
                }
                let is_good = |word: &str| word.parse().is_ok_and(coordinate_limit);
                if let Some(bad) = coordinates.iter().find(|word| !is_good(word)) {
                    let allowed = "-1e100 to 1e100 in each coordinate".to_string();
                    return Err(error("v", bad, "is not a number in the allowed range", allowed));
                }
                self.vertices += 1;
                // Writing to a string cannot fail.
                let _ = writeln!(self.text, "v {}", coordinates.join(" "));
            }
            Some("f") => {
                let mut face = "f".to_string();
                let mut count = 0;
                for corner in words.clone() {
                    let index = corner.split('/').next().and_then(|index| index.parse::<i64>().ok());
                    let there = index.filter(|index| (1..=self.vertices).contains(&index.saturating_abs()));
                    let Some(index) = there else {
                        let allowed = match self.vertices {
                            0 => "the number of a vertex in an earlier line".to_string(),
                            most => format!("1 to {most}, or -{most} to -1: the vertices of earlier lines"),
                        };
                        return Err(error("f", corner, "refers to a vertex that does not exist", allowed));
                    };
                    let _ = write!(face, " {index}");
                    count += 1;
                }
                if count < 3 {
                    let corners = words.collect::<Vec<_>>().join(" ");
                    return Err(error("f", &corners, "is not a face", "at least three corners".to_string()));
                }
                self.text = face + "\n";
            }
            Some(name @ ("o" | "g")) => {
                let _ = writeln!(self.text, "{name} {}", words.collect::<Vec<_>>().join(" "));
            }
            Some(word) => {
                let left_out = UNUSED.iter().find(|(own, _)| *own == word).map(|(_, what)| *what);
                self.unused.extend(left_out.filter(|what| !self.unused.contains(what)));
            }
            None => {}
        }
        Ok(())
    }
}

impl<R: BufRead> Read for Essence<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.read == self.text.len() && !self.next_line()? {
            return Ok(0);
        }
        let count = buffer.len().min(self.text.len() - self.read);
        buffer[..count].copy_from_slice(&self.text.as_bytes()[self.read..self.read + count]);
        self.read += count;
        Ok(count)
    }
}
