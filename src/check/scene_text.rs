//! Scenes of the cases, written as scene files and read by the program's own reader.

use super::Trials;
use crate::error::{Error, Result};
use crate::scene::{Scene, load};
use std::io::Write;

pub(super) const DIFFUSE: &str = "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }";
pub(super) const MIRROR: &str = "{ mirror = { albedo = [1.0, 1.0, 1.0] } }";
pub(super) const GLASS: &str = "{ dielectric = { eta = 1.5, tint = [1.0, 1.0, 1.0] } }";

/// A camera at the origin that looks along -z; for scenes of which only the geometry matters.
pub(super) const ANY_CAMERA: &str =
    "[camera.smallpt]\nposition = [0.0, 0.0, 0.0]\ndirection = [0.0, 0.0, -1.0]\nfield = 0.5\nadvance = 0.0\n";

/// A camera whose pixels all see one point.
pub(super) fn camera_at_a_point(position: [f64; 3], point: [f64; 3]) -> String {
    format!(
        "[camera.pinhole]\nposition = {position:?}\nlook-at = {point:?}\nup = [0.36, 0.48, 0.8]\nfield-of-view = 1e-6\n"
    )
}

/// An object; shape and material are what stands behind `=` in a scene file.
pub(super) fn object(name: &str, shape: &str, material: &str, emission: f64) -> String {
    let emission = [emission; 3];
    format!("[[objects]]\nname = '{name}'\nshape = {shape}\nmaterial = {material}\nemission = {emission:?}\n")
}

/// A dark sphere.
pub(super) fn ball(name: &str, center: [f64; 3], radius: f64, material: &str) -> String {
    object(name, &format!("{{ sphere = {{ center = {center:?}, radius = {radius:?} }} }}"), material, 0.0)
}

/// Writes a scene of these parts to a file and reads it. What stands before the first table comes first.
pub(super) fn read(parts: &[String]) -> Result<Scene> {
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().expect("a temporary file");
    file.write_all(format!("about = 'a hard case'\n{}", parts.concat()).as_bytes()).expect("a written file");
    load(file.path().to_str().expect("a path in UTF-8"))
}

/// A shape that the reader must refuse with an error of the user's that names field and value.
pub(super) fn refuses_shape(trials: &mut Trials, shape: &str, field: &str, value: &str) {
    let found = match read(&[ANY_CAMERA.to_string(), object("bad", shape, DIFFUSE, 0.0)]) {
        Ok(_) => Err("it was read".to_string()),
        Err(Error::Input(error)) if error.field == field && error.value.contains(value) => Ok(error),
        Err(error) => Err(error.to_string()),
    };
    // The place must be known; where the file lies differs from run to run, so it is not told.
    let placed = found.as_ref().is_ok_and(|error| error.place.as_ref().is_some_and(|place| place.at.is_some()));
    let told = match &found {
        Ok(error) => format!("{} = {}: {}", error.field, error.value, error.problem),
        Err(words) => words.clone(),
    };
    trials.holds(shape, format_args!("an input error at {field} = {value}"), told, placed);
}
