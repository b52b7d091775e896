//! Scenes with a wrong mesh file, and one whose mesh file only looks wrong.

use super::program::{finish, in_memory, pathmark};
use super::{place, refused};
use std::fs;

const SCENE: &str = r#"about = "a mesh"
background = [1.0, 1.0, 1.0]

[camera.pinhole]
position = [0.0, 0.0, 5.0]
look-at = [0.0, 0.0, 0.0]
field-of-view = 40.0

[[objects]]
name = "thing"
shape = { mesh = { file = "thing.obj" } }
material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }
"#;

const OBJ: &str = "o square\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf -4 -2 -1\n";

const ARGUMENTS: [&str; 8] = ["render", "mesh.toml", "--size", "8x8", "--spp", "4", "-o", "image.png"];

/// The text to replace, its replacement, the line of the mistake, and the words that the message must contain.
const WRONG: &[(&str, &str, usize, &[&str])] = &[
    ("v 1 1 0", "v 1 nan 0", 4, &["v = nan", "-1e100 to 1e100"]),
    ("v 1 1 0", "v 1 inf 0", 4, &["v = inf", "-1e100 to 1e100"]),
    ("v 1 1 0", "v 1 1e160 0", 4, &["v = 1e160", "-1e100 to 1e100"]),
    ("v 1 1 0", "v 1 one 0", 4, &["v = one", "-1e100 to 1e100"]),
    ("v 1 1 0", "v 1 1", 4, &["v = 1 1", "three coordinates"]),
    ("f 1 2 3", "f 1 2 5", 6, &["f = 5", "1 to 4", "-4 to -1"]),
    ("f 1 2 3", "f 1 2 0", 6, &["f = 0", "1 to 4"]),
    ("f 1 2 3", "f 1 2 99999999999999999999", 6, &["f = 99999999999999999999", "1 to 4"]),
    ("f 1 2 3", "f 1 2 -9223372036854775808", 6, &["f = -9223372036854775808", "1 to 4"]),
    ("f 1 2 3", "f 1 2 x", 6, &["f = x", "1 to 4"]),
    ("f 1 2 3", "f 1 2 /1/1", 6, &["f = /1/1", "1 to 4"]),
    ("f 1 2 3", "f 1 2", 6, &["f = 1 2", "three corners"]),
    ("f -4 -2 -1", "f -5 -2 -1", 7, &["f = -5", "-4 to -1"]),
    ("o square\n", "f 1 2 3\n", 1, &["f = 1", "a vertex in an earlier line"]),
];

fn folder(scene: &str, obj: Option<&[u8]>) -> tempfile::TempDir {
    let folder = in_memory();
    fs::write(folder.path().join("mesh.toml"), scene).unwrap();
    if let Some(obj) = obj {
        fs::write(folder.path().join("thing.obj"), obj).unwrap();
    }
    folder
}

/// Puts each wrong line into a correct text, writes it to the file, and checks that the message gives the line.
fn each_is_named(
    text: &str,
    wrong: &[(&str, &str, usize, &[&str])],
    file: &str,
    folder: impl Fn(&[u8]) -> tempfile::TempDir,
) {
    finish(pathmark(folder(text.as_bytes()).path(), &ARGUMENTS)).with_code(0);
    for (right, wrong, line, said) in wrong {
        assert!(text.contains(right), "{right:?}");
        let folder = folder(text.replacen(right, wrong, 1).as_bytes());
        let message = refused(folder.path(), &ARGUMENTS, 2, said);
        assert_eq!(place(&message, file).map(|at| at.0), Some(*line), "{wrong}: {message}");
    }
}

#[test]
fn each_wrong_line_is_named() {
    each_is_named(OBJ, WRONG, "thing.obj", |obj| folder(SCENE, Some(obj)));
    each_is_named(PLY, WRONG_PLY, "thing.ply", |ply| ply_folder(SCENE, ply));
}

/// T05: triangles with all corners on a line are left out; a mesh without any other triangle is refused.
#[test]
fn a_mesh_without_a_triangle_is_refused() {
    let flat = OBJ.replace("v 1 -1 0", "v 0 0 0").replace("v -1 1 0", "v 2 2 0");
    for obj in ["", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f", "\0\0\0\0", &flat] {
        let folder = folder(SCENE, Some(obj.as_bytes()));
        refused(folder.path(), &ARGUMENTS, 2, &["thing.obj"]);
    }
    let one_left = OBJ.replace("v 1 -1 0", "v 0 0 0");
    finish(pathmark(folder(SCENE, Some(one_left.as_bytes())).path(), &ARGUMENTS)).with_code(0);
}

