//! The triangles of a PLY file (Turk, "The PLY Polygon File Format", 1994), text or binary: the element `vertex` with
//! `x`, `y` and `z`, then the element `face` with a list `vertex_indices` or `vertex_index`. The rest of the file is
//! not used.
//!
//! A file is read element by element and never in memory as a whole.

use crate::digest::Fingerprint;
use crate::error::{Error, InputError, Result};
use crate::input::{coordinate_limit, unreadable};
use crate::math::Vec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// The longest header, and the longest line of a text, in bytes; real ones are far shorter.
const LONGEST: u64 = 1 << 20;

/// The names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A vertex, a face, or an element of another kind.
#[derive(Default)]
struct Element {
    position: [f64; 3],
    /// `None` if a number is below 0.
    corners: Option<Vec<u32>>,
}

fn number(property: &Property) -> f64 {
    match *property {
        Property::Char(value) => value.into(),
        Property::UChar(value) => value.into(),
        Property::Short(value) => value.into(),
        Property::UShort(value) => value.into(),
        Property::Int(value) => value.into(),
        Property::UInt(value) => value.into(),
        Property::Float(value) => value.into(),
        Property::Double(value) => value,
        _ => f64::NAN,
    }
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            "x" => self.position[0] = number(&property),
            "y" => self.position[1] = number(&property),
            "z" => self.position[2] = number(&property),
            _ if CORNERS.contains(&name) => self.corners = property.to_u32_list(),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// A reader that adds all that it reads to a hash.
struct Hashed<'a, R> {
    file: R,
    hash: &'a mut Fingerprint,
    /// The error of the last read: the parser keeps only its text.
    error: Option<io::Error>,
}

impl<R: Read> Read for Hashed<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer).map_err(|error| {
            let kind = error.kind();
            self.error = Some(error);
            io::Error::from(kind)
        })?;
        self.hash.update(&buffer[..count]);
        Ok(count)
    }
}

/// A PLY file and its header.
struct Ply<'a, R: Read> {
    file: BufReader<Hashed<'a, R>>,
    name: &'a str,
    header: Header,
    /// The number of the last line read.
    line: usize,
    /// Whether the next part of the file has lines.
    has_lines: bool,
}

/// Reads the triangles of a file; its whole contents go into `hash`.
pub(super) fn read(file: impl Read, name: &str, hash: &mut Fingerprint, add: impl FnMut([Vec3; 3])) -> Result<()> {
    let mut ply = Ply {
        file: BufReader::new(Hashed { file, hash, error: None }),
        name,
        header: Header::new(),
        line: 0,
        has_lines: true,
    };
    let found = ply.read(add);
    // The original error instead of the parser's version of it.
    match ply.file.get_mut().error.take() {
        Some(error) => Err(unreadable(Path::new(name), error)),
        None => found,
    }
}

