//! Scene files.
//!
//! ```toml
//! about = "A red wall"
//! base = "cornell"             # optional: a scene that this one changes
//! estimator = "smallpt"        # optional: the estimator that is used unless another is asked for
//! background = [0.0, 0.0, 0.0] # optional: the radiance of rays that meet nothing; without it the scene should be closed
//!
//! [camera.smallpt]             # a camera of `pathmark list cameras`
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
//!
//! A file may also have `[[point-lights]]`, a `[fog]`, `[faults]` and a `[generator.NAME]`. With a base, every entry replaces the
//! base's entry of that name. An object with the name of one of the base's objects replaces only the fields that it
//! has, and `without` lists objects to leave out.

use super::generator::{Generator, Made};
use super::library::{CustomScene, Files, Folder, SCENES, Source, source};
use super::shape::{AnyShape, Primitives};
use super::{Camera, Faults, Fog, Object, PointLight, Scene, USUAL_ESTIMATOR};
use crate::digest::Fingerprint;
use crate::error::{Error, InputError, Result};
use crate::input::{locate, parse, radiance};
use crate::material::Material;
use crate::math::Rgb;
use crate::scene::camera::CameraFile;
use serde::{Deserialize, Deserializer};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::rc::Rc;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SceneFile {
    about: String,
    base: Option<String>,
    #[serde(default)]
    without: Vec<String>,
    estimator: Option<String>,
    #[serde(default, deserialize_with = "some_radiance")]
    background: Option<Rgb>,
    camera: Option<CameraFile>,
    fog: Option<Fog>,
    faults: Option<Faults>,
    point_lights: Option<Vec<PointLight>>,
    generator: Option<Generator>,
    #[serde(default)]
    objects: Vec<ObjectFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectFile {
    name: String,
    shape: Option<AnyShape>,
    material: Option<Material>,
    #[serde(default, deserialize_with = "some_radiance")]
    emission: Option<Rgb>,
}

fn some_radiance<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Option<Rgb>, D::Error> {
    radiance(deserializer).map(Some)
}

/// An object before its shapes are turned into primitives.
struct Part {
    name: String,
    shapes: Vec<AnyShape>,
    source: Rc<Source>,
    material: Material,
    emission: Rgb,
}

/// A scene while it is assembled from its bases.
#[derive(Default)]
struct Draft {
    estimator: Option<String>,
    background: Option<Rgb>,
    camera: Option<Camera>,
    fog: Option<Fog>,
    faults: Option<Faults>,
    point_lights: Vec<PointLight>,
    generator: Option<Generator>,
    parts: Vec<Part>,
    hash: Fingerprint,
    files: Vec<PathBuf>,
}

/// The longest chain of bases; a longer one counts as circular.
const DEEPEST_BASE: usize = 8;

/// Reads a scene. `number` is for its generator, with its text as given. `own` are scenes that may be its base, besides
/// the embedded ones.
pub(super) fn scene_from_text(source: Source, number: Option<(f64, &str)>, own: &[CustomScene]) -> Result<Scene> {
    let source = &Rc::new(source);
    let (mut draft, about) = draft(source, 0, own)?;
    let mut name = source.name.clone();
    if let Some((number, given)) = number {
        let problem = match &mut draft.generator {
            None => Err("none, because only scenes with a generator take a number"),
            Some(generator) => generator.set_number(number),
        };
        problem.map_err(|allowed| {
            let given = format!("{name}:{given}");
            InputError::new("scene", given, "the number after the colon is not allowed").allowed(allowed)
        })?;
        name = format!("{name}:{number}");
        draft.hash.update(number.to_string().as_bytes());
    }
    let generated =
        draft.generator.iter().flat_map(Generator::make).map(|Made { name, shapes, material, emission }| Part {
            name,
            shapes,
            source: Rc::clone(source),
            material,
            emission,
        });
    draft.parts.extend(generated.collect::<Vec<_>>());
    let Some(camera) = draft.camera else {
        return Err(missing(source, "camera", "a scene needs a camera"));
    };
    if draft.parts.is_empty() {
        return Err(missing(source, "objects", "a scene needs at least one object"));
    }
    let mut scene = Scene {
        name,
        about,
        hash: String::new(),
        files: draft.files,
        remarks: Vec::new(),
        near: None,
        default_estimator: draft.estimator,
        camera,
        primitives: Primitives::default(),
        objects: Vec::new(),
        owners: Vec::new(),
        meshes: Vec::new(),
        point_lights: draft.point_lights,
        background: draft.background,
        fog: draft.fog,
        hierarchy: None,
        lights: None,
        epsilon: None,
        faults: draft.faults,
    };
    add_parts(&mut scene, draft.parts, &mut draft.hash)?;
    scene.resolve_coincident();
    scene.near = scene.near_in_single_precision();
    scene.hash = draft.hash.finish();
    scene.remarks.extend(scene.remarks_on_light());
    Ok(scene)
}

/// Returns [`Scene::estimator`] without reading any more of the scene.
pub(super) fn estimator_of_text(source: Source, own: &[CustomScene]) -> Result<String> {
    let (draft, _) = draft(&Rc::new(source), 0, own)?;
    Ok(draft.estimator.unwrap_or_else(|| USUAL_ESTIMATOR.to_string()))
}

/// Turns parts into objects and primitives, which are numbered kind by kind.
fn add_parts(scene: &mut Scene, parts: Vec<Part>, hash: &mut Fingerprint) -> Result<()> {
    let mut owners: Vec<Vec<u32>> = vec![Vec::new(); scene.primitives.counts().len()];
    for (index, part) in (0u32..).zip(parts) {
        let before = scene.primitives.counts();
        let mut files = Files {
            folder: &part.source.folder,
            object: &part.name,
            hash,
            read: &mut scene.files,
            remarks: &mut scene.remarks,
        };
        for shape in part.shapes {
            if matches!(shape, AnyShape::Mesh(_)) {
                scene.meshes.push(index);
            }
            shape
                .add_to(&mut scene.primitives, &mut files)
                .map_err(|problem| at_object(&part.source, &part.name, problem))?;
        }
        for ((owners, before), now) in owners.iter_mut().zip(before).zip(scene.primitives.counts()) {
            owners.extend(std::iter::repeat_n(index, now - before));
        }
        let Part { name, material, emission, .. } = part;
        scene.objects.push(Object { name, material, emission, angular_emission: None });
    }
    scene.owners = owners.concat();
    Ok(())
}

/// Adds the object's position to an input error of its shape that has no position.
fn at_object(source: &Source, name: &str, problem: Error) -> Error {
    problem.placed(|problem| problem.in_file(&source.file, locate(&source.text, "name", name)).into())
}

fn missing(source: &Source, field: &str, problem: &str) -> Error {
    // An empty list has a position; a missing field has none.
    let at = locate(&source.text, field, "[]");
    InputError::new(field, if at.is_some() { "[]" } else { "" }, problem).in_file(&source.file, at).into()
}

/// Applies a file's entries to the draft of its base; returns the draft and the file's `about`.
fn draft(source: &Rc<Source>, depth: usize, own: &[CustomScene]) -> Result<(Draft, String)> {
    let mut file: SceneFile = parse(&source.text, &source.file)?;
    if let Some(generator) = &mut file.generator {
        let (field, number) = (generator.field(), generator.number());
        generator.set_number(number).map_err(|allowed| {
            let error = InputError::new(field, number.to_string(), "is out of range").allowed(allowed);
            error.in_file(&source.file, locate(&source.text, field, ""))
        })?;
    }
    let mut draft = match &file.base {
        None => Draft::default(),
        Some(base) => base_of(source, base, depth, own)?,
    };
    draft.hash.update(source.text.as_bytes());
    if matches!(source.folder, Folder::Disk(_)) {
        draft.files.push(PathBuf::from(&source.file));
    }
    draft.estimator = file.estimator.or(draft.estimator);
    draft.background = file.background.or(draft.background);
    draft.camera = file.camera.map(Camera::from).or(draft.camera);
    draft.fog = file.fog.or(draft.fog);
    draft.faults = file.faults.or(draft.faults);
    draft.point_lights = file.point_lights.unwrap_or(draft.point_lights);
    draft.generator = file.generator.or(draft.generator);
    let mut kept: BTreeSet<&str> = draft.parts.iter().map(|part| part.name.as_str()).collect();
    for name in &file.without {
        if !kept.remove(name.as_str()) {
            let error = InputError::new("without", name, "the base has no object of that name");
            return Err(error.in_file(&source.file, locate(&source.text, "without", name)).into());
        }
    }
    let left_out: BTreeSet<&str> = file.without.iter().map(String::as_str).collect();
    draft.parts.retain(|part| !left_out.contains(part.name.as_str()));
    let inherited = draft.parts.len();
    let mut names: BTreeMap<String, usize> =
        draft.parts.iter().enumerate().map(|(index, part)| (part.name.clone(), index)).collect();
    for object in file.objects {
        let own = names.get(&object.name).copied();
        match (own, object) {
            (Some(index), object) if index < inherited => {
                let part = &mut draft.parts[index];
                if let Some(shape) = object.shape {
                    (part.shapes, part.source) = (vec![shape], Rc::clone(source));
                }
                part.material = object.material.unwrap_or(part.material.clone());
                part.emission = object.emission.unwrap_or(part.emission);
            }
            (Some(_), object) => {
                let error = InputError::new("name", &object.name, "two objects have this name");
                return Err(error.in_file(&source.file, locate(&source.text, "name", &object.name)).into());
            }
            (None, ObjectFile { name, shape: Some(shape), material: Some(material), emission }) => {
                let (emission, source) = (emission.unwrap_or(Rgb::BLACK), Rc::clone(source));
                names.insert(name.clone(), draft.parts.len());
                draft.parts.push(Part { name, shapes: vec![shape], source, material, emission });
            }
            (None, object) => {
                let lacks = if object.shape.is_none() { "shape" } else { "material" };
                let error = InputError::new("name", &object.name, format!("the object has no {lacks}"));
                return Err(error.in_file(&source.file, locate(&source.text, "name", &object.name)).into());
            }
        }
    }
    Ok((draft, file.about))
}

fn base_of(from: &Source, base: &str, depth: usize, own: &[CustomScene]) -> Result<Draft> {
    let error =
        |problem: String| InputError::new("base", base, problem).in_file(&from.file, locate(&from.text, "base", base));
    if depth == DEEPEST_BASE {
        return Err(error(format!("follows a chain of {DEEPEST_BASE} bases, which may form a circle")).into());
    }
    if let Some((name, _)) = base.split_once(':').filter(|(name, _)| SCENES.iter().any(|(known, _)| known == name)) {
        let error = error("has a number, which a base does not take".to_string());
        return Err(error.allowed(format!("{name}; a table [generator.NAME] replaces that of the base")).into());
    }
    let source = source(base, &from.folder, own)
        .map_err(|problem| problem.placed(|problem| error(problem.problem).allowed(problem.allowed).into()))?;
    Ok(draft(&Rc::new(source), depth + 1, own)?.0)
}
