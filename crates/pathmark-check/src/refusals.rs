//! Inputs that the scene reader refuses.

use super::Trials;
use super::stage::{ANY_CAMERA, DIFFUSE, camera_above, named, object, sphere, try_scene};
use crate::error::Error;
use crate::material::Material;
use serde::Deserialize;

#[derive(Deserialize)]
struct Line {
    material: Material,
}

/// Reads the text behind `material = ` in a scene file.
pub(super) fn material(text: &str) -> Material {
    toml::from_str::<Line>(&format!("material = {text}")).expect("a material that the check has written").material
}

/// Checks that a scene with this value in place of `VALUE` in its material is refused for this field and value. The
/// error must be an input error with its place, which gives the exit code 2, and must state the allowed range.
pub(super) fn refused(trials: &mut Trials, material: &str, field: &str, value: &str, allowed: &str) {
    let material = material.replace("VALUE", value);
    let view = camera_above([0.0, 0.0, 3.0], [0.0; 3], 40.0);
    let found = try_scene(&[view, object(&sphere([0.0; 3], 1.0), &material, [0.0; 3])]);
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

/// Checks that the reader refuses a shape with an input error that names field and value.
pub(super) fn refuses_shape(trials: &mut Trials, shape: &str, field: &str, value: &str) {
    let found = match try_scene(&[ANY_CAMERA.to_string(), named("bad", shape, DIFFUSE, 0.0)]) {
        Ok(_) => Err("it was read".to_string()),
        Err(Error::Input(error)) if error.field == field && error.value.contains(value) => Ok(error),
        Err(error) => Err(error.to_string()),
    };
    // The place must be known. It is not printed, because the file's path differs between runs.
    let placed = found.as_ref().is_ok_and(|error| error.place.as_ref().is_some_and(|place| place.at.is_some()));
    let told = match &found {
        Ok(error) => format!("{} = {}: {}", error.field, error.value, error.problem),
        Err(words) => words.clone(),
    };
    trials.holds(shape, format_args!("an input error at {field} = {value}"), told, placed);
}
