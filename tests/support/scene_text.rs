//! Scenes for tests, written as scene files and read by the program's own reader.

use pathmark::error::Result;
use pathmark::scene::Scene;

/// A sphere of a test scene; `material` is the text of a scene file, `{ diffuse = { albedo = [0.5, 0.5, 0.5] } }`.
pub(crate) struct Ball {
    pub(crate) center: [f64; 3],
    pub(crate) radius: f64,
    pub(crate) material: String,
    pub(crate) emission: [f64; 3],
}

/// Reads the scene. The camera looks along -z from `position`.
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
    Scene::from_toml(&(header + &objects.concat()))
}
