//! A scene as arrays of numbers and words, and the layout of both. The program's names of offsets come from here.

use super::plan::ForDevice;
use crate::lanes::{SpheresF32, surfaces};
use pathmark_tracer::estimator::{By, LightSampling, camera_share};
use pathmark_tracer::kernel::RenderOptions;
use pathmark_tracer::material::{Dielectric, Facets, Fresnel, Material, Sampling};
use pathmark_tracer::math::Precision;
use pathmark_tracer::math::{Rgb, SphereByCurvature, Vec3};
use pathmark_tracer::sampling::{ORDERS, mix};
use pathmark_tracer::scene::{AllEffects, AnyTarget, Bounds, Filter, Hierarchy, Object, Scene, padding};

/// The samplers that the program knows, with its names for them, in the order of their numbers.
pub(super) const SAMPLERS: &[(&str, &str)] = &[
    ("hash", "SAMPLER_HASH"),
    ("independent", "SAMPLER_INDEPENDENT"),
    ("sobol", "SAMPLER_SOBOL"),
    ("stratified", "SAMPLER_STRATIFIED"),
];

/// Fields at the beginning of the words, with the number of words of each.
pub(super) const WORDS: &[(&str, usize)] = &[
    ("AT_SAMPLER", 1),
    ("AT_SEED_KEY", 2),
    ("AT_WIDTH", 1),
    ("AT_FILTER", 1),
    ("AT_MAX_DEPTH", 1),
    ("AT_CAMERA_RAYS", 1),
    ("AT_ROULETTE", 2),
    ("AT_IS_WEIGHTED", 1),
    ("AT_SPHERE_COUNT", 1),
    ("AT_PLANE_COUNT", 1),
    ("AT_TRIANGLE_COUNT", 1),
    ("AT_NODE_COUNT", 1),
    ("AT_LIGHT_COUNT", 1),
    ("AT_POINT_LIGHT_COUNT", 1),
    ("AT_ENCLOSING_COUNT", 1),
    ("AT_LARGE_COUNT", 1),
    // Offsets of the arrays of numbers.
    ("AT_SPHERES", 1),
    ("AT_PLANES", 1),
    ("AT_TRIANGLES", 1),
    ("AT_BOXES", 1),
    ("AT_OBJECTS", 1),
    ("AT_LIGHTS", 1),
    ("AT_POINT_LIGHTS", 1),
    ("AT_LARGE", 1),
    ("AT_SURFACES", 1),
    // Offsets of the arrays of words.
    ("AT_NODES", 1),
    ("AT_ORDER", 1),
    ("AT_OWNERS", 1),
    ("AT_KINDS", 1),
    ("AT_LIGHT_KINDS", 1),
    ("AT_LIGHT_OF", 1),
    ("AT_LARGE_NUMBERS", 1),
    ("AT_IS_LARGE", 1),
    ("AT_ORDERS", ORDERS.len()),
];

/// Fields at the beginning of the numbers, with the length of each.
pub(super) const NUMBERS: &[(&str, usize)] = &[
    ("VIEW_POSITION", 3),
    ("VIEW_DIRECTION", 3),
    ("VIEW_RIGHT", 3),
    ("VIEW_UP", 3),
    ("VIEW_WIDTH", 1),
    ("VIEW_HEIGHT", 1),
    ("VIEW_ADVANCE", 1),
    ("VIEW_LENS_RADIUS", 1),
    ("VIEW_LENS_FOCUS", 1),
    ("VIEW_LENS_RIGHT", 3),
    ("VIEW_LENS_UP", 3),
    ("VIEW_BACKGROUND", 3),
    ("VIEW_ROULETTE", 1),
    ("VIEW_CAMERA_SHARE", 1),
];

/// Count of the numbers of an object, of a light and of a point light.
pub(super) const OBJECT_NUMBERS: usize = 14;
pub(super) const LIGHT_NUMBERS: usize = 15;
pub(super) const POINT_LIGHT_NUMBERS: usize = 7;

/// Materials, in the order of the program's numbers for them.
pub(super) const MATERIALS: &[&str] = &[
    "MATERIAL_DIFFUSE",
    "MATERIAL_MIRROR",
    "MATERIAL_DIELECTRIC",
    "MATERIAL_POLISHED",
    "MATERIAL_FRESNEL_MIRROR",
    "MATERIAL_CONDUCTOR",
    "MATERIAL_KD_KS",
];

