//! Coincident surfaces: rays meet the primitive with the lowest number, and never the hidden one.

use pathmark_lanes::kernel::{Spec, build};
use pathmark_tracer::film::{Bounds, Piece, TileBuffer};
use pathmark_tracer::math::{Frame, Vec3};
use pathmark_tracer::scene::{Primitives, Scene, load};
use std::sync::Arc;

const SIZE: u32 = 12;

const CAMERA: &str = "about = 'coincident'\n[camera.pinhole]\nposition = [0.3, -5.0, 0.2]\nlook-at = [0.0, 1.0, 0.0]\n\
                      field-of-view = 20.0\n";

fn object(name: &str, shape: &str, albedo: f64, emission: f64) -> String {
    format!(
        "[[objects]]\nname = '{name}'\nshape = {{ {shape} }}\nmaterial = {{ diffuse = {{ albedo = [{albedo:?}, {albedo:?}, \
         {albedo:?}] }} }}\nemission = [{emission:?}, {emission:?}, {emission:?}]\n"
    )
}

/// A square of that half width in the plane y = 1, moved along x.
fn square(half: f64, x: f64) -> String {
    let corners = [[-half, -half], [-half, half], [half, half], [half, -half]].map(|[u, v]| [u + x, 1.0, v]);
    format!("quad = {{ corners = {corners:?} }}")
}

fn scene(parts: &[&str]) -> Scene {
    Scene::from_toml(&parts.concat()).unwrap()
}

/// The remarks on coincident objects; scenes without light have another one.
fn coincidences(scene: &Scene) -> Vec<&str> {
    scene.remarks.iter().map(String::as_str).filter(|remark| remark.contains("coincide")).collect()
}

/// Every pixel of the image by each kernel, precision, accelerator and estimator.
fn pixels(scene: &Scene) -> Vec<f64> {
    let scene = Arc::new(scene.clone());
    let mut pixels = Vec::new();
    for (kernel, precision) in [("scalar", "f64"), ("lanes", "f64"), ("lanes", "f32")] {
        for (accelerator, estimator) in [("none", "bsdf"), ("sah", "bsdf"), ("median", "nee"), ("none", "mis")] {
            let spec = Spec {
                width: SIZE,
                height: SIZE,
                kernel: kernel.into(),
                precision: precision.into(),
                accelerator: Some(accelerator.into()),
                estimator: estimator.into(),
                ..Spec::default()
            };
            let bounds = Bounds { x0: 0, y0: 0, x1: SIZE, y1: SIZE };
            let mut buffer = TileBuffer::new(bounds);
            build(&scene, &spec).unwrap().render(&Piece { bounds, samples: 0..16 }, &mut buffer);
            pixels.extend(buffer.rows().flatten().map(|pixel| pixel.mean()[0]));
        }
    }
    pixels
}

/// Convex and isolated surfaces under a white sky reflect their albedo, lamps show their radiance: exact values in
/// every pixel.
#[test]
fn the_first_of_coincident_surfaces_is_seen_alone() {
    let white = "background = [1.0, 1.0, 1.0]\n";
    let (white_first, in_front) =
        (CAMERA.replacen("[camera", &format!("{white}[camera"), 1), "center = [0.0, 3.0, 0.0]");
    let ball = |radius: &str| format!("sphere = {{ {in_front}, radius = {radius} }}");
    let plane = "plane = { point = [7.0, 1.0, 3.0], normal = [0.0, -1.0, 0.0] }";
    let black = object("black", &square(9.0, 0.0), 0.0, 0.0);
    for (what, scene, value) in [
        (
            "two balls",
            scene(&[&white_first, &object("a", &ball("4.0"), 0.5, 0.0), &object("b", &ball("4.0"), 0.9, 0.0)]),
            0.5,
        ),
        (
            "two balls but for rounding",
            scene(&[
                &white_first,
                &object("a", &ball("4.0"), 0.5, 0.0),
                &object("b", &ball("4.000000000000001"), 0.9, 0.0),
            ]),
            0.5,
        ),
        (
            "two planes",
            scene(&[
                &white_first,
                &object("a", plane, 0.5, 0.0),
                &object("b", "plane = { point = [0.0, 1.0, 0.0], normal = [0.0, 1.0, 0.0] }", 0.9, 0.0),
            ]),
            0.5,
        ),
        (
            "a plane and a square",
            scene(&[&white_first, &object("b", &square(9.0, 0.0), 0.9, 0.0), &object("a", plane, 0.5, 0.0)]),
            0.5,
        ),
        ("a lamp in a ceiling", scene(&[CAMERA, &object("lamp", &square(3.0, 0.0), 0.0, 1.0), &black]), 1.0),
        ("a ceiling with a lamp", scene(&[CAMERA, &black, &object("lamp", &square(3.0, 0.0), 0.0, 1.0)]), 0.0),
    ] {
        assert!(!coincidences(&scene).is_empty(), "{what}");
        for pixel in pixels(&scene) {
            assert!((pixel - value).abs() < 1e-6, "{what}: {pixel} instead of {value}");
        }
    }
}

