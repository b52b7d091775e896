//! Single precision in scenes of any size: the expectation of double precision, or an error that tells the range.

use pathmark_lanes::kernel::{Spec, build, choose};
use pathmark_tracer::film::{Bounds, Piece, TileBuffer};
use pathmark_tracer::scene::{Scene, load};
use std::sync::Arc;

const SIZE: u32 = 16;

fn spec(precision: &str, estimator: &str) -> Spec {
    Spec { width: SIZE, height: SIZE, estimator: estimator.into(), precision: precision.into(), ..Spec::default() }
}

fn image(scene: &Arc<Scene>, spec: &Spec, spp: u32) -> TileBuffer {
    assert_eq!(choose(scene, spec).unwrap().plan.name(), "lanes");
    let bounds = Bounds { x0: 0, y0: 0, x1: SIZE, y1: SIZE };
    let mut buffer = TileBuffer::new(bounds);
    let counts = build(scene, spec).unwrap().render(&Piece { bounds, samples: 0..spp }, &mut buffer);
    assert_eq!(counts.invalid, 0);
    buffer
}

fn mean(buffer: &TileBuffer) -> f64 {
    buffer.rows().flatten().map(|pixel| pixel.mean().iter().sum::<f64>() / 3.0).sum::<f64>() / f64::from(SIZE * SIZE)
}

/// A shape at a height, as text of a scene.
type Shape<'a> = &'a dyn Fn(f64) -> String;

/// The mean in single precision over the mean in double precision, from the same random numbers, less 1.
fn change(text: &str, estimator: &str) -> f64 {
    let scene = Arc::new(Scene::from_toml(text).unwrap());
    let [single, double] = ["f32", "f64"].map(|precision| mean(&image(&scene, &spec(precision, estimator), 64)));
    assert!(double > 1e-3, "{double}");
    single / double - 1.0
}

/// A power of two changes no bit. Without a scale of its own, single precision has no numbers for the lengths and
/// squares of most of these scenes.
#[test]
fn scenes_of_any_size_have_the_same_bits_in_single_precision() {
    for name in ["cornell", "cornell-mesh", "spheres:20"] {
        let scene = load(name).unwrap();
        for accelerator in ["none", "sah"] {
            let spec = Spec { accelerator: Some(accelerator.into()), ..spec("f32", "mis") };
            let expected = image(&Arc::new(scene.clone()), &spec, 4);
            for exponent in [-300, -100, -60, -30, -19, 19, 30, 60, 100, 300] {
                let scaled = Arc::new(scene.scaled(libm::exp2(f64::from(exponent))));
                assert!(image(&scaled, &spec, 4) == expected, "{name}, {accelerator}, 2^{exponent}");
            }
        }
    }
}

/// A square light and a light ball of any size, seen from ten sizes away: pixels are all light or none, except at
/// edges.
#[test]
fn scenes_of_any_size_have_the_same_mean_in_single_precision() {
    for exponent in -30..=30 {
        let shapes = [
            format!("sphere = {{ center = [0.0, 0.0, 0.0], radius = 1e{exponent} }}"),
            format!(
                "quad = {{ corners = [[-1e{exponent}, -1e{exponent}, 0.0], [1e{exponent}, -1e{exponent}, 0.0], \
                 [1e{exponent}, 1e{exponent}, 0.0], [-1e{exponent}, 1e{exponent}, 0.0]] }}"
            ),
        ];
        for shape in shapes {
            let text = format!(
                "about = 'a light'\nbackground = [0.0, 0.0, 0.0]\n[camera.pinhole]\nposition = [0.0, 0.0, 1e{}]\n\
                 look-at = [0.0, 0.0, 0.0]\nfield-of-view = 40.0\n[[objects]]\nname = 'light'\nshape = {{ {shape} }}\n\
                 material = {{ diffuse = {{ albedo = [0.0, 0.0, 0.0] }} }}\nemission = [1.0, 1.0, 1.0]\n",
                exponent + 1
            );
            let change = change(&text, "bsdf");
            assert!(change.abs() < 1e-4, "1e{exponent}: {change}, {shape}");
        }
    }
}

/// An object of a scene.
fn object(name: &str, shape: &str, albedo: f64, emission: f64) -> String {
    format!(
        "[[objects]]\nname = '{name}'\nshape = {{ {shape} }}\nmaterial = {{ diffuse = {{ albedo = [{albedo:?}, {albedo:?}, \
         {albedo:?}] }} }}\nemission = [{emission:?}, {emission:?}, {emission:?}]\n"
    )
}

