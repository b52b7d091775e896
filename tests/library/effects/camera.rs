//! Rays of pinhole and thin-lens cameras.

use crate::estimate::{diffuse, object, scene, sphere};
use pathmark::math::{Ray, Vec3, dot};
use pathmark::scene::{AllEffects, Lens, Scene};

const POSITION: Vec3 = Vec3::new(1.0, 2.0, 3.0);
const DEGREES: f64 = 40.0;

/// A scene seen from [`POSITION`] towards -z, through a lens if one is given.
fn seen_through(lens: Option<Lens>) -> Scene {
    let (kind, more) = match lens {
        None => ("pinhole", String::new()),
        Some(Lens { radius, focus }) => ("thin-lens", format!("radius = {radius:?}\nfocus = {focus:?}\n")),
    };
    let camera = format!(
        "[camera.{kind}]\nposition = [1.0, 2.0, 3.0]\nlook-at = [1.0, 2.0, -4.0]\nfield-of-view = {DEGREES:?}\n{more}"
    );
    scene(&[camera, object(&sphere([0.0; 3], 1.0), &diffuse(0.5), [0.0; 3])])
}

/// The ray through a position on the film and one on the lens, in an image of 40 x 30 pixels.
fn ray(scene: &Scene, [x, y]: [u32; 2], film: [f64; 2], lens: [f64; 2]) -> Ray {
    scene.camera.view(40, 30).ray::<AllEffects>(x, y, 0, film, || lens)
}

/// Intersection of a ray with the plane at this distance from the camera.
fn at_depth(ray: &Ray, depth: f64) -> Vec3 {
    ray.at((POSITION.z - depth - ray.origin.z) / ray.direction.z)
}

fn apart(a: Vec3, b: Vec3) -> f64 {
    dot(a - b, a - b).sqrt()
}

/// Positions on the lens, on its rim and inside.
fn lens_places() -> impl Iterator<Item = [f64; 2]> {
    (0..=16).flat_map(|u| (0..=16).map(move |v| [f64::from(u) / 16.0, f64::from(v) / 16.0]))
}

const PIXELS: [[u32; 2]; 5] = [[0, 0], [39, 0], [20, 15], [7, 22], [39, 29]];
const LENS: Lens = Lens { radius: 0.25, focus: 5.0 };

/// The top edge of the image lies at half the field of view, its corners follow the aspect ratio, and its middle is
/// straight ahead.
#[test]
fn edges_lie_at_the_field_of_view() {
    let scene = seen_through(None);
    let half = libm::tan(DEGREES.to_radians() / 2.0);
    for (pixel, film, [x, y]) in [
        ([0, 0], [0.0, 1.0], [-half * 4.0 / 3.0, half]),
        ([39, 0], [1.0, 1.0], [half * 4.0 / 3.0, half]),
        ([0, 29], [0.0, 0.0], [-half * 4.0 / 3.0, -half]),
        ([20, 15], [0.0, 1.0], [0.0, 0.0]),
        ([20, 0], [0.0, 1.0], [0.0, half]),
    ] {
        let ray = ray(&scene, pixel, film, [0.5; 2]);
        assert_eq!(ray.origin, POSITION);
        let d = ray.direction;
        assert!((d.x / -d.z - x).abs() < 1e-15 && (d.y / -d.z - y).abs() < 1e-15, "{pixel:?}: {d:?}");
    }
}

#[test]
fn directions_are_unit() {
    for scene in [seen_through(None), seen_through(Some(LENS))] {
        for pixel in PIXELS {
            for lens in lens_places() {
                let d = ray(&scene, pixel, lens, lens).direction;
                assert!((dot(d, d).sqrt() - 1.0).abs() < 4.0 * f64::EPSILON, "{pixel:?} {lens:?}: {d:?}");
            }
        }
    }
}

/// Points in the plane of focus are sharp: all rays of a film position meet that plane where the pinhole's ray does.
#[test]
fn a_point_in_focus_stays_a_point() {
    let (pinhole, lens) = (seen_through(None), seen_through(Some(LENS)));
    for pixel in PIXELS {
        let sharp = at_depth(&ray(&pinhole, pixel, [0.3, 0.6], [0.5; 2]), LENS.focus);
        for place in lens_places() {
            let found = at_depth(&ray(&lens, pixel, [0.3, 0.6], place), LENS.focus);
            assert!(apart(found, sharp) < 1e-14, "{pixel:?} {place:?}: {found:?} instead of {sharp:?}");
        }
    }
}

/// At other depths the rays of a point fill a disk around the pinhole's ray. By similar triangles, its radius at depth
/// z is r |1 - z/f|.
#[test]
fn the_circle_of_confusion() {
    let (pinhole, lens) = (seen_through(None), seen_through(Some(LENS)));
    for depth in [0.0, 1.0, 2.5, 4.0, 6.0, 10.0, 50.0] {
        let radius = LENS.radius * (1.0 - depth / LENS.focus).abs();
        for pixel in PIXELS {
            let sharp = at_depth(&ray(&pinhole, pixel, [0.3, 0.6], [0.5; 2]), depth);
            let (mut largest, mut middle, mut rim) = (0.0f64, Vec3::new(0.0, 0.0, 0.0), 0);
            for place in lens_places() {
                let off = at_depth(&ray(&lens, pixel, [0.3, 0.6], place), depth) - sharp;
                middle = middle + off;
                largest = largest.max(dot(off, off).sqrt());
                // The border of the square maps to the rim of the lens.
                let is_rim = place.iter().any(|u| *u == 0.0 || *u == 1.0);
                rim += u32::from(is_rim);
                assert!(!is_rim || (dot(off, off).sqrt() - radius).abs() < 1e-13, "depth {depth}: {off:?}");
            }
            assert_eq!(rim, 64);
            assert!((largest - radius).abs() < 1e-13, "depth {depth}, {pixel:?}: {largest} instead of {radius}");
            assert!(dot(middle, middle).sqrt() < 1e-10, "depth {depth}, {pixel:?}: lopsided by {middle:?}");
        }
    }
}

/// A small lens deviates from a pinhole in proportion to its radius.
#[test]
fn a_small_lens_is_a_pinhole() {
    let pinhole = seen_through(None);
    for radius in [1e-3, 1e-6, 1e-9, 1e-100] {
        let lens = seen_through(Some(Lens { radius, ..LENS }));
        for pixel in PIXELS {
            let exact = ray(&pinhole, pixel, [0.3, 0.6], [0.5; 2]);
            for place in lens_places() {
                let found = ray(&lens, pixel, [0.3, 0.6], place);
                let off = apart(found.origin, exact.origin).max(apart(found.direction, exact.direction));
                assert!(off <= 1.01 * radius + 1e-15, "radius {radius}: off by {off}");
            }
        }
    }
}
