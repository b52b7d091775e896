//! Meshes: the triangles of a file in the scene's folder. It is a PLY file if its name ends in `.ply`, otherwise a
//! Wavefront OBJ file or one of its objects (`o` or `g` lines). Polygons are cut into triangles; normals, texture
//! coordinates and materials in the file are not used. Triangles without an area are left out.
//!
//! ```toml
//! shape = { mesh = { file = "box.obj", object = "tall-block" } }
//! ```
//!
//! A wrong path may lead to an endless file, so a file of more than a gibibyte is refused, unless the scene raises the
//! limit: `largest-mib = 4096`. `scale`, `rotate` and `translate` place the mesh ([`placing`]).

#[cfg(test)]
mod tests;

use super::placement::placing;
use super::polygon::Cutter;
use super::{Primitives, Shape, Triangle, foreign, obj, ply};
use crate::error::{Error, InputError, Result};
use crate::input::{coordinate_limit, degrees, length, point, unreadable};
use crate::math::Vec3;
use crate::scene::library::{Files, Folder};
use serde::Deserialize;
use std::io::BufRead;
use std::path::Path;

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
    object: Option<String>,
    /// The file's size limit in MiB.
    #[serde(default = "largest")]
    largest_mib: u32,
    /// Factor of every length.
    #[serde(default = "unscaled", deserialize_with = "length")]
    scale: f64,
    /// Angles about the axes, in degrees.
    #[serde(default, deserialize_with = "degrees")]
    rotate: [f64; 3],
    /// The place of the file's origin.
    #[serde(default = "origin", deserialize_with = "point")]
    translate: Vec3,
}

const fn unscaled() -> f64 {
    1.0
}

const fn origin() -> Vec3 {
    Vec3::new(0.0, 0.0, 0.0)
}

impl Mesh {
    fn error(&self, folder: &Folder, field: &str, value: &str, problem: &str) -> InputError {
        InputError::new(field, value, problem).in_file(folder.place_of(&self.file), None)
    }

    fn is_ply(&self) -> bool {
        Path::new(&self.file).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"))
    }

    /// Opens the file and refuses files of other kinds; also returns its first line, for messages.
    fn open(&self, files: &mut Files<'_>) -> Result<(Box<dyn BufRead>, String)> {
        // A binary file has no lines, so their length has no limit.
        let line = if self.is_ply() { u64::MAX } else { obj::LONGEST_LINE };
        let mut file = files.open(&self.file, u64::from(self.largest_mib) << 20, line)?;
        let start = file.fill_buf().map_err(|e| unreadable(Path::new(&files.folder.place_of(&self.file)), e))?;
        let first = foreign::first_line(start);
        if let Some(problem) = foreign::problem(start, self.is_ply()) {
            let allowed = "an OBJ file, or a PLY file whose name ends in .ply";
            return Err(self.error(files.folder, "mesh", &first, problem).allowed(allowed).into());
        }
        Ok((file, first))
    }

    /// Reads an OBJ file and passes on its faces.
    fn read_obj(
        &self,
        file: impl BufRead,
        files: &mut Files<'_>,
        face: impl FnMut(&[Vec3]) -> Result<()>,
    ) -> Result<()> {
        let name = files.folder.place_of(&self.file);
        let obj::Found { unused, objects } = obj::read(file, &name, self.object.as_deref(), files.hash, face)?;
        if !unused.is_empty() {
            files.remark(format!("{name}: {} are not used", unused.join(", ")));
        }
        match &self.object {
            Some(object) if !objects.contains(object) => {
                let names = objects.into_iter().take(MOST_NAMES).collect::<Vec<_>>().join(", ");
                let error = self.error(files.folder, "object", object, "there is no object of that name");
                Err(error.allowed(names).into())
            }
            _ => Ok(()),
        }
    }

    /// Reads a PLY file and passes on its faces.
    fn read_ply(
        &self,
        file: impl BufRead,
        files: &mut Files<'_>,
        face: impl FnMut(&[Vec3]) -> Result<()>,
    ) -> Result<()> {
        if let Some(object) = &self.object {
            return Err(self.error(files.folder, "object", object, "a PLY file has no objects").into());
        }
        let name = files.folder.place_of(&self.file);
        if ply::read(file, &name, files.hash, face)? {
            files.remark(format!("{name}: data behind the last element of the header are not used"));
        }
        Ok(())
    }

    /// The function that places a face's corners.
    fn placing(&self, folder: &Folder) -> impl Fn(&mut [Vec3]) -> Result<()> {
        let Self { scale, rotate, translate, .. } = *self;
        // A mesh that stays where it is keeps every bit.
        let is_moved = (scale, rotate, translate) != (1.0, [0.0; 3], origin());
        let placing = is_moved.then(|| placing(scale, rotate, translate));
        let beyond = self.error(folder, "mesh", "", "`scale` and `translate` move a vertex out of range");
        let beyond = beyond.allowed("-1e100 to 1e100 in each coordinate");
        move |corners| {
            let Some(placing) = &placing else { return Ok(()) };
            for corner in corners {
                *corner = placing(*corner);
                if ![corner.x, corner.y, corner.z].into_iter().all(coordinate_limit) {
                    return Err(Error::from(beyond.clone()));
                }
            }
            Ok(())
        }
    }
}

/// Most names of objects in a message.
const MOST_NAMES: usize = 50;

impl Shape for Mesh {
    fn add_to(self, primitives: &mut Primitives, files: &mut Files<'_>) -> Result<()> {
        let before = primitives.triangles.len();
        let (file, first) = self.open(files)?;
        let (mut cutter, mut corners, place) = (Cutter::default(), Vec::new(), self.placing(files.folder));
        let face = |face: &[Vec3]| {
            corners.clear();
            corners.extend_from_slice(face);
            place(&mut corners)?;
            cutter.cut(&corners, |corners| {
                let triangle = Triangle { corners };
                if triangle.is_degenerate() {
                    primitives.degenerate += 1;
                } else {
                    primitives.triangles.push(triangle);
                }
            });
            Ok(())
        };
        if self.is_ply() {
            self.read_ply(file, files, face)?;
        } else {
            self.read_obj(file, files, face)?;
        }
        let name = files.folder.place_of(&self.file);
        for doubt in cutter.doubts() {
            files.remark(format!("{name}: {doubt}"));
        }
        if primitives.triangles.len() == before {
            let start = if first.is_empty() { String::new() } else { format!("; the file begins with `{first}`") };
            let problem = format!("has no triangle of nonzero area{start}");
            return Err(self.error(files.folder, "mesh", "", &problem).into());
        }
        Ok(())
    }
}
