//! The keys of scene files, for `pathmark list keys scene`. `docs/scene-file.md` says more about each.

/// A key of a scene file.
#[derive(Debug)]
pub struct SceneKey {
    /// Its path through the tables of the file: `camera.pinhole.position`.
    pub path: &'static str,
    pub kind: &'static str,
    /// The allowed values, as in the error about others; empty if the kind says all.
    pub range: &'static str,
    /// `required`, or the value without the key.
    pub default: &'static str,
    pub about: &'static str,
}

impl SceneKey {
    /// Meaning, type, range and default in a line.
    pub fn in_words(&self) -> String {
        let Self { kind, range, default, about, .. } = self;
        let range = if range.is_empty() { String::new() } else { format!(", {range}") };
        let default = if default.starts_with("required") { default.to_string() } else { format!("default: {default}") };
        format!("{about} [{kind}{range}; {default}]")
    }
}

/// A point or a direction.
const COORDINATES: &str = "-1e100 to 1e100 in each coordinate";
const LENGTH: &str = "1e-100 to 1e100";
const RADIANCE: &str = "0 to 1e100 in each channel";
const ALBEDO: &str = "0 to 1 in each channel";
const ETA: &str = "0.01 to 100";
const ROUGHNESS: &str = "0, or 1e-4 to 1";

macro_rules! keys {
    ($($path:literal, $kind:literal, $range:expr, $default:literal, $about:literal;)*) => {
        /// All keys of a scene file, outer ones first.
        pub const SCENE_KEYS: &[SceneKey] = &[$(
            SceneKey { path: $path, kind: $kind, range: $range, default: $default, about: $about },
        )*];
    };
}