impl<R: Read> Ply<'_, R> {
    fn read(&mut self, mut add: impl FnMut([Vec3; 3])) -> Result<()> {
        self.read_header()?;
        let mut vertices: Option<Vec<Vec3>> = None;
        let elements: Vec<ElementDef> = self.header.elements.values().cloned().collect();
        for element in &elements {
            match element.name.as_str() {
                "vertex" => vertices = Some(self.vertices(element)?),
                "face" => {
                    let Some(vertices) = &vertices else {
                        return Err(self.refused("element", "face", "comes before the vertices").into());
                    };
                    self.faces(element, vertices, &mut add)?;
                }
                // Elements without properties take no bytes in a binary file, whatever number the header states.
                _ if element.properties.is_empty() && !self.has_lines => {}
                _ => {
                    for index in 0..element.count {
                        self.next(element, index)?;
                    }
                }
            }
        }
        // Bytes after the last element are no part of the mesh, but they go into the hash.
        let _ = io::copy(&mut self.file, &mut io::sink());
        Ok(())
    }

    /// Creates an error at the last line read, if there are lines.
    fn refused(&self, field: &str, value: &str, problem: &str) -> InputError {
        let value: String = value.chars().take(80).collect();
        InputError::new(field, value, problem).in_file(self.name, self.has_lines.then_some((self.line, 1)))
    }

    /// Reads a line of a text. `None` at the end of the file.
    fn next_line(&mut self) -> Result<Option<String>> {
        let mut line = Vec::new();
        let length = self.file.by_ref().take(LONGEST).read_until(b'\n', &mut line);
        self.line += 1;
        match length {
            Err(error) => Err(unreadable(Path::new(self.name), error)),
            Ok(0) => Ok(None),
            Ok(length) if length as u64 == LONGEST => Err(self.refused("line", "", "is longer than 1 MiB").into()),
            Ok(_) => match String::from_utf8(line) {
                Ok(line) => Ok(Some(line)),
                Err(_) => Err(self.refused("line", "", "is not UTF-8 text").into()),
            },
        }
    }

    fn read_header(&mut self) -> Result<()> {
        let mut text = String::new();
        loop {
            let Some(line) = self.next_line()? else {
                return Err(self.refused("header", "", "does not end with a line `end_header`").into());
            };
            text.push_str(&line);
            let written = line.trim_end();
            if self.line == 1 && written != "ply" {
                return Err(self.refused("header", written, "is not the header of a PLY file").allowed("ply").into());
            }
            if text.len() as u64 > LONGEST {
                return Err(self.refused("header", "", "is longer than 1 MiB").into());
            }
            if written == "end_header" {
                break;
            }
        }
        let header = Parser::<Element>::new().read_header(&mut Reader::new(text.as_bytes()));
        self.header = header.map_err(|problem| {
            let line = problem.line().unwrap_or(1);
            let written = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
            InputError::new("header", written, "is not a valid line of a PLY header")
                .in_file(self.name, Some((line, 1)))
        })?;
        self.judge_header()?;
        self.has_lines = self.header.encoding == Encoding::Ascii;
        Ok(())
    }

    /// Checks that there are vertices with coordinates and faces with corners.
    fn judge_header(&self) -> Result<()> {
        let property = |element: &str, name: &str| {
            self.header.elements.get(element).and_then(|element| element.properties.get(name))
        };
        let is_number = |name: &&str| {
            property("vertex", name).is_some_and(|property| matches!(property.data_type, PropertyType::Scalar(_)))
        };
        if let Some(missing) = ["x", "y", "z"].iter().find(|name| !is_number(name)) {
            let problem = "the element `vertex` has no number with this name";
            return Err(self.refused("property", missing, problem).allowed("x, y and z").into());
        }
        let is_list = |name: &str| {
            let property = property("face", name).map(|property| &property.data_type);
            matches!(property, Some(PropertyType::List(_, of)) if !matches!(of, ScalarType::Float | ScalarType::Double))
        };
        if !CORNERS.into_iter().any(is_list) {
            let problem = "the element `face` has no list of whole numbers with this name";
            return Err(self.refused("property", CORNERS[0], problem).allowed(CORNERS.join(" or ")).into());
        }
        Ok(())
    }

    /// Reads the next element; `index` is its number among the elements of its kind.
    fn next(&mut self, element: &ElementDef, index: usize) -> Result<Element> {
        let parser = Parser::new();
        let found = match self.header.encoding {
            Encoding::Ascii => {
                let line = self.next_line()?;
                let line = line.as_deref().ok_or(io::ErrorKind::UnexpectedEof);
                line.map_err(|end| io::Error::from(end).into())
                    .and_then(|line| parser.read_ascii_element(line, element))
            }
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.file, element),
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.file, element),
        };
        found.map_err(|problem| {
            let ElementDef { name, count, .. } = element;
            let problem = match problem.kind() {
                io::ErrorKind::UnexpectedEof => {
                    format!("is missing: the header declares {count} of them, but the file ends earlier")
                }
                _ => "does not match the header".to_string(),
            };
            self.refused(name, &index.to_string(), &problem).into()
        })
    }

    fn vertices(&mut self, element: &ElementDef) -> Result<Vec<Vec3>> {
        let mut vertices = Vec::new();
        for index in 0..element.count {
            let Element { position, .. } = self.next(element, index)?;
            if let Some(bad) = position.into_iter().find(|coordinate| !coordinate_limit(*coordinate)) {
                let error = self.refused("vertex", &bad.to_string(), &format!("is out of range in vertex {index}"));
                return Err(Error::from(error.allowed("-1e100 to 1e100 in each coordinate")));
            }
            vertices.push(position.into());
        }
        Ok(vertices)
    }

    fn faces(&mut self, element: &ElementDef, vertices: &[Vec3], add: &mut impl FnMut([Vec3; 3])) -> Result<()> {
        for index in 0..element.count {
            let Element { corners, .. } = self.next(element, index)?;
            let corners = corners.unwrap_or_default();
            let places = corners.iter().map(|corner| vertices.get(*corner as usize).copied());
            let Some(places) = places.collect::<Option<Vec<Vec3>>>().filter(|places| places.len() >= 3) else {
                let corners = corners.iter().map(u32::to_string).collect::<Vec<_>>().join(" ");
                let error = self.refused("face", &corners, &format!("is not a valid list of corners of face {index}"));
                let allowed = match vertices.len() {
                    0 => "vertex numbers, but the file has no vertices".to_string(),
                    count => format!("three or more vertex numbers, 0 to {}", count - 1),
                };
                return Err(Error::from(error.allowed(allowed)));
            };
            for pair in places[1..].windows(2) {
                add([places[0], pair[0], pair[1]]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The element "edge" has no bytes; the lengths of the faces' lists and their entries have different types.
    const HEADER: &str = "ply\nformat ENCODING 1.0\ncomment a square\nelement vertex 4\nproperty uchar red\nproperty float x\n\
        property double y\nproperty short z\nelement edge 9999999999\nelement face 2\nproperty list uchar ushort vertex_indices\n\
        property int flags\nend_header\n";
    const VERTICES: [[i16; 3]; 4] = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 7]];
    const FACES: [&[u16]; 2] = [&[0, 1, 2, 3], &[3, 1, 0]];

    fn header(encoding: &str) -> Vec<u8> {
        HEADER.replace("ENCODING", encoding).into_bytes()
    }

    fn binary(is_little: bool) -> Vec<u8> {
        let mut file = header(if is_little { "binary_little_endian" } else { "binary_big_endian" });
        let mut push = |mut bytes: Vec<u8>| {
            if !is_little {
                bytes.reverse();
            }
            file.extend(bytes);
        };
        for [x, y, z] in VERTICES {
            push(vec![255]);
            push(f32::from(x).to_le_bytes().to_vec());
            push(f64::from(y).to_le_bytes().to_vec());
            push(z.to_le_bytes().to_vec());
        }
        for face in FACES {
            push(vec![face.len() as u8]);
            for corner in face {
                push(corner.to_le_bytes().to_vec());
            }
            push((-1_i32).to_le_bytes().to_vec());
        }
        file
    }

    fn text() -> Vec<u8> {
        let mut file = header("ascii");
        file.extend(VERTICES.iter().flat_map(|[x, y, z]| format!("255 {x} {y} {z}\r\n").into_bytes()));
        // In a text, an element without properties is an empty line, so this file leaves such elements out.
        let text = String::from_utf8(file).unwrap().replace("element edge 9999999999\n", "");
        let faces = FACES.iter().map(|face| {
            let corners = face.iter().map(u16::to_string).collect::<Vec<_>>().join(" ");
            format!("{} {corners} -1\n", face.len())
        });
        (text + &faces.collect::<String>()).into_bytes()
    }

    fn triangles(file: &[u8]) -> Result<Vec<[Vec3; 3]>> {
        let mut found = Vec::new();
        read(file, "thing.ply", &mut Fingerprint::default(), |corners| found.push(corners))?;
        Ok(found)
    }

    /// A square is cut into two triangles, and the second face is one.
    #[test]
    fn each_encoding_has_the_same_triangles() {
        let [a, b, c, d] = VERTICES.map(|vertex| Vec3::from(vertex.map(f64::from)));
        for file in [text(), binary(true), binary(false)] {
            assert_eq!(triangles(&file).unwrap(), [[a, b, c], [a, c, d], [d, b, a]]);
        }
    }

    /// A truncated file is refused, wherever it ends.
    #[test]
    fn every_shorter_file_is_refused() {
        for file in [text(), binary(true)] {
            // A text may lack the last line's end.
            let whole = file.len() - usize::from(file.ends_with(b"\n"));
            for length in 0..whole {
                // The last number of a text may lose digits without being wrong.
                if let Err(error) = triangles(&file[..length]) {
                    assert_eq!(error.exit_code(), 2, "{error}");
                } else {
                    assert!(length + 1 >= whole, "{length} of {} bytes", file.len());
                }
            }
        }
    }
}
