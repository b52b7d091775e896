//! Scenes for cases, assembled from short parts and read by the program's scene reader.
//!
//! ```
//! use pathmark_check::stage::{camera, diffuse, object, scene, sphere};
//!
//! let wall = object(&sphere([0.0; 3], 1.0), &diffuse(0.5), [1.0; 3]);
//! let furnace = scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), wall]);
//! assert_eq!(furnace.objects.len(), 1);
//! ```

use crate::error::Result;
use crate::scene::Scene;

/// A camera whose spot is so small that it counts as a point: 2e-8 wide at distance 1.
pub fn camera(position: [f64; 3], look_at: [f64; 3]) -> String {
    view(position, look_at, [0.36, 0.48, 0.8], 1e-6)
}

/// A camera with a field of view in degrees.
pub fn view(position: [f64; 3], look_at: [f64; 3], up: [f64; 3], degrees: f64) -> String {
    format!(
        "[camera.pinhole]\nposition = {position:?}\nlook-at = {look_at:?}\nup = {up:?}\nfield-of-view = {degrees:?}\n"
    )
}

/// A camera with a field of view in degrees and an arbitrary up direction.
pub fn camera_above(position: [f64; 3], look_at: [f64; 3], degrees: f64) -> String {
    view(position, look_at, [0.36, 0.48, 0.8], degrees)
}

/// A camera at the origin that looks along -z, for scenes of which only the geometry matters.
pub const ANY_CAMERA: &str =
    "[camera.smallpt]\nposition = [0.0, 0.0, 0.0]\ndirection = [0.0, 0.0, -1.0]\nfield = 0.5\nadvance = 0.0\n";

/// A diffuse material, for cases in which only the kind of material matters.
pub const DIFFUSE: &str = "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }";
/// A mirror that absorbs nothing.
pub const MIRROR: &str = "{ mirror = { albedo = [1.0, 1.0, 1.0] } }";
/// Glass that absorbs nothing.
pub const GLASS: &str = "{ dielectric = { eta = 1.5, tint = [1.0, 1.0, 1.0] } }";

/// An object whose name is its shape and material. Both are given as the text behind `=` in a scene file.
pub fn object(shape: &str, material: &str, emission: [f64; 3]) -> String {
    let name = format!("{shape} {material}").replace('\'', "\"");
    format!("[[objects]]\nname = '{name}'\nshape = {shape}\nmaterial = {material}\nemission = {emission:?}\n")
}

/// An object with a given name and the same emission in all channels.
pub fn named(name: &str, shape: &str, material: &str, emission: f64) -> String {
    let emission = [emission; 3];
    format!("[[objects]]\nname = '{name}'\nshape = {shape}\nmaterial = {material}\nemission = {emission:?}\n")
}

/// A sphere with a given name and no emission.
pub fn ball(name: &str, center: [f64; 3], radius: f64, material: &str) -> String {
    named(name, &sphere(center, radius), material, 0.0)
}

pub fn sphere(center: [f64; 3], radius: f64) -> String {
    format!("{{ sphere = {{ center = {center:?}, radius = {radius:?} }} }}")
}

/// An infinite plane.
pub fn plane(point: [f64; 3], normal: [f64; 3]) -> String {
    format!("{{ plane = {{ point = {point:?}, normal = {normal:?} }} }}")
}

/// A quadrilateral, given by its four corners in order around the edge.
pub fn quad(corners: [[f64; 3]; 4]) -> String {
    format!("{{ quad = {{ corners = {corners:?} }} }}")
}

/// A diffuse material, the same in all channels.
pub fn diffuse(albedo: f64) -> String {
    format!("{{ diffuse = {{ albedo = {:?} }} }}", [albedo; 3])
}

/// A mirror, the same in all channels.
pub fn mirror(albedo: f64) -> String {
    format!("{{ mirror = {{ albedo = {:?} }} }}", [albedo; 3])
}

/// A point light, the same in all channels.
pub fn point_light(position: [f64; 3], intensity: f64) -> String {
    format!("[[point-lights]]\nposition = {position:?}\nintensity = {:?}\n", [intensity; 3])
}

/// Fog, the same in all channels, per unit of length.
pub fn fog(absorption: f64, scattering: f64, emission: f64) -> String {
    let (absorption, emission) = ([absorption; 3], [emission; 3]);
    format!("[fog]\nabsorption = {absorption:?}\nscattering = {scattering:?}\nemission = {emission:?}\n")
}

/// The inside of a unit sphere, all of which is alike.
pub fn hollow(material: &str, emission: [f64; 3]) -> Scene {
    scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), object(&sphere([0.0; 3], 1.0), material, emission)])
}

/// Reads a scene from its parts, or returns the error. Text that belongs before the first table must come first.
pub fn try_scene(parts: &[String]) -> Result<Scene> {
    Scene::from_toml(&format!("about = 'a case'\n{}", parts.concat()))
}

/// Reads a scene from its parts. Panics if it is invalid.
pub fn scene(parts: &[String]) -> Scene {
    try_scene(parts).unwrap_or_else(|error| panic!("{error} in\n{}", parts.concat()))
}