/// A sphere is large next to everything near the origin, of whatever kind it is: spheres, triangles, planes, or the
/// camera alone. Paths would meet the ground where they start on it if it were stored as a small one.
#[test]
fn large_spheres_lose_no_light_in_single_precision() {
    let camera = "about = 'a ground'\nbackground = [1.0, 1.0, 1.0]\n[camera.pinhole]\nposition = [0.3123, 2.99713, 0.2123]\n\
                  look-at = [0.0, 0.0, 0.0]\nup = [1.0, 0.0, 0.0]\nfield-of-view = 10.0\n";
    let carpet = "triangle = { corners = [[-9.0, 0.005, -9.0], [9.0, 0.005, 9.0], [9.0, 0.005, -9.0]] }";
    let wall = "plane = { point = [0.0, 0.0, 4.0], normal = [0.0, 0.0, -1.0] }";
    let ball = "sphere = { center = [0.0, 0.5, 0.0], radius = 0.5 }";
    for radius in [1e4, 1e5, 1e6, 1e7] {
        let ground = format!("sphere = {{ center = [0.0123, {:?}, 0.0], radius = {radius:?} }}", -radius);
        let ground = object("ground", &ground, 0.8, 0.0);
        for (name, others) in [
            ("nothing", Vec::new()),
            ("a carpet", vec![carpet]),
            ("a wall", vec![wall]),
            ("a ball", vec![ball]),
            ("all", vec![carpet, wall, ball]),
        ] {
            let others = (0..).zip(others).map(|(k, shape): (u32, _)| object(&k.to_string(), shape, 0.2, 0.0));
            let text = format!("{camera}{ground}{}", others.collect::<String>());
            let change = change(&text, "bsdf");
            assert!(change.abs() < 1e-4, "{name} on a ground of {radius:e}: {change}");
        }
    }
}

/// The cap of a large light in a ceiling, between two planes and without any small sphere.
#[test]
fn the_cap_of_a_large_light_keeps_its_light_in_single_precision() {
    let text = [
        "about = 'a cap'\n[camera.pinhole]\nposition = [0.001, 0.005, 0.0005]\nlook-at = [0.0, 0.0, 0.0]\n\
         field-of-view = 20.0\n",
        &object("floor", "plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }", 0.5, 0.0),
        &object("ceiling", "plane = { point = [0.0, 0.0489417, 0.0], normal = [0.0, -1.0, 0.0] }", 0.0, 0.0),
        &object("lamp", "sphere = { center = [0.0, 12.4672, 0.0], radius = 12.41863 }", 0.0, 10.0),
    ];
    let change = change(&text.concat(), "nee");
    assert!(change.abs() < 1e-3, "{change}");
}

/// A small and distant ball is no large sphere, even if the camera is nearer to the origin than its radius.
#[test]
fn distant_balls_keep_their_size_in_single_precision() {
    for distance in [1e2, 1e4, 1e5] {
        let text = format!(
            "about = 'a moon'\nbackground = [0.0, 0.0, 0.0]\n[camera.pinhole]\nposition = [0.1, 0.0, 0.0]\nlook-at = [0.0, 0.0, \
             {distance:?}]\nfield-of-view = {:?}\n{}{}",
            200.0 / distance,
            object("moon", &format!("sphere = {{ center = [0.0, 0.0, {distance:?}], radius = 1.0 }}"), 0.0, 1.0),
            object("pebble", "sphere = { center = [0.0, 0.3, 0.0], radius = 0.1 }", 0.0, 0.0),
        );
        let change = change(&text, "bsdf");
        assert!(change.abs() < 1e-3, "{distance:e}: {change}");
    }
}

/// Lengths that single precision cannot hold side by side are an error that tells the range; double precision renders
/// them.
#[test]
fn lengths_out_of_the_range_of_single_precision_are_refused() {
    let ball = object("ball", "sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 }", 0.5, 0.0);
    for (shape, length) in [
        ("plane = { point = [1e60, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }", "1e60"),
        ("plane = { point = [1e9, 0.0, -5.0], normal = [0.0, 0.0, 1.0] }", "1e9"),
        ("sphere = { center = [0.0, 0.0, 1e20], radius = 1e19 }", "1.1e20"),
        ("sphere = { center = [1.0, 1.0, 1.0], radius = 1e-7 }", "1e-7"),
        (
            "quad = { corners = [[9.0, 9.0, 9.0], [9.00001, 9.0, 9.0], [9.00001, 9.00001, 9.0], [9.0, 9.00001, 9.0]] }",
            "e-5",
        ),
        ("triangle = { corners = [[3e8, -1.0, 4e8], [0.0, -1.0, -1e2], [-1e2, -1.0, 0.0]] }", "5e8"),
    ] {
        let text = format!(
            "about = 'out of range'\n[camera.pinhole]\nposition = [0.0, 0.0, 4.0]\nlook-at = [0.0, 0.0, 0.0]\n\
             field-of-view = 40.0\n{ball}{}",
            object("far", shape, 0.5, 0.0)
        );
        let scene = Scene::from_toml(&text).unwrap();
        let Err(error) = choose(&scene, &spec("f32", "bsdf")) else { panic!("{shape} is taken") };
        let told = error.to_string();
        assert!(error.exit_code() == 2 && told.starts_with("precision = f32"), "{told}");
        assert!(told.contains(length) && told.contains("allowed: f64, or"), "{shape}: {told}");
        assert!(choose(&scene, &spec("f64", "bsdf")).is_ok());
    }
}