/// Other enumerations of the program, each numbered from 0.
pub(super) const KINDS: &[&[&str]] = &[
    &["FILTER_TENT", "FILTER_BOX", "FILTER_CENTER"],
    &["ROULETTE_ALBEDO", "ROULETTE_THROUGHPUT", "ROULETTE_CONSTANT"],
    &["LIGHT_SPHERE", "LIGHT_CAP", "LIGHT_TRIANGLE"],
];

fn place(layout: &[(&str, usize)], name: &str) -> usize {
    layout.iter().take_while(|(other, _)| *other != name).map(|(_, length)| length).sum()
}

/// The program's data of a material: the name of its kind, flags, a colour, η, α and a reflectivity.
struct Surface {
    kind: &'static str,
    flags: u32,
    colour: Rgb,
    eta: f64,
    alpha: f64,
    reflectivity: f64,
}

fn alpha(facets: Facets) -> f64 {
    if let Facets::Rough(ggx) = facets { ggx.alpha() } else { 0.0 }
}

/// The data of a material; `None` if the program does not know the material.
fn surface(material: &Material) -> Option<Surface> {
    let plain = |kind, colour| Surface { kind, flags: 0, colour, eta: 1.0, alpha: 0.0, reflectivity: 0.0 };
    Some(match material {
        Material::Diffuse(it) => plain("MATERIAL_DIFFUSE", it.albedo),
        Material::Mirror(it) => plain("MATERIAL_MIRROR", it.albedo),
        Material::Dielectric(Dielectric { eta, tint, fresnel }) => {
            let flags = u32::from(*fresnel == Fresnel::Exact);
            Surface { flags, eta: *eta, ..plain("MATERIAL_DIELECTRIC", *tint) }
        }
        Material::Polished(it) => Surface { reflectivity: it.reflectivity, ..plain("MATERIAL_POLISHED", it.albedo) },
        Material::FresnelMirror(it) => Surface { eta: it.eta, ..plain("MATERIAL_FRESNEL_MIRROR", Rgb::WHITE) },
        Material::Conductor(it) => Surface { alpha: alpha(it.facets), ..plain("MATERIAL_CONDUCTOR", it.f0) },
        Material::KdKs(it) => {
            let flags = u32::from(it.sampling == Sampling::Vndf) << 1;
            Surface { flags, eta: it.eta, alpha: alpha(it.facets), ..plain("MATERIAL_KD_KS", it.kd) }
        }
        Material::GuardedKdKs(_) => return None,
    })
}

/// Whether the program knows a material.
pub(super) fn is_known(material: &Material) -> bool {
    surface(material).is_some()
}

/// The arrays: fields at the beginning, then appended arrays.
struct Tables {
    precision: Precision,
    numbers: Vec<f64>,
    words: Vec<u32>,
}

impl Tables {
    fn set_words(&mut self, name: &str, values: &[u32]) {
        let first = place(WORDS, name);
        self.words[first..first + values.len()].copy_from_slice(values);
    }

    fn set_numbers(&mut self, name: &str, values: &[f64]) {
        let first = place(NUMBERS, name);
        self.numbers[first..first + values.len()].copy_from_slice(values);
    }

    /// Appends an array of numbers and stores its offset.
    fn add_numbers(&mut self, name: &str, values: impl Iterator<Item = f64>) {
        let first = self.numbers.len() as u32;
        self.set_words(name, &[first]);
        self.numbers.extend(values);
    }

    /// Appends an array of words and stores its offset.
    fn add_words(&mut self, name: &str, values: impl Iterator<Item = u32>) {
        let first = self.words.len() as u32;
        self.set_words(name, &[first]);
        self.words.extend(values);
    }

