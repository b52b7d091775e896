//! Scenes in a few words, and what estimators make of them, with error bars.
//!
//! Scenes are texts, read by the program's own reader. Cameras look at a spot that is so small that it is a point.

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::estimator::ESTIMATORS;
use pathmark::kernel::Spec;
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::scene::{Scene, load};
use std::io::Write;
use std::sync::Arc;

/// The chance of a false alarm in each test, over all its comparisons, two-sided.
const LEVEL: f64 = 1e-3;
/// A test whose interval is wider than this share of the exact value sees nothing.
const WIDEST: f64 = 3e-3;
/// The spot is 2e-8 wide at distance 1, and a value is the sum of many.
const ROUNDING: f64 = 1e-7;
/// Pixels in a row and in a column; all see the same.
const SIDE: u32 = 32;

/// A camera that looks at a point.
pub(crate) fn camera(position: [f64; 3], look_at: [f64; 3]) -> String {
    view(position, look_at, [0.36, 0.48, 0.8], 1e-6)
}

/// A camera with a field of view in degrees.
pub(crate) fn view(position: [f64; 3], look_at: [f64; 3], up: [f64; 3], degrees: f64) -> String {
    format!(
        "[camera.pinhole]\nposition = {position:?}\nlook-at = {look_at:?}\nup = {up:?}\nfield-of-view = {degrees:?}\n"
    )
}

/// An object; shape and material are what stands behind `=` in a scene file.
pub(crate) fn object(shape: &str, material: &str, emission: [f64; 3]) -> String {
    format!(
        "[[objects]]\nname = '{shape} {material}'\nshape = {shape}\nmaterial = {material}\nemission = {emission:?}\n"
    )
}

/// A sphere.
pub(crate) fn sphere(center: [f64; 3], radius: f64) -> String {
    format!("{{ sphere = {{ center = {center:?}, radius = {radius:?} }} }}")
}

/// A plane without an end.
pub(crate) fn plane(point: [f64; 3], normal: [f64; 3]) -> String {
    format!("{{ plane = {{ point = {point:?}, normal = {normal:?} }} }}")
}

/// A matte material, the same in all channels.
pub(crate) fn diffuse(albedo: f64) -> String {
    format!("{{ diffuse = {{ albedo = {:?} }} }}", [albedo; 3])
}

/// A point light, the same in all channels.
pub(crate) fn point_light(position: [f64; 3], intensity: f64) -> String {
    format!("[[point-lights]]\nposition = {position:?}\nintensity = {:?}\n", [intensity; 3])
}

/// Reads a scene from its parts; what stands before the first table comes first.
pub(crate) fn scene(parts: &[String]) -> Scene {
    let mut file = tempfile::Builder::new().suffix(".toml").tempfile().expect("a temporary file");
    let text = format!("about = 'a test'\n{}", parts.concat());
    file.write_all(text.as_bytes()).expect("a written file");
    load(file.path().to_str().expect("a path in UTF-8")).unwrap_or_else(|error| panic!("{error} in\n{text}"))
}

/// The estimators that follow all light, not Whitted's part of it.
pub(crate) fn full_estimators() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().map(|entry| entry.name).filter(|name| *name != "whitted")
}

/// Those that find light by arriving at it: in an enclosure that glows all over, what aims at a point of it is far noisier than what goes
/// wherever the surface sends it. There the estimators are compared with each other (`tests/estimators`).
pub(crate) fn arriving_estimators() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().filter(|entry| !entry.aims).map(|entry| entry.name).filter(|name| *name != "whitted")
}

/// Renders about so many samples of the scene's spot in all.
pub(crate) fn render(scene: &Scene, estimator: &str, samples: u32, max_depth: Option<u16>) -> Outcome {
    let spec = Spec { width: SIDE, height: SIDE, seed: 31, estimator: estimator.into(), max_depth, ..Spec::default() };
    let spp = samples.div_ceil(SIDE * SIDE).next_multiple_of(4);
    let (decomposition, strategy) = ("rows".into(), "shared-counter".into());
    let settings = Settings { spp, spec, decomposition, strategy, threads: 2, ..Settings::default() };
    let outcome = Setup::for_scene(Arc::new(scene.clone()), settings).unwrap().run(None).unwrap();
    assert_eq!(outcome.counts.invalid, 0, "invalid samples");
    outcome
}

/// The mean of a channel over all samples, and its standard error.
pub(crate) fn mean(outcome: &Outcome, channel: usize) -> (f64, f64) {
    let (mut n, mut sum, mut square) = (0.0, 0.0, 0.0);
    for pixel in outcome.film.pixels() {
        n += f64::from(pixel.count);
        sum += pixel.sum[channel];
        square += pixel.square[channel];
    }
    let mean = sum / n;
    (mean, ((square / n - mean * mean).max(0.0) / (n - 1.0)).sqrt())
}

/// Insists that a channel has the exact value: within its error bar, which must be narrow. `tests` are all comparisons of the test.
pub(crate) fn assert_exact(what: &str, outcome: &Outcome, channel: usize, exact: f64, tests: usize) {
    let most = critical_value(sidak(LEVEL, tests).unwrap()).unwrap();
    let (found, error) = mean(outcome, channel);
    assert!(most * error <= WIDEST * exact, "{what}: no power, one standard error is {error} of {exact}");
    let allowed = most * error + ROUNDING * exact;
    assert!((found - exact).abs() <= allowed, "{what}: {found} instead of {exact}, error {error}");
}