keys! {
    "about", "text", "", "required", "one line for `pathmark list scenes`";
    "base", "text", "", "none", "name or path of a scene that this one changes: every entry replaces the base's entry of that name";
    "without", "list of texts", "", "none", "objects of the base to leave out";
    "estimator", "text", "", "smallpt", "the estimator, unless a command or an experiment names one";
    "background", "three numbers", RADIANCE, "black", "radiance of rays that meet nothing";
    "camera", "table", "", "required without `base`", "[camera.NAME] with a camera of `pathmark list cameras`";
    "objects", "list of tables", "", "required without `base` or `generator`", "surfaces, each under [[objects]]";
    "point-lights", "list of tables", "", "none", "lights without a size, each under [[point-lights]]";
    "fog", "table", "", "none", "a medium that fills the scene";
    "generator", "table", "", "none", "[generator.NAME] with a generator of `pathmark list generators`: objects that are computed";
    "faults", "table", "", "none", "wrong tests of spheres and planes, on purpose";
    "camera.pinhole.position", "three numbers", COORDINATES, "required", "the pinhole";
    "camera.pinhole.look-at", "three numbers", COORDINATES, "required", "the point in the middle of the image";
    "camera.pinhole.up", "three numbers", COORDINATES, "[0, 1, 0]", "the upward direction of the image";
    "camera.pinhole.field-of-view", "number", "1e-6 to 179 degrees", "required", "the vertical angle from the lower to the upper edge";
    "camera.thin-lens.position", "three numbers", COORDINATES, "required", "the middle of the lens";
    "camera.thin-lens.look-at", "three numbers", COORDINATES, "required", "the point in the middle of the image";
    "camera.thin-lens.up", "three numbers", COORDINATES, "[0, 1, 0]", "the upward direction of the image";
    "camera.thin-lens.field-of-view", "number", "1e-6 to 179 degrees", "required", "the vertical angle from the lower to the upper edge";
    "camera.thin-lens.radius", "number", LENGTH, "required", "radius of the lens";
    "camera.thin-lens.focus", "number", LENGTH, "required", "distance of the plane in focus, along the direction of view";
    "camera.smallpt.position", "three numbers", COORDINATES, "required", "the pinhole";
    "camera.smallpt.direction", "three numbers", COORDINATES, "required", "the direction of view, off the x axis";
    "camera.smallpt.field", "number", LENGTH, "required", "height of the image at distance 1";
    "camera.smallpt.advance", "number", "0 to 1e100", "required", "how far in front of the pinhole rays start";
    "objects.name", "text", "", "required", "unique in the scene";
    "objects.shape", "table", "", "required without `base`", "{ NAME = { ... } } with a shape of `pathmark list shapes`";
    "objects.material", "table", "", "required without `base`", "{ NAME = { ... } } with a material of `pathmark list materials`";
    "objects.emission", "three numbers", RADIANCE, "black", "radiance that it emits, from both sides";
    "objects.shape.sphere.center", "three numbers", COORDINATES, "required", "its centre";
    "objects.shape.sphere.radius", "number", LENGTH, "required", "its radius";
    "objects.shape.plane.point", "three numbers", COORDINATES, "required", "a point on it";
    "objects.shape.plane.normal", "three numbers", COORDINATES, "required", "the direction at right angles to it";
    "objects.shape.triangle.corners", "three points", COORDINATES, "required", "not on a line";
    "objects.shape.quad.corners", "four points", COORDINATES, "required", "in order around the edge";
    "objects.shape.mesh.file", "text", "", "required", "an OBJ or PLY file in the scene's folder";
    "objects.shape.mesh.object", "text", "", "all", "only this object of an OBJ file";
    "objects.shape.mesh.scale", "number", LENGTH, "1", "factor of every length; applied first";
    "objects.shape.mesh.rotate", "three numbers", "-360 to 360 degrees in each angle", "[0, 0, 0]", "angles about the x, y and z axes, in this order";
    "objects.shape.mesh.translate", "three numbers", COORDINATES, "[0, 0, 0]", "place of the file's origin; applied last";
    "objects.shape.mesh.largest-mib", "whole number", "", "1024", "size limit of the file in MiB";
    "objects.material.diffuse.albedo", "three numbers", ALBEDO, "required", "share of light that it reflects";
    "objects.material.mirror.albedo", "three numbers", ALBEDO, "required", "share of light that it reflects";
    "objects.material.dielectric.eta", "number", ETA, "required", "index of refraction inside over the one outside";
    "objects.material.dielectric.tint", "three numbers", ALBEDO, "required", "share of light that each lobe keeps";
    "objects.material.dielectric.fresnel", "schlick or exact", "", "schlick", "formula of the reflected share";
    "objects.material.polished.albedo", "three numbers", ALBEDO, "required", "share that the base reflects";
    "objects.material.polished.reflectivity", "number", "0 to 1", "required", "share of light that is mirrored";
    "objects.material.fresnel-mirror.eta", "number", ETA, "required", "index of refraction inside over the one outside";
    "objects.material.conductor.alpha", "number", ROUGHNESS, "required", "roughness, the alpha of GGX";
    "objects.material.conductor.f0", "three numbers", ALBEDO, "required", "reflectance at normal incidence";
    "objects.material.kd-ks.kd", "three numbers", ALBEDO, "required", "share that the base scatters";
    "objects.material.kd-ks.eta", "number", ETA, "required", "index of refraction inside over the one outside";
    "objects.material.kd-ks.roughness", "number", ROUGHNESS, "required", "roughness, the alpha of GGX";
    "objects.material.kd-ks.sampling", "cosine or vndf", "", "cosine", "how directions are sampled";
    "objects.material.guarded-kd-ks.kd", "three numbers", ALBEDO, "required", "share that the base scatters";
    "objects.material.guarded-kd-ks.eta", "number", ETA, "required", "index of refraction inside over the one outside";
    "objects.material.guarded-kd-ks.roughness", "number", ROUGHNESS, "required", "roughness, the alpha of GGX";
    "point-lights.position", "three numbers", COORDINATES, "required", "its place";
    "point-lights.intensity", "three numbers", RADIANCE, "required", "radiant intensity";
    "point-lights.reach", "number", LENGTH, "none", "the distance beyond which it gives no light";
    "fog.absorption", "three numbers", RADIANCE, "required", "share of light that is absorbed, per length";
    "fog.scattering", "number", "0 to 1e100", "required", "share of light that is scattered, per length";
    "fog.emission", "three numbers", RADIANCE, "black", "radiance of infinitely deep fog";
    "faults.smaller-root-only", "true or false", "", "false", "a sphere is missed if its smaller root lies behind the ray's start";
    "faults.plane-limit", "number", "0 to 1", "0", "a plane is missed by rays whose cosine to its normal is smaller";
    "faults.sphere-epsilon", "number", "0 to 1e100", "none", "a sphere is missed if its first root ahead is not farther than this";
    "generator.spheres.count", "whole number", "a whole number from 1 to 10000000", "required", "balls in a cube";
    "generator.spheres.seed", "whole number", "", "required", "seed of places and colours";
    "generator.clusters.count", "whole number", "a whole number from 1 to 10000000", "required", "balls in a cube";
    "generator.clusters.groups", "whole number", "", "required", "clusters, 1 to 65535";
    "generator.clusters.seed", "whole number", "", "required", "seed of places and colours";
    "generator.imbalance.factor", "number", "a factor from 7 to 1000", "required", "mean number of rays of a path in one corner of the image";
    "generator.bumpy-ball.triangles", "whole number", "a whole number from 8 to 10000000", "required", "the fewest triangles";
    "generator.furnace.albedo", "number", "an albedo from 0 to below 1", "required", "share of light that the walls reflect";
}