/// Mistakes that concern the whole file are reported where the scene names the file.
#[test]
fn files_that_are_no_meshes_are_refused() {
    let missing = folder(SCENE, None);
    let message = refused(missing.path(), &ARGUMENTS, 2, &["thing.obj", "no such file"]);
    assert_eq!(place(&message, "mesh.toml").map(|at| at.0), Some(10), "{message}");

    let directory = folder(SCENE, None);
    fs::create_dir(directory.path().join("thing.obj")).unwrap();
    let message = refused(directory.path(), &ARGUMENTS, 2, &["thing.obj", "directory"]);
    assert_eq!(place(&message, "mesh.toml").map(|at| at.0), Some(10), "{message}");

    refused(folder(SCENE, Some(b"v 0 0 \xff\n")).path(), &ARGUMENTS, 2, &["thing.obj", "UTF-8"]);
    let small = SCENE.replace("\"thing.obj\"", "\"thing.obj\", largest-mib = 1");
    refused(folder(&small, Some(&vec![b'\n'; 2 << 20])).path(), &ARGUMENTS, 2, &["thing.obj", "1 MiB"]);
    refused(
        folder(SCENE, Some(&vec![b' '; 2 << 20])).path(),
        &ARGUMENTS,
        2,
        &["thing.obj", "a line that is too long", "1 MiB"],
    );
    let endless = SCENE.replace("\"thing.obj\"", "\"/dev/zero\"");
    refused(folder(&endless, None).path(), &ARGUMENTS, 2, &["/dev/zero", "byte 0 is zero"]);

    let other = SCENE.replace("\"thing.obj\"", "\"thing.obj\", object = \"circle\"");
    refused(folder(&other, Some(OBJ.as_bytes())).path(), &ARGUMENTS, 2, &["thing.obj", "circle", "square"]);
    let unknown = SCENE.replace("\"thing.obj\"", "\"thing.obj\", smooth = true");
    refused(folder(&unknown, Some(OBJ.as_bytes())).path(), &ARGUMENTS, 2, &["smooth", "file", "object"]);
}