    fn add_primitives(&mut self, scene: &Scene) {
        let primitives = &scene.primitives;
        self.set_words("AT_SPHERE_COUNT", &[primitives.spheres.len() as u32]);
        self.set_words("AT_PLANE_COUNT", &[primitives.planes.len() as u32]);
        self.set_words("AT_TRIANGLE_COUNT", &[primitives.triangles.len() as u32]);
        let spheres = primitives.spheres.iter();
        self.add_numbers("AT_SPHERES", spheres.flat_map(|it| [it.center.x, it.center.y, it.center.z, it.radius]));
        let planes = primitives.planes.iter();
        self.add_numbers("AT_PLANES", planes.flat_map(|it| [it.point, it.normal]).flat_map(coordinates));
        let corners = primitives.triangles.iter().flat_map(|it| it.corners);
        self.add_numbers("AT_TRIANGLES", corners.flat_map(coordinates));
        self.add_words("AT_OWNERS", scene.owners.iter().copied());
        let tree = scene.hierarchy.as_ref();
        self.set_words("AT_NODE_COUNT", &[tree.map_or(0, |tree| tree.nodes().len() as u32)]);
        let nodes = || tree.into_iter().flat_map(Hierarchy::nodes);
        // The hierarchy pads its boxes for double precision; hits in single precision are less exact.
        let more = if self.precision == Precision::F32 { padding(f32::MANTISSA_DIGITS) } else { 0.0 };
        let padded = |[low, high]: [[f64; 3]; 2]| {
            let bounds = Bounds { low, high };
            let Bounds { low, high } = bounds.grown(more * bounds.largest());
            [low, high]
        };
        self.add_numbers("AT_BOXES", nodes().flat_map(|node| padded(node.faces)).flatten());
        self.add_words("AT_NODES", nodes().flat_map(|node| [node.at, node.count]));
        self.add_words("AT_ORDER", tree.into_iter().flat_map(|tree| tree.order().iter().copied()));
    }

    fn add_objects(&mut self, objects: &[Object]) {
        let surfaces = || objects.iter().filter_map(|object| Some((object, surface(&object.material)?)));
        self.add_numbers(
            "AT_OBJECTS",
            surfaces().flat_map(|(object, surface)| {
                let colours = [object.emission, surface.colour, object.material.albedo::<AllEffects>()];
                let root = (surface.eta - 1.0) / (surface.eta + 1.0);
                let rest = [surface.eta, 1.0 / surface.eta, root * root, surface.alpha, surface.reflectivity];
                colours.into_iter().flat_map(Rgb::channels).chain(rest)
            }),
        );
        let kind = |kind: &str| MATERIALS.iter().take_while(|name| **name != kind).count() as u32;
        self.add_words("AT_KINDS", surfaces().map(|(_, surface)| kind(surface.kind) | surface.flags << 8));
    }

    fn add_lights(&mut self, scene: &Scene) {
        let lights = scene.lights.as_ref();
        let all = || lights.into_iter().flat_map(|lights| &lights.lights);
        self.set_words("AT_LIGHT_COUNT", &[all().count() as u32]);
        self.add_numbers(
            "AT_LIGHTS",
            all().flat_map(|light| {
                let mut numbers = [0.0; LIGHT_NUMBERS];
                numbers[..3].copy_from_slice(&[light.chance, light.up_to, light.target.area()]);
                let rest: Vec<f64> = match &light.target {
                    AnyTarget::Sphere(target) => {
                        let (sphere, cap) = target.parts();
                        let axis = cap.map_or(Vec3::new(0.0, 0.0, 0.0), |cap| cap.axis);
                        let sizes = coordinates(sphere.center).into_iter().chain([sphere.radius]);
                        sizes.chain(coordinates(axis)).chain([cap.map_or(0.0, |cap| cap.height)]).collect()
                    }
                    AnyTarget::Triangle(target) => {
                        let [e, f] = target.edges;
                        [target.corner, e, f, target.normal].into_iter().flat_map(coordinates).collect()
                    }
                };
                numbers[3..3 + rest.len()].copy_from_slice(&rest);
                numbers
            }),
        );
        let kind = |target: &AnyTarget| match target {
            AnyTarget::Sphere(target) => u32::from(target.parts().1.is_some()),
            AnyTarget::Triangle(_) => 2,
        };
        self.add_words("AT_LIGHT_KINDS", all().flat_map(|light| [kind(&light.target), light.primitive]));
        self.add_words("AT_LIGHT_OF", lights.into_iter().flat_map(|lights| lights.of_primitive.iter().copied()));
        self.set_words("AT_POINT_LIGHT_COUNT", &[scene.point_lights.len() as u32]);
        self.add_numbers(
            "AT_POINT_LIGHTS",
            scene.point_lights.iter().flat_map(|light| {
                let place = coordinates(light.position).into_iter().chain(light.intensity.channels());
                place.chain([light.reach.unwrap_or(f64::INFINITY)])
            }),
        );
    }