/// The back surface reflects half of a white sky and the front one four fifths. The front is seen, unless the two are
/// removed to one place when the scene is read, or refused because single precision cannot tell them apart.
#[test]
fn surfaces_a_hair_apart_are_told_apart_or_refused() {
    let mut refused = 0;
    for away in [[0.0, 0.0, 0.0], [3.0, -7.0, 11.0], [-200.0, 90.0, 40.0]] {
        let at = |[x, y, z]: [f64; 3]| [x + away[0], y + away[1], z + away[2]];
        let lengths = away.iter().fold(8.0, |sum, part| sum + part.abs());
        let camera = format!(
            "about = 'near'\nbackground = [1.0, 1.0, 1.0]\n[camera.pinhole]\nposition = {:?}\nlook-at = {:?}\nfield-of-view = 10.0\n",
            at([0.3, -5.0, 0.2]),
            at([0.0, 1.0, 0.0])
        );
        // Surfaces at the height `up` towards the camera.
        let ball = |up: f64| format!("sphere = {{ center = {:?}, radius = {:?} }}", at([0.0, 4.0, 0.0]), 3.0 + up);
        let ground = |up: f64| format!("sphere = {{ center = {:?}, radius = 1e6 }}", at([0.0, 1.000_001e6 - up, 0.0]));
        let plane =
            |up: f64| format!("plane = {{ point = {:?}, normal = [0.3, -1.0, 0.2] }}", at([0.0, 1.0 - up, 0.0]));
        let tilted = |up: f64| {
            let corner = |x: f64, z: f64| at([x, 1.0 - up + 0.3 * x + 0.2 * z, z]);
            let corners = [corner(-9.0, -9.0), corner(-9.0, 9.0), corner(9.0, 9.0), corner(9.0, -9.0)];
            format!("quad = {{ corners = {corners:?} }}")
        };
        let kinds: [(&str, [Shape<'_>; 2]); 5] = [
            ("balls", [&ball, &ball]),
            ("large spheres", [&ground, &ground]),
            ("planes", [&plane, &plane]),
            ("quads", [&tilted, &tilted]),
            ("a plane and a quad", [&plane, &tilted]),
        ];
        for (kind, [back, front]) in kinds {
            let mut pebble = String::new();
            if kind == "large spheres" {
                // They are large next to something near the origin; this here cannot be told from the sky.
                if away != [0.0; 3] {
                    continue;
                }
                pebble = object("pebble", "sphere = { center = [0.0, -6.0, 0.0], radius = 0.1 }", 0.0, 1.0);
            }
            for exponent in -60..=-14 {
                let up = lengths * libm::exp2(f64::from(exponent));
                let objects = object("back", &back(0.0), 0.5, 0.0) + &object("front", &front(up), 0.8, 0.0) + &pebble;
                let scene = Arc::new(Scene::from_toml(&(camera.clone() + &objects)).unwrap());
                let value = if scene.remarks.iter().any(|remark| remark.contains("coincide")) { 0.5 } else { 0.8 };
                let mean = |precision: &str| mean(&image(&scene, &spec(precision, "bsdf"), 16));
                let double = mean("f64");
                assert!((double - value).abs() < 1e-9, "{kind} at {away:?}, 2^{exponent}: {double}");
                match choose(&scene, &spec("f32", "bsdf")) {
                    Ok(_) => {
                        let single = mean("f32");
                        assert!((single - value).abs() < 1e-4, "{kind} at {away:?}, 2^{exponent}: {single}");
                    }
                    Err(error) => {
                        let told = error.to_string();
                        assert!(
                            error.exit_code() == 2 && told.contains("which of back and front is in front"),
                            "{told}"
                        );
                        assert!(exponent < -16, "{kind} at {away:?}, 2^{exponent}: {told}");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(refused > 200, "{refused}");
}

/// Scenes that belong to the program have no such surfaces.
#[test]
fn no_shipped_scene_is_refused_in_single_precision() {
    for (name, _) in pathmark_tracer::scene::SCENES {
        let scene = load(name).unwrap();
        let found = choose(&scene, &Spec { estimator: scene.estimator().into(), ..spec("f32", "mis") });
        assert!(found.is_ok(), "{name}: {}", found.err().unwrap());
    }
}