/// Windows line ends, normals, missing texture coordinates, polygons, materials and comments are no mistakes.
#[test]
fn unused_statements_of_a_mesh_are_not_judged() {
    let full = "# a square\r\nmtllib none.mtl\r\no square\r\nv -1 -1 0 1.0\r\nv 1 -1 0\r\nv 1 1 0\r\nv -1 1 0\r\n\
                vt 0 0\r\nusemtl none\r\ns off\r\nf 1/-5/7 2/9/9 3//3 4\r\n";
    finish(pathmark(folder(SCENE, Some(full.as_bytes())).path(), &ARGUMENTS)).with_code(0);
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
                   property list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n";

/// The same for the text of a PLY file.
const WRONG_PLY: &[(&str, &str, usize, &[&str])] = &[
    ("ply\n", "plx\n", 1, &["header = plx", "not the header of a PLY file"]),
    ("ascii 1.0", "morse 1.0", 2, &["header = format morse 1.0", "not a valid line", "binary_little_endian"]),
    ("ascii 1.0", "ascii 2.0", 2, &["header = format ascii 2.0", "not a known version", "1.0"]),
    ("float y", "float x", 5, &["header = property float x", "names a property of its element again"]),
    ("vertex 4", "vertex four", 3, &["header = element vertex four", "not a valid line"]),
    ("property float z\n", "", 8, &["property = z", "x, y and z"]),
    ("float z", "list uchar float z", 9, &["property = z", "x, y and z"]),
    ("vertex_indices", "corners", 9, &["property = vertex_indices", "vertex_index"]),
    ("uchar int", "uchar float", 9, &["property = vertex_indices", "whole numbers"]),
    ("1 1 0", "1 nan 0", 12, &["thing.ply:12:3: y = nan", "vertex 2", "-1e100 to 1e100"]),
    ("1 1 0", "1 1e39 0", 12, &["y = 1e39", "vertex 2", "-1e100 to 1e100"]),
    ("1 1 0", "1 one 0", 12, &["y = one", "not a number of its type in vertex 2", "float"]),
    ("1 1 0", "1 1", 12, &["vertex = 2", "too few numbers", "before z"]),
    ("1 1 0", "1 1 0 7", 12, &["thing.ply:12:7: number = 7", "follows the last property of vertex 2"]),
    ("3 0 1 2", "3 0 1 4", 14, &["face = 0 1 4", "0 to 3"]),
    ("3 0 1 2", "3 0 1 -1", 14, &["vertex_indices = -1", "in face 0", "from 0"]),
    ("3 0 1 2", "3 0 1 2 3", 14, &["number = 3", "follows the last property of face 0"]),
    ("3 0 1 2", "2 0 1", 14, &["face = 0 1", "three or more"]),
    ("3 0 1 2", "9 0 1 2", 14, &["face = 0", "too few numbers", "before vertex_indices"]),
    ("face 2", "face 3", 16, &["face = 2", "declares 3 of them"]),
];

fn ply_folder(scene: &str, ply: &[u8]) -> tempfile::TempDir {
    let folder = folder(&scene.replace("thing.obj", "thing.ply"), None);
    fs::write(folder.path().join("thing.ply"), ply).unwrap();
    folder
}

#[test]
fn ply_files_that_are_no_meshes_are_refused() {
    let faces_first = PLY.replacen("vertex 4", "face 0\nproperty list uchar int vertex_indices\nelement vertex 4", 1);
    refused(ply_folder(SCENE, faces_first.as_bytes()).path(), &ARGUMENTS, 2, &["thing.ply"]);
    let points = PLY.replace("element face 2\nproperty list uchar int vertex_indices\n", "");
    refused(ply_folder(SCENE, points.as_bytes()).path(), &ARGUMENTS, 2, &["thing.ply", "face", "no list"]);
    let endless = "ply\n".to_string() + &"comment none\n".repeat(90_000);
    refused(ply_folder(SCENE, endless.as_bytes()).path(), &ARGUMENTS, 2, &["thing.ply", "longer than 1 MiB"]);
    // The reader does not reserve memory for as many vertices as the header claims.
    let binary = PLY.replace("ascii", "binary_little_endian").replace("vertex 4", "vertex 9999999999");
    refused(ply_folder(SCENE, binary.as_bytes()).path(), &ARGUMENTS, 2, &["thing.ply", "declares 9999999999 of them"]);
    let small = SCENE.replace("\"thing.obj\"", "\"thing.obj\", largest-mib = 1");
    refused(ply_folder(&small, &vec![b'\n'; 2 << 20]).path(), &ARGUMENTS, 2, &["thing.ply", "1 MiB"]);
    let object = SCENE.replace("\"thing.obj\"", "\"thing.obj\", object = \"circle\"");
    refused(ply_folder(&object, PLY.as_bytes()).path(), &ARGUMENTS, 2, &["object = circle", "no objects"]);
}

/// Placements of the mesh, and the words that the message must contain.
const PLACEMENTS: &[(&str, &[&str])] = &[
    ("scale = 0.0", &["scale", "0.0", "1e-100 to 1e100"]),
    ("scale = -1.0", &["scale", "-1.0", "1e-100 to 1e100"]),
    ("scale = nan", &["scale", "NaN", "1e-100 to 1e100"]),
    ("scale = inf", &["scale", "inf", "1e-100 to 1e100"]),
    ("scale = [1.0, 2.0, 1.0]", &["scale", "f64"]),
    ("rotate = [0.0, nan, 0.0]", &["rotate", "NaN", "-360 to 360 degrees"]),
    ("rotate = [0.0, 361.0, 0.0]", &["rotate", "361", "-360 to 360 degrees"]),
    ("rotate = 90.0", &["rotate", "90"]),
    ("translate = [0.0, inf, 0.0]", &["translate", "inf", "-1e100 to 1e100"]),
];

#[test]
fn placements_that_are_none_are_refused() {
    for (placement, said) in PLACEMENTS {
        let scene = SCENE.replace("\"thing.obj\"", &format!("\"thing.obj\", {placement}"));
        let message = refused(folder(&scene, Some(OBJ.as_bytes())).path(), &ARGUMENTS, 2, said);
        assert_eq!(place(&message, "mesh.toml").map(|at| at.0), Some(11), "{message}");
    }
    let far = SCENE.replace("\"thing.obj\"", "\"thing.obj\", scale = 1e60");
    let obj = OBJ.replace("v 1 1 0", "v 1e50 1 0");
    refused(folder(&far, Some(obj.as_bytes())).path(), &ARGUMENTS, 2, &["thing.obj", "out of range", "1e100"]);
}

/// Files of other kinds are named by how they begin; a file that merely lacks faces, by its first line.
#[test]
fn files_of_other_kinds_are_named() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12345\n";
    let cases: [(&[u8], &[&str]); 9] = [
        (pointer.as_bytes(), &["mesh = version https://git-lfs.github.com/spec/v1", "Git LFS", "git lfs pull"]),
        (b"\n<!DOCTYPE html>\n<html>", &["mesh = <!DOCTYPE html>", "web page"]),
        (b"<HTML>", &["web page"]),
        (b"solid cube\nfacet normal 0 0 1\n", &["mesh = solid cube", "STL"]),
        (b"made by hand\0\0\0\0", &["binary file", "STL"]),
        (b"OFF\n4 2 0\n", &["mesh = OFF", "OFF file"]),
        (b"glTF\x02\0\0\0", &["glTF"]),
        (b"{\"asset\": {\"version\": \"2.0\"}}", &["glTF"]),
        (b"a poem\nof two lines\n", &["no triangle", "begins with `a poem`"]),
    ];
    for (bytes, said) in cases {
        let said = [&["thing.obj"], said].concat();
        refused(folder(SCENE, Some(bytes)).path(), &ARGUMENTS, 2, &said);
        if !said[1].contains("triangle") && !said[1].contains("binary") {
            refused(ply_folder(SCENE, bytes).path(), &ARGUMENTS, 2, &said[1..]);
        }
    }
    refused(folder(SCENE, Some(PLY.as_bytes())).path(), &ARGUMENTS, 2, &["mesh = ply", "must end in .ply"]);
}

/// The opening of a pipe waits for its writer, which may never come.
#[test]
fn a_pipe_is_refused() {
    for (name, scene) in [("thing.obj", SCENE.to_string()), ("thing.ply", SCENE.replace("thing.obj", "thing.ply"))] {
        let folder = folder(&scene, None);
        nix::unistd::mkfifo(&folder.path().join(name), nix::sys::stat::Mode::S_IRWXU).unwrap();
        refused(folder.path(), &ARGUMENTS, 2, &[name, "is a pipe"]);
    }
}
