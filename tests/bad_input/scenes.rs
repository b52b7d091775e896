//! Wrong scene files, and two that only look wrong.

use super::program::{finish, pathmark};
use super::{line_of, place, refused};
use std::fs;
use std::path::Path;

const BALL: &str = r#"about = "one ball"

[camera.smallpt]
position = [50.0, 52.0, 295.6]
direction = [0.0, -0.042612, -1.0]
field = 0.5135
advance = 140.0

[[objects]]
name = "ball"
shape = { sphere = { center = [50.0, 40.0, 80.0], radius = 20.0 } }
material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }
emission = [1.0, 1.0, 1.0]
"#;

/// The text to replace, its replacement, and the words that the message must contain: the field, the value, the allowed
/// values.
const WRONG: &[(&str, &str, &[&str])] = &[
    ("radius = 20.0", "radius = nan", &["radius", "NaN", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = inf", &["radius", "inf", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = -inf", &["radius", "-inf", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = -20.0", &["radius", "-20", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = 0.0", &["radius", "0", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = -0.0", &["radius", "-0", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = 1e200", &["radius", "1e200", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = 5e-324", &["radius", "5e-324", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = 1e400", &["radius", "1e400"]),
    ("radius = 20.0", "radius = 1,5", &["radius"]),
    ("radius = 20.0", "radius = 1e-400", &["radius", "1e-100 to 1e100"]),
    ("radius = 20.0", "radius = 0x", &["radius"]),
    ("radius = 20.0", "radius = true", &["radius", "true", "f64"]),
    ("radius = 20.0", "radius = 99999999999999999999", &["radius"]),
    ("radius = 20.0", "radius = \"large\"", &["radius", "large", "f64"]),
    ("radius = 20.0", "radius = [1.0]", &["radius", "[1.0]", "f64"]),
    ("radius = 20.0", "radios = 20.0", &["radios", "radius", "center"]),
    ("radius = 20.0", "radius = 20.0, radius = 21.0", &["radius", "duplicate"]),
    (", radius = 20.0", "", &["radius", "missing"]),
    ("40.0, 80.0]", "nan, 80.0]", &["center", "nan", "-1e100 to 1e100"]),
    ("40.0, 80.0]", "1e160, 80.0]", &["center", "1e160", "-1e100 to 1e100"]),
    ("40.0, 80.0]", "80.0]", &["center", "3"]),
    ("40.0, 80.0]", "40.0, 80.0, 99.0]", &["center", "length 4", "length 3"]),
    ("emission = [1.0, 1.0, 1.0]", "emission = [1.0, 1.0, 1.0, 1.0]", &["emission", "length 4", "length 3"]),
    (
        "sphere = { center = [50.0, 40.0, 80.0], radius = 20.0 }",
        "quad = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]] }",
        &["corners", "length 5", "length 4"],
    ),
    ("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, 1.5, 0.5]", &["albedo", "1.5", "0 to 1"]),
    ("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, nan, 0.5]", &["albedo", "nan", "0 to 1"]),
    ("albedo = [0.5, 0.5, 0.5]", "albedo = [-0.1, 0.5, 0.5]", &["albedo", "-0.1", "0 to 1"]),
    ("emission = [1.0, 1.0, 1.0]", "emission = [1.0, -2.0, 1.0]", &["emission", "-2", "0 to 1e100"]),
    ("emission = [1.0, 1.0, 1.0]", "emission = [1.0, inf, 1.0]", &["emission", "inf", "0 to 1e100"]),
    ("material = { diffuse =", "material = { velvet =", &["velvet", "diffuse", "mirror", "dielectric"]),
    ("shape = { sphere =", "shape = { cube =", &["cube", "sphere"]),
    ("[0.0, -0.042612, -1.0]", "[0.0, 0.0, 0.0]", &["direction", "zero", "length"]),
    ("[0.0, -0.042612, -1.0]", "[nan, 0.0, 1.0]", &["direction", "nan"]),
    // The camera's rule for upright rows has no answer when the camera looks along its rows.
    ("[0.0, -0.042612, -1.0]", "[1.0, 0.0, 0.0]", &["direction", "1.0, 0.0, 0.0"]),
    ("field = 0.5135", "field = 0.0", &["field", "0", "1e-100 to 1e100"]),
    ("advance = 140.0", "advance = -1.0", &["advance", "-1", "0 to 1e100"]),
    ("[camera.smallpt]", "[camera.fisheye]", &["fisheye", "smallpt"]),
    ("about = \"one ball\"", "about = 7", &["about", "7", "string"]),
    ("about = \"one ball\"", "about = \"one ball\"\nabout = \"two\"", &["about", "duplicate"]),
    ("about = \"one ball\"", "about = \"one ball\"\nsmoke = 0.5", &["smoke", "objects"]),
    ("about = \"one ball\"", "about = \"one ball\"\nestimator = \"magic\"", &["estimator", "magic", "smallpt"]),
    ("about = \"one ball\"", "about = \"one\0ball\"", &["about"]),
];

/// Other shapes in place of the ball, and the words that the message must contain: T05, T17 and other shapes without an
/// area or a direction.
const SHAPES: &[(&str, &[&str])] = &[
    ("triangle = { corners = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]] }", &["corners", "on a line", "area"]),
    ("triangle = { corners = [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]] }", &["corners", "on a line", "area"]),
    ("triangle = { corners = [[0.0, 0.0, 0.0], [1.0, nan, 1.0], [2.0, 0.0, 2.0]] }", &["corners", "NaN", "1e100"]),
    ("triangle = { corners = [[0.0, 0.0, 0.0], [1.0, 1e160, 1.0], [2.0, 0.0, 2.0]] }", &["corners", "1e100"]),
    ("triangle = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]] }", &["corners", "3"]),
    ("triangle = { corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]] }", &["corners", "3"]),
    ("quad = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]] }", &["corners", "area"]),
    ("quad = { corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, inf], [0.0, 1.0, 0.0]] }", &["corners", "inf"]),
    ("plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 0.0] }", &["normal", "zero", "length"]),
    ("plane = { point = [0.0, 0.0, 0.0], normal = [0.0, nan, 0.0] }", &["normal", "nan"]),
    ("mesh = { object = \"x\" }", &["file", "missing"]),
];

/// Other cameras in place of the first, and the words that the message must contain.
const CAMERAS: &[(&str, &[&str])] = &[
    ("look-at = [0.0, 0.0, 0.0]\nfield-of-view = 0.0", &["field-of-view", "0.0", "1e-6 to 179"]),
    ("look-at = [0.0, 0.0, 0.0]\nfield-of-view = 180.0", &["field-of-view", "180", "1e-6 to 179"]),
    ("look-at = [0.0, 0.0, 0.0]\nfield-of-view = nan", &["field-of-view", "nan", "1e-6 to 179"]),
    ("look-at = [0.0, 9.0, 0.0]\nfield-of-view = 40.0", &["upward direction", "another `up`"]),
    ("look-at = [0.0, 2.0, 0.0]\nfield-of-view = 40.0", &["camera.pinhole: ", "its own position", "another point"]),
    ("look-at = [1.0, 2.0, 0.0]\nfield-of-view = 40.0\nup = [0.0, 0.0, 0.0]", &["up", "zero"]),
    ("look-at = [1.0, 2.0, 0.0]", &["field-of-view", "missing"]),
];

const ARGUMENTS: [&str; 8] = ["render", "ball.toml", "--size", "8x8", "--spp", "4", "-o", "image.png"];

#[test]
fn each_wrong_scene_is_refused_at_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let mut failures = Vec::new();
    for (right, wrong, said) in WRONG {
        assert!(BALL.contains(right), "{right:?}");
        let text = BALL.replacen(right, wrong, 1);
        fs::write(folder.path().join("ball.toml"), &text).unwrap();
        let changed = line_of(BALL, right)..=line_of(BALL, right) + wrong.matches('\n').count();
        // All cases run before any failure is reported, so that one run shows all of them.
        let outcome = std::panic::catch_unwind(|| {
            let message = refused(folder.path(), &ARGUMENTS, 2, said);
            let found = place(&message, "ball.toml");
            assert!(found.is_some_and(|(line, _)| changed.contains(&line)), "not in lines {changed:?}: {message}");
        });
        if outcome.is_err() {
            failures.push(wrong);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn shapes_without_an_area_and_cameras_without_a_view_are_refused() {
    let shape = "sphere = { center = [50.0, 40.0, 80.0], radius = 20.0 }";
    let camera = &BALL[BALL.find("[camera").unwrap()..BALL.find("[[objects]]").unwrap()];
    let shapes = SHAPES.iter().map(|(text, said)| (BALL.replace(shape, text), "shape = {", said));
    let cameras = CAMERAS.iter().map(|(text, said)| {
        let pinhole = format!("[camera.pinhole]\nposition = [0.0, 2.0, 0.0]\n{text}\n\n");
        (BALL.replace(camera, &pinhole), "[camera.pinhole]", said)
    });
    for (text, part, said) in shapes.chain(cameras) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("ball.toml"), &text).unwrap();
        let message = refused(folder.path(), &ARGUMENTS, 2, said);
        let first = line_of(&text, part);
        assert!(place(&message, "ball.toml").is_some_and(|(line, _)| (first..first + 5).contains(&line)), "{message}");
    }
}

/// The column is the value's first character, counted in characters.
#[test]
fn the_column_is_counted_in_characters() {
    let folder = tempfile::tempdir().unwrap();
    let text = BALL.replace("shape = { sphere = { center", "shape = { sphere = { center ").replace("20.0", "-1.0");
    fs::write(folder.path().join("ball.toml"), &text).unwrap();
    let message = refused(folder.path(), &ARGUMENTS, 2, &[]);
    let column = text.lines().nth(10).and_then(|line| line.find("-1.0")).unwrap() + 1;
    assert_eq!(place(&message, "ball.toml"), Some((11, column)), "{message}");

    fs::write(folder.path().join("ball.toml"), "\"gr\u{f6}\u{df}e\" = 1\n").unwrap();
    assert_eq!(place(&refused(folder.path(), &ARGUMENTS, 2, &[]), "ball.toml"), Some((1, 1)));
}

#[test]
fn a_byte_order_mark_and_line_ends_of_windows_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    for text in [BALL.to_string(), BALL.replace('\n', "\r\n"), format!("\u{feff}{BALL}")] {
        fs::write(folder.path().join("ball.toml"), text).unwrap();
        finish(pathmark(folder.path(), &ARGUMENTS)).with_code(0);
    }
    let wrong = BALL.replace('\n', "\r\n").replace("radius = 20.0", "radius = -1.0");
    fs::write(folder.path().join("ball.toml"), wrong).unwrap();
    let message = refused(folder.path(), &ARGUMENTS, 2, &["radius"]);
    assert_eq!(place(&message, "ball.toml").map(|at| at.0), Some(11), "{message}");
}

fn refused_file(bytes: impl AsRef<[u8]>, said: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("ball.toml"), bytes).unwrap();
    refused(folder.path(), &ARGUMENTS, 2, &[&["ball.toml"], said].concat());
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    refused_file("", &["missing", "about"]);
    refused_file("\n# nothing yet\n", &["missing", "about"]);
    refused_file([0; 64], &["ball.toml:1:"]);
    refused_file(b"about = \"\xff\xfe\"\n", &["UTF-8"]);
    refused_file("about = \"no end", &["ball.toml:1:"]);
    refused_file(vec![b'#'; 20 << 20], &["3 MiB"]);
    // One line as long as a file may be.
    refused_file([b"about = '".as_slice(), &vec![b'x'; (3 << 20) - 9]].concat(), &["ball.toml:1:"]);
}

#[test]
fn a_scene_without_objects_is_refused_at_its_place() {
    let end = BALL.find("[[objects]]").unwrap();
    let camera = &BALL[..end];
    refused_file(camera, &["ball.toml", "objects", "at least one"]);
    refused_file(format!("objects = []\n{camera}"), &["ball.toml:1:", "objects = []", "at least one"]);
}

/// A sparse file of a gigabyte: its refusal costs no more than any other.
#[test]
fn a_line_of_a_gigabyte_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::File::create(folder.path().join("ball.toml")).unwrap().set_len(1 << 30).unwrap();
    // Without `refused`, which would read the file to compare it.
    let finished = finish(pathmark(folder.path(), &ARGUMENTS)).with_code(2);
    assert!(finished.err.contains("ball.toml") && finished.err.contains("3 MiB"), "{}", finished.err);
}

/// A parser that calls itself for each bracket would overflow its stack.
#[test]
fn deep_nesting_is_refused() {
    for text in
        ["[".repeat(100_000), format!("a = {}", "[".repeat(100_000)), format!("a = {}", "{ a = ".repeat(100_000))]
    {
        refused_file(text, &["ball.toml:1:"]);
    }
    refused_file(format!("{}b = 1", "a.".repeat(100_000)), &["ball.toml"]);
}

#[test]
fn paths_that_are_no_scene_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("folder.toml")).unwrap();
    let cases: &[(&str, &[&str])] = &[
        ("folder.toml", &["folder.toml", "directory"]),
        ("missing.toml", &["missing.toml", "no such file"]),
        ("./missing", &["missing", "no such file"]),
        // It never ends, so the reader must stop by itself.
        ("/dev/zero", &["/dev/zero", "byte 0 is zero"]),
    ];
    for (scene, said) in cases.iter().filter(|(scene, _)| !scene.starts_with('/') || Path::new(scene).exists()) {
        println!("{scene}");
        refused(folder.path(), &["render", scene, "-o", "image.png"], 2, said);
    }
}
