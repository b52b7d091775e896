//! The outline of a ball in a picture: the section of the cone of its tangents with the plane of the picture.

use crate::Trials;
use crate::scene::{AllEffects, Filter};
use crate::stage::{diffuse, object, scene, sphere, view};
use std::f64::consts::FRAC_PI_2;

/// The radius of the ball.
const RADIUS: f64 = 2.5;
/// Pixels on either side.
const SIDE: u32 = 800;
/// The ball's distance from the camera.
const DISTANCE: f64 = 10.0;

/// A ball seen under the half angle a, so far from the axis that the angle is t, is an ellipse whose axes have the ratio cos(a) /
/// sqrt(cos²(a) - sin²(t)): a circle on the axis alone. Each end of an axis is known to half a pixel.
pub(super) fn ellipses(trials: &mut Trials) {
    for degrees in [0.0_f64, 10.0, 20.0, 25.0] {
        let angle = degrees.to_radians();
        let centre = [DISTANCE * libm::sin(angle), 0.0, -DISTANCE * libm::cos(angle)];
        let camera = view([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], FRAC_PI_2.to_degrees());
        let scene = scene(&[camera, object(&sphere(centre, RADIUS), &diffuse(0.5), [0.0; 3])]);
        let view = scene.camera.view(SIDE, SIDE).filtered(Some(Filter::Center));
        let is_on_it = |x: u32, y: u32| {
            let ray = view.ray::<AllEffects>(x, y, 0, [0.5; 2], || [0.5; 2]);
            scene.first_of_any(&ray, None).is_some()
        };
        let places = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))).filter(|(x, y)| is_on_it(*x, *y));
        let places: Vec<(u32, u32)> = places.collect();
        let [width, height] = [|place: &(u32, u32)| place.0, |place: &(u32, u32)| place.1].map(|of| {
            let (least, most) = (places.iter().map(of).min(), places.iter().map(of).max());
            f64::from(most.unwrap_or(0) + 1 - least.unwrap_or(0))
        });
        let half_angle = libm::asin(RADIUS / DISTANCE);
        let (cosine, sine) = (libm::cos(half_angle), libm::sin(angle));
        let exact = cosine / (cosine * cosine - sine * sine).sqrt();
        let tolerance = exact * (1.0 / width + 1.0 / height);
        trials.close(format!("{degrees} degrees off the axis"), exact, width / height, tolerance);
    }
}
