//! The header of a PLY file: its encoding, its elements, and the properties of each element.

use super::LONGEST;
use crate::error::{InputError, Result};

/// The encoding of the elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// The types with both names that files use.
const TYPES: [(&str, &str, Type); 8] = [
    ("char", "int8", Type::I8),
    ("uchar", "uint8", Type::U8),
    ("short", "int16", Type::I16),
    ("ushort", "uint16", Type::U16),
    ("int", "int32", Type::I32),
    ("uint", "uint32", Type::U32),
    ("float", "float32", Type::F32),
    ("double", "float64", Type::F64),
];

impl Type {
    fn named(name: &str) -> Option<Self> {
        TYPES.iter().find(|(short, long, _)| [*short, *long].contains(&name)).map(|entry| entry.2)
    }

    pub(super) fn name(self) -> &'static str {
        TYPES.iter().find(|entry| entry.2 == self).map_or("", |entry| entry.0)
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Its bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Returns the number that a word of a text stands for; `None` if it is none of this type.
    pub(super) fn parsed(self, word: &str) -> Option<f64> {
        match self {
            Self::I8 => word.parse::<i8>().ok().map(f64::from),
            Self::U8 => word.parse::<u8>().ok().map(f64::from),
            Self::I16 => word.parse::<i16>().ok().map(f64::from),
            Self::U16 => word.parse::<u16>().ok().map(f64::from),
            Self::I32 => word.parse::<i32>().ok().map(f64::from),
            Self::U32 => word.parse::<u32>().ok().map(f64::from),
            Self::F32 => word.parse::<f32>().ok().map(f64::from),
            Self::F64 => word.parse().ok(),
        }
    }

    /// Returns the number that [`Type::size`] bytes stand for, the lowest byte first; more bytes are zero.
    pub(super) fn decoded(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(bytes),
        }
    }
}

/// One number, or a list of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    One(Type),
    List { length: Type, of: Type },
}

/// The use of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// A coordinate of a vertex: 0 to 2.
    Coordinate(usize),
    /// The vertices of a face.
    Corners,
    Unused,
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) shape: Shape,
    pub(super) used: Use,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    fn has(&self, name: &str, used: Use) -> bool {
        self.name == name && self.properties.iter().any(|property| property.used == used)
    }

    /// Returns the use of a property, by its name and the element's.
    fn use_of(&self, name: &str, shape: Shape) -> Use {
        let coordinate = COORDINATES.iter().position(|coordinate| *coordinate == name);
        match (self.name.as_str(), shape) {
            ("vertex", Shape::One(_)) => coordinate.map_or(Use::Unused, Use::Coordinate),
            ("face", Shape::List { of, .. }) if of.is_whole() && CORNERS.contains(&name) => Use::Corners,
            _ => Use::Unused,
        }
    }
}

const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// The names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

/// The header as far as it has been read.
#[derive(Default)]
struct Draft {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
}

impl Draft {
    /// Takes a line between the first and the last; the error is the problem and the allowed values.
    fn take(&mut self, line: &str) -> std::result::Result<(), (&'static str, String)> {
        const INVALID: &str = "is not a valid line of a PLY header";
        let words: Vec<&str> = line.split_whitespace().collect();
        let types = || TYPES.map(|(short, long, _)| format!("{short}, {long}")).join(", ");
        match words[..] {
            ["comment" | "obj_info", ..] => {}
            ["format", encoding, version] => {
                let encoding = match encoding {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return Err((INVALID, "ascii, binary_little_endian, binary_big_endian".to_string())),
                };
                if version != "1.0" {
                    return Err(("is not a known version of the format", "1.0".to_string()));
                }
                if self.encoding.replace(encoding).is_some() {
                    return Err(("states the format again", "one line `format`".to_string()));
                }
            }
            ["element", name, count] => {
                let Ok(count) = count.parse() else {
                    return Err((INVALID, "element NAME COUNT".to_string()));
                };
                if self.elements.iter().any(|element| element.name == name) {
                    return Err(("names an element again", "each element once".to_string()));
                }
                self.elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
            }
            ["property", ref shape @ .., name] => {
                let Some(element) = self.elements.last_mut() else {
                    return Err(("comes before the first element", "a line `element` before it".to_string()));
                };
                let shape = match *shape {
                    [of] => Type::named(of).map(Shape::One).ok_or(types()),
                    ["list", length, of] => {
                        let length = Type::named(length).filter(|length| length.is_whole());
                        length.zip(Type::named(of)).map(|(length, of)| Shape::List { length, of }).ok_or(types())
                    }
                    _ => Err("property TYPE NAME, property list TYPE TYPE NAME".to_string()),
                };
                let shape = shape.map_err(|allowed| (INVALID, allowed))?;
                let used = element.use_of(name, shape);
                if element.properties.iter().any(|known| known.name == name) {
                    return Err(("names a property of its element again", "each property once".to_string()));
                }
                if used == Use::Corners && element.has("face", used) {
                    return Err(("is a second list of corners", CORNERS.join(" or ")));
                }
                element.properties.push(Property { name: name.to_string(), shape, used });
            }
            _ => return Err((INVALID, "format, element, property, comment, obj_info, end_header".to_string())),
        }
        Ok(())
    }

    /// Checks that there are vertices with coordinates and faces with corners; the error names what is missing.
    fn finish(self, refused: impl Fn(InputError) -> InputError) -> Result<Header> {
        let has = |element, used| self.elements.iter().any(|found| found.has(element, used));
        if let Some(missing) = (0..3).find(|axis| !has("vertex", Use::Coordinate(*axis))) {
            let problem = "the element `vertex` has no number with this name";
            let error = InputError::new("property", COORDINATES[missing], problem).allowed("x, y and z");
            return Err(refused(error).into());
        }
        if !has("face", Use::Corners) {
            let problem = "the element `face` has no list of whole numbers with this name";
            let error = InputError::new("property", CORNERS[0], problem).allowed(CORNERS.join(" or "));
            return Err(refused(error).into());
        }
        let Some(encoding) = self.encoding else {
            let problem = "the header does not state the format";
            let error = InputError::new("format", "", problem).allowed("a line such as `format ascii 1.0`");
            return Err(refused(error).into());
        };
        Ok(Header { encoding, elements: self.elements })
    }
}

impl Header {
    /// Reads a header from lines. `refused` adds the number of the line to an error.
    pub(super) fn read(
        mut next_line: impl FnMut() -> Result<Option<String>>,
        refused: impl Fn(InputError, usize) -> InputError,
    ) -> Result<Self> {
        let mut draft = Draft::default();
        let (mut number, mut length) = (0, 0);
        loop {
            number += 1;
            let error = |value: &str, problem: &str| {
                let value: String = value.chars().take(80).collect();
                refused(InputError::new("header", value, problem), number)
            };
            let Some(line) = next_line()? else {
                return Err(error("", "does not end with a line `end_header`").into());
            };
            length += line.len() as u64;
            if length > LONGEST {
                return Err(error("", "is longer than 1 MiB").into());
            }
            match line.trim_end() {
                "ply" if number == 1 => {}
                line if number == 1 => {
                    return Err(error(line, "is not the header of a PLY file").allowed("ply").into());
                }
                "end_header" => return draft.finish(|error| refused(error, number)),
                line => draft.take(line).map_err(|(problem, allowed)| error(line, problem).allowed(allowed))?,
            }
        }
    }
}
