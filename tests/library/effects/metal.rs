//! Rough and smooth metal.

use crate::estimate::{diffuse, mean, object, render, scene, sphere, view};

/// H23: the smoothest rough metal gives the image of the smooth one, which is a separate type: within 3.3 standard
/// errors, two-sided level 1e-3. The ball mirrors a lamp, so a lobe that is too wide or has too large a weight would
/// show.
#[test]
fn the_smoothest_metal_is_a_mirror() {
    let image = |alpha: f64| {
        let metal = format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [0.9, 0.9, 0.9] }} }}");
        let scene = scene(&[
            view([0.0, 0.0, 4.0], [0.0; 3], [0.0, 1.0, 0.0], 30.0),
            object(&sphere([0.0; 3], 1.0), &metal, [0.0; 3]),
            object(&sphere([1.5, 2.5, 3.0], 0.5), &diffuse(0.0), [9.0; 3]),
            object(&sphere([0.0; 3], 10.0), &diffuse(0.5), [0.5; 3]),
        ]);
        mean(&render(&scene, "bsdf", 400_000, None), 0)
    };
    let ((rough, e), (smooth, f)) = (image(1e-4), image(0.0));
    let error = (e * e + f * f).sqrt();
    assert!(error < 3e-3 * smooth, "no power: {error} of {smooth}");
    assert!((rough - smooth).abs() < 3.3 * error, "{rough} and {smooth}, error {error}");
}
