//! Optional approximations of a render: an epsilon, another pixel filter, a light with a limited reach. Expected
//! values are closed forms.

use pathmark::film::Film;
use pathmark::kernel::Spec;
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::scene::Scene;
use std::sync::Arc;

fn run(text: &str, spec: Spec, spp: u32) -> Outcome {
    let scene = Arc::new(Scene::from_toml(text).unwrap());
    Setup::for_scene(scene, Settings { spp, spec, threads: 2, ..Settings::default() }).unwrap().run(None).unwrap()
}

fn spec(estimator: &str, kernel: &str) -> Spec {
    Spec { width: 64, height: 48, estimator: estimator.into(), kernel: kernel.into(), ..Spec::default() }
}

/// Mean of the first channel over pixels, and its standard error.
fn mean(film: &Film) -> (f64, f64) {
    let means: Vec<f64> = film.pixels().iter().map(|pixel| pixel.mean()[0]).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// A hollow sphere of radius 1 with albedo 0.9 and emission 0.1, seen from its centre.
const HOLLOW: &str = r#"
about = "an approximation"
estimator = "bsdf"
background = [0.0, 0.0, 0.0]
[camera.pinhole]
position = [0.0, 0.0, 0.0]
look-at = [0.0, 0.0, 1.0]
field-of-view = 60.0
[[objects]]
name = "hollow"
shape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 } }
material = { diffuse = { albedo = [0.9, 0.9, 0.9] } }
emission = [0.1, 0.1, 0.1]
"#;

/// A chord that leaves at an angle with cosine c has the length 2c. So a share of e^2/4 of all cosine-distributed
/// directions has chords shorter than e. These are lost, and the radiance is 0.1/(1 - 0.9 (1 - e^2/4)) instead of 1.
/// Two-sided at 5 standard errors.
#[test]
fn an_epsilon_loses_the_light_of_shorter_ways() {
    for (epsilon, exact) in [("none", 1.0), ("1e-6", 1.0), ("0.5", 0.1 / (1.0 - 0.9 * (1.0 - 0.0625))), ("1.5", 0.0)] {
        let spec = Spec { epsilon: Some(epsilon.into()), ..spec("bsdf", "scalar") };
        let (found, error) = mean(&run(HOLLOW, spec, 64).film);
        assert!(
            (found - exact).abs() <= 5.0 * error + 1e-9,
            "epsilon {epsilon}: {found} +- {error} instead of {exact}"
        );
    }
}

/// A lamp in the dark, seen sharply.
const LAMP: &str = r#"
about = "an approximation"
estimator = "bsdf"
background = [0.0, 0.0, 0.0]
[camera.pinhole]
position = [0.0, 0.0, 0.0]
look-at = [0.0, 0.0, 1.0]
field-of-view = 60.0
[[objects]]
name = "lamp"
shape = { sphere = { center = [0.3, 0.2, 5.0], radius = 1.5 } }
material = { diffuse = { albedo = [0.0, 0.0, 0.0] } }
emission = [1.0, 1.0, 1.0]
"#;

/// With rays through the centre, a pixel is either lit or dark. Samples spread over the pixel give the lit share of
/// it. The mean over the image is the lamp's solid angle on the image plane in both cases, except for the edge.
#[test]
fn rays_through_the_centre_see_no_part_of_a_pixel() {
    for kernel in ["scalar", "lanes"] {
        for (filter, has_parts) in [("center", false), ("box", true), ("tent", true)] {
            let spec = Spec { filter: Some(filter.into()), ..spec("bsdf", kernel) };
            let film = run(LAMP, spec, 64).film;
            let values: Vec<f64> = film.pixels().iter().map(|pixel| pixel.mean()[0]).collect();
            let parts = values.iter().filter(|value| 0.0 < **value && **value < 1.0).count();
            assert_eq!(parts > 0, has_parts, "{filter}, {kernel}: {parts} pixels are partly lit");
            assert!(values.contains(&0.0) && values.contains(&1.0), "{filter}, {kernel}");
        }
    }
}

/// Naming the camera's default filter changes nothing: the same bits, and no bias.
#[test]
fn the_filter_of_the_camera_is_no_approximation() {
    let plain = run(LAMP, spec("bsdf", "lanes"), 16);
    let named = run(LAMP, Spec { filter: Some("box".into()), ..spec("bsdf", "lanes") }, 16);
    assert_eq!(plain.checksum, named.checksum);
}

/// A floor under a point light with the reach `reach`.
fn floor(reach: &str) -> String {
    format!(
        r#"
about = "an approximation"
estimator = "whitted"
background = [0.0, 0.0, 0.0]
[camera.pinhole]
position = [0.0, 4.0, 0.0]
look-at = [0.0, 0.0, 0.0]
up = [0.0, 0.0, 1.0]
field-of-view = 60.0
[[point-lights]]
position = [0.0, 1.0, 0.0]
intensity = [1.0, 1.0, 1.0]
{reach}
[[objects]]
name = "floor"
shape = {{ plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }} }}
material = {{ diffuse = {{ albedo = [0.5, 0.5, 0.5] }} }}
"#
    )
}

/// The floor is lit within a circle of radius sqrt(reach^2 - 1) and dark outside. Within, nothing changes.
#[test]
fn a_light_ends_at_its_reach() {
    let spec = || Spec { filter: Some("center".into()), ..spec("whitted", "scalar") };
    let endless = run(&floor(""), spec(), 4).film;
    let ended = run(&floor("reach = 1.5"), spec(), 4).film;
    let mut dark = 0;
    for (index, (endless, ended)) in endless.pixels().iter().zip(ended.pixels()).enumerate() {
        let (column, row) = ((index % 64) as f64 + 0.5, (index / 64) as f64 + 0.5);
        // Height of the image on the floor: 2 * 4 * tan(30 degrees), which is 8 / sqrt(3).
        let pixel = 8.0 * 3.0_f64.sqrt().recip() / 48.0;
        let (across, down) = (column - 32.0, row - 24.0);
        let distance = (across * across + down * down).sqrt() * pixel;
        let is_lit = distance * distance + 1.0 <= 1.5 * 1.5;
        assert_eq!(ended.mean(), if is_lit { endless.mean() } else { [0.0; 3] }, "pixel {index} at {distance}");
        dark += u32::from(!is_lit);
    }
    assert!((100..3000).contains(&dark), "{dark} of 3072 pixels are out of reach");
}
