//! Tests of PLY files in each encoding.

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

/// The faces of a file, and whether it holds more.
fn faces(file: &[u8]) -> Result<(Vec<Vec<Vec3>>, bool)> {
    let mut found = Vec::new();
    let has_more = read(file, "thing.ply", &mut Fingerprint::default(), |face| {
        found.push(face.to_vec());
        Ok(())
    })?;
    Ok((found, has_more))
}

#[test]
fn each_encoding_has_the_same_faces() {
    let [a, b, c, d] = VERTICES.map(|vertex| Vec3::from(vertex.map(f64::from)));
    for file in [text(), binary(true), binary(false)] {
        let expected = [vec![a, b, c, d], vec![d, b, a]];
        assert_eq!(faces(&file).unwrap(), (expected.to_vec(), false));
        assert!(!faces(&[&file[..], b"\n"].concat()).unwrap().1 || file == binary(true) || file == binary(false));
        assert_eq!(faces(&[&file[..], b"7"].concat()).unwrap(), (expected.to_vec(), true));
    }
}

/// A square of the four corners, with another line in the header and more numbers behind a vertex.
fn square(property: &str, more: &str) -> Result<(Vec<Vec<Vec3>>, bool)> {
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    let tail = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let vertices = [".5 -1. 0", "1 -1e0 0", "1 1 0", "-1 +1 0"].map(|vertex| format!("{vertex}{more}\n"));
    faces(format!("\u{feff}{head}{property}{tail}{}4 0 1 2 3\n", vertices.concat()).as_bytes())
}

/// Numbers of a text may lack digits before or behind the point. Properties that are not used may be anything of their
/// type.
#[test]
fn unused_numbers_are_not_judged() {
    let plain = square("", "").unwrap();
    assert_eq!(plain.0[0][0], Vec3::new(0.5, -1.0, 0.0));
    for (property, more) in [
        ("property float quality\n", " nan"),
        ("property double quality\n", " -inf"),
        ("property uint8 red\nproperty int16 flag\n", " 255 -9"),
        ("property list uchar float weights\n", " 2 .5 1e400"),
        ("property list uchar float weights\n", " 0"),
        ("comment none\nobj_info none\n", ""),
    ] {
        assert_eq!(square(property, more).unwrap(), plain, "{property}");
    }
}

/// The field, the value and the place of each mistake.
#[test]
fn mistakes_are_named() {
    let twice = "is a second list of corners";
    for (property, more, said) in [
        ("", " 7", "thing.ply:10:10: number = 7: follows the last property of vertex 0"),
        ("property float x\n", " 7", "thing.ply:7:1: header = property float x: names a property of its element again"),
        ("property list uchar int x\n", " 0", "thing.ply:7:1: header = property list uchar int x: names a property"),
        ("property uchar red\n", " 256", "thing.ply:11:10: red = 256: is not a number of its type in vertex 0"),
        ("property uchar red\n", " red", "red = red: is not a number of its type in vertex 0 (allowed: uchar)"),
        ("property list uchar int n\n", " 2 1", "has too few numbers: the line ends before n is complete"),
        ("property list char int n\n", " -1", "n = -1: is out of range in vertex 0 (allowed: a length of 0 or more)"),
        ("property list float int n\n", " 0", "property list float int n: is not a valid line"),
        ("property long n\n", " 0", "property long n: is not a valid line of a PLY header (allowed: char, int8, "),
        ("format ascii 1.0\n", "", "header = format ascii 1.0: states the format again"),
        ("format ascii 2.0\n", "", "header = format ascii 2.0: is not a known version of the format (allowed: 1.0)"),
        ("element vertex 4\n", "", "header = element vertex 4: names an element again"),
        ("element face 0\nproperty list uchar int vertex_index\nproperty list uchar int vertex_indices\n", "", twice),
    ] {
        let error = square(property, more).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains(said), "{said}: {error}");
    }
    // A face of more corners than the limit, before they are read.
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uint uchar vertex_indices\nend_header\n";
    let error = faces(&[header.as_bytes(), &4097_u32.to_le_bytes()].concat()).unwrap_err();
    assert!(error.to_string().contains("face = 0: has 4097 corners (allowed: at most 4096)"), "{error}");
}

/// A truncated file is refused, wherever it ends.
#[test]
fn every_shorter_file_is_refused() {
    for file in [text(), binary(true)] {
        // A text may lack the last line's end.
        let whole = file.len() - usize::from(file.ends_with(b"\n"));
        for length in 0..whole {
            // The last number of a text may lose digits without being wrong.
            if let Err(error) = faces(&file[..length]) {
                assert_eq!(error.exit_code(), 2, "{error}");
            } else {
                assert!(length + 1 >= whole, "{length} of {} bytes", file.len());
            }
        }
    }
}
