//! Scenes for cases, in the words of scene files and read by the program's own reader.

use super::Trials;
use crate::error::{Error, Result};
use crate::material::Material;
use crate::scene::{Scene, load};
use serde::Deserialize;
use std::io::Write;

#[derive(Deserialize)]
struct Line {
    material: Material,
}

/// Reads what a scene file says behind `material = `.
pub(super) fn material(text: &str) -> Material {
    toml::from_str::<Line>(&format!("material = {text}")).expect("a material that the check has written").material
}

/// Reads a scene from its text.
pub(super) fn read(text: &str) -> Result<Scene> {
    let write = || -> std::io::Result<tempfile::NamedTempFile> {
        let mut file = tempfile::Builder::new().suffix(".toml").tempfile()?;
        file.write_all(text.as_bytes())?;
        Ok(file)
    };
    let file = write().map_err(|error| Error::system("writing", std::env::temp_dir(), error))?;
    load(&file.path().to_string_lossy())
}

/// Reads a scene from parts that the check knows to be right; what stands before the first table comes first.
pub(super) fn scene(parts: &[String]) -> Scene {
    let text = format!("about = 'a hard case'\n{}", parts.concat());
    read(&text).unwrap_or_else(|error| panic!("{error} in\n{text}"))
}

/// A camera with a field of view in degrees.
pub(super) fn camera_above(position: [f64; 3], look_at: [f64; 3], degrees: f64) -> String {
    format!(
        "[camera.pinhole]\nposition = {position:?}\nlook-at = {look_at:?}\nup = [0.36, 0.48, 0.8]\n\
         field-of-view = {degrees:?}\n"
    )
}

/// A camera whose pixels all see one point.
pub(super) fn camera_at_a_point(position: [f64; 3], look_at: [f64; 3]) -> String {
    camera_above(position, look_at, 1e-6)
}

/// An object, named by what it is; shape and material are what stands behind `=` in a scene file.
pub(super) fn object(shape: &str, material: &str, emission: [f64; 3]) -> String {
    let name = format!("{shape} {material}").replace('\'', "\"");
    format!("[[objects]]\nname = '{name}'\nshape = {shape}\nmaterial = {material}\nemission = {emission:?}\n")
}

/// A sphere.
pub(super) fn sphere(center: [f64; 3], radius: f64) -> String {
    format!("{{ sphere = {{ center = {center:?}, radius = {radius:?} }} }}")
}

/// A plane without an end.
pub(super) fn plane(point: [f64; 3], normal: [f64; 3]) -> String {
    format!("{{ plane = {{ point = {point:?}, normal = {normal:?} }} }}")
}

/// A matte material, the same in all channels.
pub(super) fn diffuse(albedo: f64) -> String {
    format!("{{ diffuse = {{ albedo = {:?} }} }}", [albedo; 3])
}

/// Insists that a scene with `VALUE` in its material is refused because of that value of that field: by an error with its place, which
/// makes the exit code 2 and says what is allowed.
pub(super) fn refused(trials: &mut Trials, material: &str, field: &str, value: &str, allowed: &str) {
    let material = material.replace("VALUE", value);
    let view = camera_above([0.0, 0.0, 3.0], [0.0; 3], 40.0);
    let text = format!("about = 'a test'\n{view}{}", object(&sphere([0.0; 3], 1.0), &material, [0.0; 3]));
    let found = read(&text);
    let passed = match &found {
        Err(Error::Input(error)) => {
            let is_placed = error.place.as_ref().is_some_and(|place| place.at.is_some());
            is_placed && error.field == field && error.value == value && error.to_string().contains(allowed)
        }
        _ => false,
    };
    let found = found.map_or_else(|error| error.to_string(), |scene| format!("a scene with {}", scene.objects[0].name));
    trials.holds(material, format_args!("refused: {field} = {value}, allowed {allowed}"), found, passed);
}