/// The surface areas of an object's triangles.
fn area(scene: &Scene, name: &str) -> f64 {
    let Primitives { spheres, planes, triangles, .. } = &scene.primitives;
    let owners = &scene.owners[spheres.len() + planes.len()..];
    assert_eq!(owners.len(), triangles.len());
    let of_object = triangles.iter().zip(owners).filter(|(_, owner)| scene.objects[**owner as usize].name == name);
    let area = |[a, b, c]: [Vec3; 3]| {
        let cross = (b - a).cross(c - a);
        0.5 * (cross.x * cross.x + cross.y * cross.y + cross.z * cross.z).sqrt()
    };
    of_object.map(|(triangle, _)| area(triangle.corners)).sum()
}

/// A square keeps the area outside those before it in its plane, also where they only overlap in part, are turned, and
/// lie obliquely in space. The remark names both.
#[test]
fn squares_keep_the_area_that_no_other_covers() {
    for turn in [[0.0, 0.0, 1.0], [0.3, -0.8, 0.5], [0.577, 0.577, 0.577], [-0.9, 0.1, 0.02]] {
        let frame = Frame::around(Vec3::from(turn).normalized());
        let quad = |[x, y]: [f64; 2], [u, v]: [f64; 2]| {
            let corner = |a: f64, b: f64| {
                let Vec3 { x, y, z } = frame.to_world(Vec3::new(x + a * u - b * v, y + a * v + b * u, 0.7));
                [x, y, z]
            };
            format!(
                "quad = {{ corners = {:?} }}",
                [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
            )
        };
        let (wide, half) = (quad([0.0, 0.0], [2.0, 0.0]), quad([2.0, 0.0], [1.0, 0.0]));
        let (turned, beside) = (quad([-0.1, 0.2], [0.5, 0.5]), quad([0.0, 4.0], [2.0, 0.0]));
        let all =
            [object("half", &half, 0.5, 0.0), object("turned", &turned, 0.5, 0.0), object("wide", &wide, 0.5, 0.0)];
        let scene = scene(&[CAMERA, &all.concat(), &object("beside", &beside, 0.5, 0.0)]);
        // The first two share no area; each covers 2 of the 16 units of the third. The last one only touches it.
        for (name, expected) in [("half", 4.0), ("turned", 2.0), ("wide", 16.0 - 2.0 - 2.0), ("beside", 16.0)] {
            let found = area(&scene, name);
            assert!((found - expected).abs() < 1e-12, "{name}: {found} instead of {expected}, {turn:?}");
        }
        let pairs = [["half", "wide"], ["turned", "wide"]];
        let told = pairs.map(|[a, b]| format!("where {a} and {b} coincide, rays meet {a}, which comes first"));
        assert_eq!(coincidences(&scene), told);
    }
}

/// A square under very many others stays whole, and a remark tells that rounding decides.
#[test]
fn rounding_decides_below_very_many_squares() {
    let small: Vec<String> =
        (0..33).map(|k| object(&format!("{k}"), &square(0.01, 0.5 + 0.05 * f64::from(k)), 0.5, 0.0)).collect();
    let under = object("under", &square(5.0, 0.0), 0.5, 0.0);
    let scene = scene(&[CAMERA, &small.concat(), &under]);
    assert_eq!(scene.owners.len(), 2 * 34);
    let told = coincidences(&scene);
    assert_eq!(told[0], "where 0 and under coincide, rounding decides which of them rays meet");
    assert!(told.last().unwrap().ends_with("more pairs of objects coincide"), "{told:?}");
}

/// Two lamps in one place are one lamp to next-event estimation, too.
#[test]
fn a_lamp_that_another_hides_sends_no_light() {
    let floor = object("floor", "plane = { point = [0.0, -6.0, 0.0], normal = [0.0, 1.0, 0.0] }", 0.5, 0.0);
    let lamps = ["one", "two"].map(|name| object(name, &square(1.0, 0.0), 0.0, 1.0));
    let (one, both) = (scene(&[CAMERA, &floor, &lamps[0]]), scene(&[CAMERA, &floor, &lamps[0], &lamps[1]]));
    assert_eq!((&one.primitives, &one.owners), (&both.primitives, &both.owners));
    assert_eq!(pixels(&one), pixels(&both));
}

/// A surface that light passes hides nothing, whether it comes first or last: behind it the other one must stay.
#[test]
fn glass_hides_no_wall() {
    let pane = format!(
        "[[objects]]\nname = 'pane'\nshape = {{ {} }}\nmaterial = {{ dielectric = {{ eta = 1.5, tint = [1.0, 1.0, 1.0] }} }}\n",
        square(1.0, 0.0)
    );
    let wall = object("wall", &square(2.0, 0.0), 0.5, 0.0);
    let plane = object("plane", "plane = { point = [0.0, 1.0, 0.0], normal = [0.0, 1.0, 0.0] }", 0.5, 0.0);
    for (parts, [first, second], primitives) in [
        ([&pane, &wall], ["pane", "wall"], 4),
        ([&wall, &pane], ["wall", "pane"], 4),
        ([&pane, &plane], ["plane", "pane"], 3),
    ] {
        let scene = scene(&[CAMERA, parts[0], parts[1]]);
        let told = format!("where {first} and {second} coincide, rounding decides which of them rays meet");
        assert_eq!((coincidences(&scene), scene.owners.len()), (vec![told.as_str()], primitives));
    }
}

/// Coordinates along a plane do not blur its height.
#[test]
fn surfaces_above_a_wide_plane_are_kept() {
    let lamp = object("lamp", &square(1.0, 0.0), 0.0, 1.0);
    let wide = "triangle = { corners = [[-1e17, 2.0, -1e17], [1e17, 2.0, -1e17], [0.0, 2.0, 1e17]] }";
    for floor in ["plane = { point = [1e16, 2.0, 0.0], normal = [0.0, 1.0, 0.0] }", wide] {
        let scene = scene(&[CAMERA, &lamp, &object("floor", floor, 0.5, 0.0)]);
        assert_eq!((coincidences(&scene), scene.owners.len()), (vec![], 3), "{floor}");
    }
}

/// A plane precedes all triangles, and the remark says so.
#[test]
fn a_plane_precedes_a_triangle() {
    let plane = object("wall", "plane = { point = [0.0, 1.0, 0.0], normal = [0.0, 1.0, 0.0] }", 0.5, 0.0);
    let scene = scene(&[CAMERA, &object("lamp", &square(1.0, 0.0), 0.0, 1.0), &plane]);
    let told = "where wall and lamp coincide, rays meet wall, because planes precede triangles";
    assert_eq!((coincidences(&scene), scene.owners.len()), (vec![told], 1));
}

/// Neighbours in a plane, surfaces that cross, and shells a little apart are left as they are.
#[test]
fn surfaces_that_only_touch_are_kept() {
    let apart = scene(&[
        CAMERA,
        &object("one", &square(1.0, 0.0), 0.5, 0.0),
        &object("neighbour", &square(1.0, 2.0), 0.5, 0.0),
        &object("shell", "sphere = { center = [0.0, 3.0, 0.0], radius = 1.0 }", 0.5, 0.0),
        &object("inner shell", "sphere = { center = [0.0, 3.0, 0.0], radius = 0.9999999999 }", 0.5, 0.0),
        &object("floor", "plane = { point = [0.0, 1.000000000001, 0.0], normal = [0.0, 1.0, 0.0] }", 0.5, 0.0),
        &object("slope", "plane = { point = [0.0, 1.0, 0.0], normal = [1e-9, 1.0, 0.0] }", 0.5, 0.0),
    ]);
    assert_eq!((coincidences(&apart).as_slice(), apart.owners.len()), ([].as_slice(), 8));
    for name in ["cornell-mesh", "bumpy-ball", "spheres:3000", "furnace", "imbalance:40"] {
        let scene = load(name).unwrap();
        assert!(coincidences(&scene).is_empty(), "{name}");
    }
}
