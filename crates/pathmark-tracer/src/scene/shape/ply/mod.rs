//! The faces of a PLY file (Turk, "The PLY Polygon File Format", 1994), text or binary: the element `vertex` with
//! `x`, `y` and `z`, then the element `face` with a list `vertex_indices` or `vertex_index`. The rest of the file is
//! not used.
//!
//! A file is read element by element and never in memory as a whole.

mod header;
#[cfg(test)]
mod tests;

use super::polygon::MOST_CORNERS;
use crate::digest::Fingerprint;
use crate::error::{InputError, Result};
use crate::input::{BYTE_ORDER_MARK, coordinate_limit, unreadable};
use crate::math::Vec3;
use header::{Element, Encoding, Header, Property, Shape, Type, Use};
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::ops::Range;
use std::path::Path;

/// The longest header, and the longest line of a text, in bytes; real ones are far shorter.
const LONGEST: u64 = 1 << 20;

/// A reader that adds all that it reads to a hash.
struct Hashed<'a, R> {
    file: R,
    hash: &'a mut Fingerprint,
}

impl<R: Read> Read for Hashed<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.hash.update(&buffer[..count]);
        Ok(count)
    }
}

/// A PLY file.
struct Ply<'a, R> {
    file: BufReader<Hashed<'a, R>>,
    name: &'a str,
    encoding: Encoding,
    /// The current line of a text, and its number.
    line: String,
    number: usize,
    /// The start of the next word in the line.
    at: usize,
}

/// Reads a file and passes on the corners of each face. The whole contents go into `hash`. Returns whether more data
/// follows the last element.
pub(super) fn read(
    file: impl Read,
    name: &str,
    hash: &mut Fingerprint,
    face: impl FnMut(&[Vec3]) -> Result<()>,
) -> Result<bool> {
    let file = BufReader::new(Hashed { file, hash });
    let mut ply = Ply { file, name, encoding: Encoding::Text, line: String::new(), number: 0, at: 0 };
    let header = Header::read(
        || Ok(ply.next_line()?.then(|| ply.line.clone())),
        |problem, line| problem.in_file(name, Some((line, 1))),
    )?;
    ply.encoding = header.encoding;
    ply.read(&header.elements, face)
}

