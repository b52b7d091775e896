//! The header of a PLY file: its encoding, its elements, and the properties of each element.

use super::LONGEST;
use crate::error::{InputError, Result};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

#[derive(Debug)]
pub(super) struct Type {
    /// Both names that files use.
    names: [&'static str; 2],
    pub(super) is_whole: bool,
    /// Its bytes in a binary file.
    pub(super) size: usize,
    /// The number that a word of a text stands for; `None` if it is none of this type.
    pub(super) parsed: fn(&str) -> Option<f64>,
    /// The number that [`Type::size`] bytes stand for, the lowest byte first; more bytes are zero.
    pub(super) decoded: fn([u8; 8]) -> f64,
}

macro_rules! types {
    ($($Number:ty, $short:literal, $long:literal, $is_whole:literal;)*) => {
        const TYPES: &[Type] = &[$(Type {
            names: [$short, $long],
            is_whole: $is_whole,
            size: size_of::<$Number>(),
            parsed: |word| word.parse::<$Number>().ok().map(f64::from),
            decoded: |bytes| bytes.first_chunk().map_or(0.0, |bytes| <$Number>::from_le_bytes(*bytes).into()),
        }),*];
    };
}

types! {
    i8, "char", "int8", true;
    u8, "uchar", "uint8", true;
    i16, "short", "int16", true;
    u16, "ushort", "uint16", true;
    i32, "int", "int32", true;
    u32, "uint", "uint32", true;
    f32, "float", "float32", false;
    f64, "double", "float64", false;
}

impl Type {
    fn named(name: &str) -> Option<&'static Self> {
        TYPES.iter().find(|of| of.names.contains(&name))
    }

    pub(super) fn name(&self) -> &'static str {
        self.names[0]
    }
}

/// One number, or a list of them.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    One(&'static Type),
    List { length: &'static Type, of: &'static Type },
}

/// The use of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// A coordinate of a vertex: 0 to 2.
    Coordinate(usize),
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
            ("face", Shape::List { of, .. }) if of.is_whole && CORNERS.contains(&name) => Use::Corners,
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
        let types = || TYPES.iter().flat_map(|of| of.names).collect::<Vec<_>>().join(", ");
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
                        let length = Type::named(length).filter(|length| length.is_whole);
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