    /// Adds the data of primitives for single precision: large spheres by curvature, and surfaces for shading.
    fn add_singles(&mut self, scene: &Scene, enclosing: &[u32]) {
        let large = SpheresF32::large(scene, enclosing);
        let (count, curved) = large.in_order();
        self.set_words("AT_ENCLOSING_COUNT", &[count as u32]);
        self.set_words("AT_LARGE_COUNT", &[curved.len() as u32]);
        self.add_words("AT_LARGE_NUMBERS", curved.iter().map(|(number, _)| *number));
        let numbers = curved.iter().flat_map(|(_, SphereByCurvature { normal: n, curvature, offset })| {
            [n.x, n.y, n.z, *curvature, *offset].map(f64::from)
        });
        self.add_numbers("AT_LARGE", numbers);
        let spheres = scene.primitives.spheres.len() as u32;
        self.add_words("AT_IS_LARGE", (0..spheres).map(|number| u32::from(large.contains(number))));
        self.add_numbers("AT_SURFACES", surfaces(scene, Precision::F32).flatten());
    }

    fn set_view(&mut self, scene: &Scene, options: &RenderOptions) {
        let view = options.view(scene);
        for (name, v) in [
            ("VIEW_POSITION", view.camera.position),
            ("VIEW_DIRECTION", view.camera.direction),
            ("VIEW_RIGHT", view.right),
            ("VIEW_UP", view.up),
            ("VIEW_LENS_RIGHT", view.right.normalized()),
            ("VIEW_LENS_UP", view.up.normalized()),
        ] {
            self.set_numbers(name, &coordinates(v));
        }
        let (radius, focus) = view.camera.lens.map_or((0.0, 0.0), |lens| (lens.radius, lens.focus));
        for (name, number) in [
            ("VIEW_WIDTH", f64::from(options.width)),
            ("VIEW_HEIGHT", f64::from(options.height)),
            ("VIEW_ADVANCE", view.camera.advance),
            ("VIEW_LENS_RADIUS", radius),
            ("VIEW_LENS_FOCUS", focus),
        ] {
            self.set_numbers(name, &[number]);
        }
        self.set_numbers("VIEW_BACKGROUND", &scene.background.unwrap_or(Rgb::BLACK).channels());
        let filter = match view.filter {
            Filter::Tent => 0,
            Filter::Box => 1,
            Filter::Center => 2,
        };
        self.set_words("AT_FILTER", &[filter]);
        self.set_words("AT_WIDTH", &[options.width]);
    }

    fn set_rules(&mut self, options: &RenderOptions, chosen: &ForDevice) {
        let (by, chance) = match chosen.rules.roulette.by {
            By::Albedo => (0, 0.0),
            By::Throughput => (1, 0.0),
            By::Constant(chance) => (2, chance),
        };
        self.set_words("AT_ROULETTE", &[by, u32::from(chosen.rules.roulette.after())]);
        self.set_numbers("VIEW_ROULETTE", &[chance]);
        self.set_words("AT_MAX_DEPTH", &[u32::from(chosen.rules.max_depth)]);
        self.set_words("AT_CAMERA_RAYS", &[u32::from(chosen.rules.camera_rays)]);
        self.set_numbers("VIEW_CAMERA_SHARE", &[camera_share(chosen.rules.camera_rays)]);
        self.set_words("AT_IS_WEIGHTED", &[u32::from(chosen.rules.nee == Some(LightSampling::Mis))]);
        let seed = mix(options.seed);
        self.set_words("AT_SEED_KEY", &[seed as u32, (seed >> 32) as u32]);
        self.set_words("AT_SAMPLER", &[chosen.sampler]);
        self.set_words("AT_ORDERS", &ORDERS.map(u32::from));
    }
}

fn coordinates(v: Vec3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

/// The numbers and words of a scene that is prepared for the options.
pub(super) fn of(scene: &Scene, options: &RenderOptions, chosen: &ForDevice) -> (Vec<f64>, Vec<u32>) {
    let length = |layout: &[(&str, usize)]| layout.iter().map(|(_, length)| length).sum::<usize>();
    let mut tables =
        Tables { precision: chosen.precision, numbers: vec![0.0; length(NUMBERS)], words: vec![0; length(WORDS)] };
    tables.set_view(scene, options);
    tables.set_rules(options, chosen);
    tables.add_primitives(scene);
    tables.add_objects(&scene.objects);
    tables.add_lights(scene);
    if chosen.precision == Precision::F32 {
        tables.add_singles(scene, &scene.enclosing(&options.view(scene)));
    }
    (tables.numbers, tables.words)
}