impl<R: Read> Ply<'_, R> {
    fn read(&mut self, elements: &[Element], mut face: impl FnMut(&[Vec3]) -> Result<()>) -> Result<bool> {
        let mut vertices: Option<Vec<Vec3>> = None;
        let (mut corners, mut places) = (Vec::new(), Vec::new());
        for element in elements {
            // Elements without properties take no bytes in a binary file, whatever number the header states.
            if element.properties.is_empty() && self.encoding != Encoding::Text {
                continue;
            }
            for index in 0..element.count {
                let mut position = [0.0; 3];
                corners.clear();
                self.read_element(element, index, &mut position, &mut corners)?;
                match element.name.as_str() {
                    "vertex" => vertices.get_or_insert_default().push(position.into()),
                    "face" => {
                        let Some(vertices) = &vertices else {
                            return Err(self.refused("element", "face", "comes before the vertices").into());
                        };
                        places.clear();
                        places.extend(corners.iter().map_while(|corner| vertices.get(*corner as usize)));
                        if places.len() < corners.len().max(3) {
                            return Err(self.bad_face(index, &corners, vertices.len()).into());
                        }
                        face(&places)?;
                    }
                    _ => {}
                }
            }
            if element.name == "vertex" {
                vertices.get_or_insert_default();
            }
        }
        self.has_more()
    }

    /// Creates an error at the current line, if there are lines.
    fn refused(&self, field: &str, value: &str, problem: &str) -> InputError {
        self.refused_at(&(0..0), field, value, problem)
    }

    /// The same at a word of the line.
    fn refused_at(&self, word: &Range<usize>, field: &str, value: &str, problem: &str) -> InputError {
        let column = self.line[..word.start].chars().count() + 1;
        let value: String = value.chars().take(80).collect();
        let has_lines = self.encoding == Encoding::Text;
        InputError::new(field, value, problem).in_file(self.name, has_lines.then_some((self.number, column)))
    }

    fn bad_face(&self, index: u64, corners: &[u32], vertices: usize) -> InputError {
        let corners = corners.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
        let error = self.refused("face", &corners, &format!("is not a valid list of corners of face {index}"));
        error.allowed(match vertices {
            0 => "vertex numbers, but the file has no vertices".to_string(),
            count => format!("three or more vertex numbers, 0 to {}", count - 1),
        })
    }

    /// Reads a line of a text; returns whether there was one.
    fn next_line(&mut self) -> Result<bool> {
        let mut line = std::mem::take(&mut self.line).into_bytes();
        line.clear();
        let length = self.file.by_ref().take(LONGEST).read_until(b'\n', &mut line);
        self.number += 1;
        self.at = 0;
        let length = length.map_err(|error| unreadable(Path::new(self.name), error))?;
        if length as u64 == LONGEST {
            return Err(self.refused("line", "", "is longer than 1 MiB").into());
        }
        self.line = String::from_utf8(line).map_err(|_| self.refused("line", "", "is not UTF-8 text"))?;
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(length > 0)
    }

    /// Reads an element; `index` is its number among the elements of its kind.
    fn read_element(
        &mut self,
        element: &Element,
        index: u64,
        position: &mut [f64; 3],
        corners: &mut Vec<u32>,
    ) -> Result<()> {
        let is_text = self.encoding == Encoding::Text;
        if is_text && !self.next_line()? {
            return Err(self.missing(element, index).into());
        }
        for property in &element.properties {
            let place = Place { element, index, property };
            match (property.shape, property.used) {
                (Shape::One(of), Use::Coordinate(axis)) => {
                    let in_range = |number| coordinate_limit(number).then_some(number);
                    let allowed = "-1e100 to 1e100 in each coordinate";
                    position[axis] = self.number(of, &place, in_range, allowed)?;
                }
                (Shape::One(of), _) => {
                    self.number(of, &place, Some, "")?;
                }
                (Shape::List { length, of }, used) => {
                    let is_length = |number: f64| (number >= 0.0).then_some(number as u64);
                    let length = self.number(length, &place, is_length, "a length of 0 or more")?;
                    if used == Use::Corners && length > MOST_CORNERS as u64 {
                        let error = self.refused("face", &index.to_string(), &format!("has {length} corners"));
                        return Err(error.allowed(format!("at most {MOST_CORNERS}")).into());
                    }
                    for _ in 0..length {
                        if used == Use::Corners {
                            let is_vertex = |number: f64| (number >= 0.0).then_some(number as u32);
                            corners.push(self.number(of, &place, is_vertex, "vertex numbers, from 0")?);
                        } else {
                            self.number(of, &place, Some, "")?;
                        }
                    }
                }
            }
        }
        match self.next_word() {
            Some(word) if is_text => {
                let problem = format!("follows the last property of {} {index}", element.name);
                Err(self.refused_at(&word, "number", &self.line[word.clone()], &problem).into())
            }
            _ => Ok(()),
        }
    }

    fn missing(&self, element: &Element, index: u64) -> InputError {
        let Element { name, count, .. } = element;
        let problem = format!("is missing: the header declares {count} of them, but the file ends earlier");
        self.refused(name, &index.to_string(), &problem)
    }

    /// Moves behind the next word of the line and returns its place.
    fn next_word(&mut self) -> Option<Range<usize>> {
        let word = self.line[self.at..].split_whitespace().next()?;
        let start = word.as_ptr() as usize - self.line.as_ptr() as usize;
        self.at = start + word.len();
        Some(start..self.at)
    }

    /// Reads a number and converts it by `convert`, which refuses it by `None`.
    fn number<T>(
        &mut self,
        of: &Type,
        place: &Place<'_>,
        convert: impl Fn(f64) -> Option<T>,
        allowed: &str,
    ) -> Result<T> {
        let Place { element, index, property } = *place;
        let is_text = self.encoding == Encoding::Text;
        let word = if is_text { self.next_word() } else { None };
        let number = match &word {
            Some(word) => (of.parsed)(&self.line[word.clone()]),
            None if is_text => {
                let problem = format!("has too few numbers: the line ends before {} is complete", property.name);
                return Err(self.refused(&element.name, &index.to_string(), &problem).into());
            }
            None => Some(self.binary(of, element, index)?),
        };
        if let Some(found) = number.and_then(convert) {
            return Ok(found);
        }
        let (problem, allowed) = match number {
            None => ("is not a number of its type", of.name()),
            Some(_) => ("is out of range", allowed),
        };
        let problem = format!("{problem} in {} {index}", element.name);
        let error = match word {
            Some(word) => self.refused_at(&word, &property.name, &self.line[word.clone()], &problem),
            None => self.refused(&property.name, &number.unwrap_or(f64::NAN).to_string(), &problem),
        };
        Err(error.allowed(allowed).into())
    }

    /// Reads a number of a binary file.
    fn binary(&mut self, of: &Type, element: &Element, index: u64) -> Result<f64> {
        let size = of.size;
        let mut bytes = [0; 8];
        // Copies of a constant size are faster. Bytes behind the number are not decoded.
        if let Some(next) = self.file.buffer().first_chunk() {
            bytes = *next;
            self.file.consume(size);
        } else if let Err(error) = self.file.read_exact(&mut bytes[..size]) {
            return Err(match error.kind() {
                ErrorKind::UnexpectedEof => self.missing(element, index).into(),
                _ => unreadable(Path::new(self.name), error),
            });
        }
        if self.encoding == Encoding::BigEndian {
            bytes = (u64::from_be_bytes(bytes) >> (64 - 8 * size)).to_le_bytes();
        }
        Ok((of.decoded)(bytes))
    }

    /// Reads the rest of the file, for the hash; returns whether it holds more than white space.
    fn has_more(&mut self) -> Result<bool> {
        let mut has_more = false;
        loop {
            let rest = self.file.fill_buf().map_err(|error| unreadable(Path::new(self.name), error))?;
            if rest.is_empty() {
                return Ok(has_more);
            }
            has_more |= self.encoding != Encoding::Text || !rest.trim_ascii().is_empty();
            let length = rest.len();
            self.file.consume(length);
        }
    }
}

/// The position of a number.
struct Place<'a> {
    element: &'a Element,
    index: u64,
    property: &'a Property,
}
