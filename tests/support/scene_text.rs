//! Scenes for tests, written as scene files and read by the program's own reader.

use pathmark::error::Result;
use pathmark::scene::{Scene, load};
use std::io::Write;

/// A sphere of a test scene; `material` is the text of a scene file, `{ diffuse = { albedo = [0.5, 0.5, 0.5] } }`.
pub(crate) struct Ball {
    pub(crate) center: [f64; 3],
    pub(crate) radius: f64,
    pub(crate) material: String,
    pub(crate) emission: [f64; 3],
}

/// Writes the scene to a file, loads it, and takes the file away again. The camera looks along -z from `position`.
pub(crate) fn load_scene(position: [f64; 3], balls: &[Ball]) -> Result<Scene> {
    let header = format!(
        "about = 'a test'\n[camera.smallpt]\nposition = {position:?}\ndirection = [0.0, 0.0, -1.0]\nfield = 0.5\nadvance = 0.0\n"
    );
    let object = |(index, Ball { center, radius, material, emission }): (usize, &Ball)| {
        format!(
            "[[objects]]\nname = 'ball {index}'\nshape = {{ sphere = {{ center = {center:?}, radius = {radius:?} }} }}\n\
             material = {material}\nemission = {emission:?}\n"
        )
    };
    let objects: Vec<String> = balls.iter().enumerate().map(object).collect();
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().expect("a temporary file");
    file.write_all((header + &objects.concat()).as_bytes()).expect("a written file");
    load(file.path().to_str().expect("a path in UTF-8"))
}
