//! Scene files.
//!
//! ```toml
//! about = "A red wall"
//! estimator = "smallpt"        # optional: the estimator that is used unless another is asked for
//!
//! [camera.smallpt]
//! position = [50.0, 52.0, 295.6]
//! direction = [0.0, -0.042612, -1.0]
//! field = 0.5135
//! advance = 140.0
//!
//! [[objects]]
//! name = "left wall"
//! shape = { sphere = { center = [100001.0, 40.8, 81.6], radius = 1e5 } }
//! material = { diffuse = { albedo = [0.75, 0.25, 0.25] } }
//! emission = [0.0, 0.0, 0.0]   # optional
//! ```

use super::{Camera, Object, Scene, Sphere};
use crate::digest;
use crate::error::{InputError, Result};
use crate::input::{locate, parse, radiance};
use crate::material::{Effects, Material};
use crate::math::Rgb;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    about: String,
    estimator: Option<String>,
    camera: CameraFile,
    objects: Vec<ObjectFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
enum CameraFile {
    Smallpt(Camera),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectFile {
    name: String,
    shape: ShapeFile,
    material: Material,
    #[serde(default = "black", deserialize_with = "radiance")]
    emission: Rgb,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
enum ShapeFile {
    Sphere(Sphere),
}

fn black() -> Rgb {
    Rgb::BLACK
}

/// Reads a scene; `name` becomes the scene's, `file` is shown in errors.
pub(super) fn scene_from_text(name: &str, file: &str, text: &str) -> Result<Scene> {
    let parsed: SceneFile = parse(text, file)?;
    if parsed.objects.is_empty() {
        return Err(InputError::new("objects", "[]", "a scene needs at least one object")
            .in_file(file, locate(text, "objects", "[]"))
            .into());
    }
    let CameraFile::Smallpt(camera) = parsed.camera;
    let (mut shapes, mut objects) = (Vec::new(), Vec::new());
    for object in parsed.objects {
        let ShapeFile::Sphere(shape) = object.shape;
        shapes.push(shape);
        objects.push(Object { name: object.name, material: object.material, emission: object.emission });
    }
    let effects = objects.iter().fold(Effects::default(), |all, object| all.and(object.material.effects()));
    Ok(Scene {
        name: name.to_string(),
        about: parsed.about,
        hash: digest::of_text(text),
        default_estimator: parsed.estimator,
        camera,
        shapes,
        objects,
        effects,
    })
}
