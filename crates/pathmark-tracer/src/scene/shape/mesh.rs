//! Meshes: the triangles of a file in the scene's folder. It is a PLY file if its name ends in `.ply`, otherwise a
//! Wavefront OBJ file or one of its objects (`o` or `g` lines). Polygons are cut into triangles; normals, texture
//! coordinates and materials in the file are not used. Triangles without an area are left out.
//!
//! ```toml
//! shape = { mesh = { file = "box.obj", object = "tall-block" } }
//! ```
//!
//! A wrong path may lead to an endless file, so a file of more than a gibibyte is refused, unless the scene raises the
//! limit: `largest-mib = 4096`.

use super::obj::Essence;
use super::{Primitives, Shape, Triangle, ply};
use crate::error::{InputError, Result};
use crate::math::Vec3;
use crate::scene::source::{Files, Folder};
use serde::Deserialize;
use std::io::BufReader;
use std::path::Path;

/// The longest line of a text in bytes; real lines are far shorter.
const LONGEST_LINE: u64 = 1 << 20;

/// The default size limit in MiB: a file of some ten million triangles.
const fn largest() -> u32 {
    1024
}

/// A mesh in a file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(in crate::scene) struct Mesh {
    /// The file, in the scene's folder.
    file: String,
    /// The object in it; all objects if `None`.
    object: Option<String>,
    /// The file's size limit in MiB.
    #[serde(default = "largest")]
    largest_mib: u32,
}

impl Mesh {
    fn error(&self, folder: &Folder, field: &str, value: &str, problem: &str) -> InputError {
        InputError::new(field, value, problem).in_file(folder.place_of(&self.file), None)
    }
}

impl Mesh {
    fn is_ply(&self) -> bool {
        Path::new(&self.file).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"))
    }

    /// Adds the triangles of an OBJ file.
    fn add_obj(&self, files: &mut Files<'_>, mut add: impl FnMut([Vec3; 3])) -> Result<()> {
        let file = files.open(&self.file, u64::from(self.largest_mib) << 20, LONGEST_LINE)?;
        let folder = files.folder;
        let name = folder.place_of(&self.file);
        let mut text = BufReader::new(Essence::new(file, &name, files.hash));
        let options = tobj::LoadOptions { triangulate: true, single_index: true, ..tobj::LoadOptions::default() };
        let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
        let models = tobj::load_obj_buf(&mut text, &options, no_materials);
        let Essence { unused, error, .. } = text.into_inner();
        if let Some(error) = error {
            return Err(error);
        }
        let (models, _) = models.map_err(|problem| self.error(folder, "mesh", "", &problem.to_string()))?;
        if !unused.is_empty() {
            files.remark(format!("{name}: {} are not used", unused.join(", ")));
        }
        if let Some(object) = self.object.as_ref().filter(|object| !models.iter().any(|model| model.name == **object)) {
            let names: Vec<&str> = models.iter().map(|model| model.name.as_str()).collect();
            let error = self.error(folder, "object", object, "there is no object of that name");
            return Err(error.allowed(names.join(", ")).into());
        }
        for model in models.iter().filter(|model| self.object.as_ref().is_none_or(|object| model.name == *object)) {
            let corner = |index: u32| {
                let at = 3 * index as usize;
                let [x, y, z] = [0, 1, 2].map(|k| model.mesh.positions.get(at + k).copied());
                Some(Vec3::new(x?, y?, z?))
            };
            for face in model.mesh.indices.chunks_exact(3) {
                let [Some(a), Some(b), Some(c)] = [face[0], face[1], face[2]].map(corner) else {
                    return Err(self
                        .error(folder, "f", &face[0].to_string(), "refers to a vertex that does not exist")
                        .into());
                };
                add([a, b, c]);
            }
        }
        Ok(())
    }

    /// Adds the triangles of a PLY file.
    fn add_ply(&self, files: &mut Files<'_>, add: impl FnMut([Vec3; 3])) -> Result<()> {
        if let Some(object) = &self.object {
            return Err(self.error(files.folder, "object", object, "a PLY file has no objects").into());
        }
        // A binary file has no lines, so their length has no limit.
        let file = files.open(&self.file, u64::from(self.largest_mib) << 20, u64::MAX)?;
        ply::read(file, &files.folder.place_of(&self.file), files.hash, add)
    }
}

impl Shape for Mesh {
    fn add_to(self, primitives: &mut Primitives, files: &mut Files<'_>) -> Result<()> {
        let before = primitives.triangles.len();
        let add = |corners: [Vec3; 3]| {
            let triangle = Triangle { corners };
            if triangle.is_degenerate() {
                primitives.degenerate += 1;
            } else {
                primitives.triangles.push(triangle);
            }
        };
        if self.is_ply() {
            self.add_ply(files, add)?;
        } else {
            self.add_obj(files, add)?;
        }
        if primitives.triangles.len() == before {
            return Err(self.error(files.folder, "mesh", "", "has no triangle of nonzero area").into());
        }
        Ok(())
    }
}
