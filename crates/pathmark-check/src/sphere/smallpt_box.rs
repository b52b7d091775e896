//! The edges between the spheres of smallpt's box, and the starts of its camera rays. Two surfaces cross at 1.7
//! degrees, so an error e in a distance moves the edge between them by 33 e.

use crate::Trials;
use crate::bare_scene::{intersect, searches};
use crate::math::{Frame, Ray, Vec3, dot};
use crate::random::Random;
use crate::scene::{AllEffects, Hit, Scene, SurfaceOrigin, load};
use std::f64::consts::TAU;

/// Distance from the exact circle within which surfaces may be mistaken for each other.
const BAND: f64 = 1e-8;

fn name<'a>(scene: &'a Scene, hit: &Hit) -> &'a str {
    &scene.objects[hit.object as usize].name
}

/// A random distance from an axis: up to twice the circle's radius, or 1e-8 to 1 away from the circle on either side.
fn distance(random: &mut Random, circle: f64) -> f64 {
    match random.below(3) {
        0 => 2.0 * circle * random.unit().sqrt(),
        1 => circle + circle.min(1.0) * random.scale(-8.0, 0.0),
        _ => circle - circle.min(1.0) * random.scale(-8.0, 0.0),
    }
}

pub(super) fn light_cap(trials: &mut Trials) {
    const CIRCLE: f64 = 17.944_246_733_607_267;
    let rays = trials.times(100_000, 1_000_000);
    let cornell = load("cornell").expect("a shipped scene");
    for (accelerator, scene) in searches(&cornell) {
        let mut random = Random::new(60);
        let (mut wrong, mut light) = (0, 0);
        for _ in 0..rays {
            let (rho, turn) = (distance(&mut random, CIRCLE), TAU * random.unit());
            let (x, z) = (50.0 + rho * libm::cos(turn), 81.6 + rho * libm::sin(turn));
            // The true distance of the rounded point from the axis.
            let rho = libm::hypot(x - 50.0, z - 81.6);
            let ray = Ray { origin: Vec3::new(x, 40.0, z), direction: Vec3::new(0.0, 1.0, 0.0) };
            let expected = if rho < CIRCLE { "light" } else { "ceiling" };
            let is_right = intersect(&scene, &ray, None).is_some_and(|hit| name(&scene, &hit) == expected);
            wrong += u64::from(!is_right && (rho - CIRCLE).abs() > BAND);
            light += u64::from(expected == "light");
        }
        trials.never(format!("accelerator {accelerator}"), "wrong outside of 1e-8 of the circle", wrong, rays);
        let told = format_args!("{light} of {rays} inside");
        trials.holds("the rays", "a third at least on either side", told, (rays / 3..=2 * rays / 3).contains(&light));
    }
    // The height of the light's lowest point, seen in the middle.
    let up = Ray { origin: Vec3::new(50.0, 40.0, 81.6), direction: Vec3::new(0.0, 1.0, 0.0) };
    let height = intersect(&cornell, &up, None).map_or(f64::NAN, |hit| hit.point.y);
    trials.close("the light's lowest point", 81.33, height, 1e-11);
}

/// A ball, the radius of the circle in which it cuts the floor, and its depth below the floor.
const BALLS: [(&str, [f64; 3], f64, f64); 2] = [
    ("mirror ball", [27.0, 16.5, 47.0], 0.533_700_148_21, 0.008_632_223_944_37),
    ("glass ball", [73.0, 16.5, 78.0], 0.299_074_517_033, 0.002_710_247_154_05),
];

pub(super) fn sunken_balls(trials: &mut Trials) {
    let rays = trials.times(10_000, 1_000_000);
    let cornell = load("cornell").expect("a shipped scene");
    let floor = Vec3::new(50.0, 1e5, 81.6);
    for (accelerator, scene) in searches(&cornell) {
        for (ball, center, circle, depth) in BALLS {
            let center = Vec3::from(center);
            let down = (center - floor).normalized();
            let frame = Frame::around(down);
            let straight = intersect(&scene, &Ray { origin: center, direction: down }, None);
            let met = straight.filter(|hit| name(&scene, hit) == "floor").map_or(f64::NAN, |hit| hit.t);
            trials.close(format!("{ball}, straight down, accelerator {accelerator}"), 16.5 - depth, met, 1e-10);
            let mut random = Random::new(61);
            let (mut wrong, mut outside_in) = (0, 0);
            for _ in 0..rays {
                let (rho, turn) = (distance(&mut random, circle), TAU * random.unit());
                let offset = frame.to_world(Vec3::new(rho * libm::cos(turn), rho * libm::sin(turn), 0.0));
                let expected = if rho < circle { "floor" } else { ball };
                let hit = intersect(&scene, &Ray { origin: center + offset, direction: down }, None);
                let is_right = hit.is_some_and(|hit| name(&scene, &hit) == expected);
                wrong += u64::from(!is_right && (rho - circle).abs() > BAND);
                // A ray up from the floor inside the ball must hit the ball from within.
                let Some(hit) = hit.filter(|hit| name(&scene, hit) == "floor" && rho < circle - BAND) else { continue };
                let from = Some(SurfaceOrigin { primitive: hit.primitive, inside: true });
                let up = intersect(&scene, &Ray { origin: hit.point, direction: -down }, from);
                outside_in += u64::from(!up.is_some_and(|up| name(&scene, &up) == ball && up.inside));
            }
            let variant = format!("{ball}, accelerator {accelerator}");
            trials.never(&variant, "wrong outside of 1e-8 of the circle", wrong, rays);
            trials.never(&variant, "ways up from the floor that are not inside the ball", outside_in, rays);
        }
    }
}

pub(super) fn camera_rays(trials: &mut Trials) {
    let cornell = load("cornell").expect("a shipped scene");
    let almost_one = 1.0 - f64::EPSILON / 2.0;
    let corners = [[0.0, 0.0], [almost_one, 0.0], [0.0, almost_one], [almost_one, almost_one], [0.5, 0.5]];
    // Origins reach farthest at the image's border.
    let step = trials.times(8, 1) as u32;
    for (width, height) in [(1024, 768), (1, 1), (7, 300)] {
        let view = cornell.camera.view(width, height);
        let (mut outside, mut long, mut nearest, mut tried) = (0, 0, 0.0_f64, 0);
        let is_tried = |at: u32, count: u32| at.is_multiple_of(step) || at + 1 == count;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let is_border = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
            if !(is_border || is_tried(x, width) && is_tried(y, height)) {
                continue;
            }
            for (sample, numbers) in (0..4).flat_map(|sample| corners.map(|numbers| (sample, numbers))) {
                let Ray { origin, direction } = view.ray::<AllEffects>(x, y, sample, numbers, || [0.0; 2]);
                long += u64::from((dot(direction, direction).sqrt() - 1.0).abs() > 4.0 * f64::EPSILON);
                let inside = (1.0..99.0).contains(&origin.x) && (0.0..81.6).contains(&origin.y) && origin.z < 169.0;
                // In images that are much wider or higher than smallpt's, rays also start outside the walls, even
                // behind the front one.
                outside += u64::from(!inside && width > height);
                nearest = nearest.max(origin.z);
                tried += 1;
            }
        }
        let size = format!("{width}x{height}");
        trials.never(&size, "directions whose length is not 1", long, tried);
        if width > height {
            trials.never(format!("{size}, largest z {nearest:.3}"), "origins outside of the box", outside, tried);
        }
    }
}
