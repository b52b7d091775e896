//! What is used of a Wavefront OBJ file: vertices, faces without normals and texture coordinates, and the names of objects. Each is
//! checked here, because the parser that cuts the faces into triangles does not tell where a mistake stands.

use crate::error::{Error, InputError, Result};
use crate::input::coordinate_limit;
use std::fmt::Write;

/// First words of lines that are not used, and what they hold.
const UNUSED: [(&str, &str); 5] = [
    ("vn", "normals"),
    ("vt", "texture coordinates"),
    ("mtllib", "materials"),
    ("usemtl", "materials"),
    ("l", "lines"),
];

/// The file with nothing in it but that, and the names of what was left out.
pub(super) fn essence(text: &str, file: &str) -> Result<(String, Vec<&'static str>)> {
    let (mut essence, mut unused) = (String::with_capacity(text.len()), Vec::new());
    let mut vertices = 0_i64;
    for (line, words) in (1..).zip(text.lines()) {
        let error = |field: &str, value: &str, problem: &str, allowed: String| {
            let value: String = value.chars().take(80).collect();
            let column = words.find(&value).map_or(1, |at| words[..at].chars().count() + 1);
            Error::from(InputError::new(field, value, problem).allowed(allowed).in_file(file, Some((line, column))))
        };
        let mut words = words.split_whitespace();
        match words.next() {
            Some("v") => {
                let coordinates: Vec<&str> = words.take(3).collect();
                if coordinates.len() < 3 {
                    return Err(error("v", &coordinates.join(" "), "is no point", "three coordinates".to_string()));
                }
                let is_good = |word: &str| word.parse().is_ok_and(coordinate_limit);
                if let Some(bad) = coordinates.iter().find(|word| !is_good(word)) {
                    let allowed = "-1e100 to 1e100 in each coordinate".to_string();
                    return Err(error("v", bad, "is out of range", allowed));
                }
                vertices += 1;
                // Writing to a string cannot fail.
                let _ = writeln!(essence, "v {}", coordinates.join(" "));
            }
            Some("f") => {
                let corners: Vec<&str> = words.collect();
                if corners.len() < 3 {
                    return Err(error("f", &corners.join(" "), "is no face", "at least three corners".to_string()));
                }
                essence.push('f');
                for corner in corners {
                    let index = corner.split('/').next().and_then(|index| index.parse::<i64>().ok());
                    let there = index.filter(|index| (1..=vertices).contains(&index.saturating_abs()));
                    let Some(index) = there else {
                        let allowed = match vertices {
                            0 => "the number of a vertex in a line above it".to_string(),
                            most => format!("1 to {most}, or -{most} to -1: the vertices above it"),
                        };
                        return Err(error("f", corner, "names a vertex that is not there", allowed));
                    };
                    let _ = write!(essence, " {index}");
                }
                essence.push('\n');
            }
            Some(name @ ("o" | "g")) => {
                let _ = writeln!(essence, "{name} {}", words.collect::<Vec<_>>().join(" "));
            }
            Some(word) => {
                let left_out = UNUSED.iter().find(|(own, _)| *own == word).map(|(_, what)| *what);
                unused.extend(left_out.filter(|what| !unused.contains(what)));
            }
            None => {}
        }
    }
    Ok((essence, unused))
}
