//! Pixels of one object, so that errors can be measured there alone: most of a picture of one ball is not the ball.

use crate::error::{InputError, Result};
use crate::image_io::Image;
use crate::measure::Setup;
use crate::scene::{AllEffects, Filter, Scene};

fn index(scene: &Scene, object: &str) -> Result<u32> {
    if let Some((index, _)) = (0..).zip(&scene.objects).find(|(_, own)| own.name == object) {
        return Ok(index);
    }
    let names: Vec<&str> = scene.objects.iter().map(|own| own.name.as_str()).collect();
    let problem = format!("is not an object of {}", scene.name);
    Err(InputError::new("object", object, problem).allowed(names.join(", ")).into())
}

pub(super) fn check_object(setup: &Setup, object: &str) -> Result<()> {
    match setup.scene() {
        Some((scene, _)) => index(scene, object).map(|_| ()),
        None => Err(InputError::new("object", object, "cannot be used with a workload, which has no objects").into()),
    }
}

/// For each pixel, whether the ray through its centre hits the object first; empty without a scene.
pub(super) fn object_pixels(setup: &Setup, object: &str) -> Result<Vec<bool>> {
    let Some((scene, choice)) = setup.scene() else { return Ok(Vec::new()) };
    let wanted = index(scene, object)?;
    let spec = &setup.settings().spec;
    let view = choice.view(scene).filtered(Some(Filter::Center));
    let pixels = (0..spec.height).flat_map(|y| (0..spec.width).map(move |x| (x, y)));
    let is_on_it = |(x, y)| {
        let ray = view.ray::<AllEffects>(x, y, 0, [0.5; 2], || [0.5; 2]);
        let hit = scene.first_of_any(&ray, None);
        hit.is_some_and(|hit| hit.object == wanted)
    };
    Ok(pixels.map(is_on_it).collect())
}

/// The wanted pixels of an image, as an image of one row.
pub(super) fn only(image: &Image, wanted: &[bool]) -> Image {
    let pixels: Vec<[f64; 3]> =
        image.pixels.iter().zip(wanted).filter(|(_, is_wanted)| **is_wanted).map(|(pixel, _)| *pixel).collect();
    Image { width: pixels.len() as u32, height: 1, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Settings;

    /// The mirror ball in smallpt's box fills a disk in the lower left of the view.
    #[test]
    fn a_ball_fills_a_disk() {
        let mut settings = Settings::default();
        (settings.spec.width, settings.spec.height) = (64, 48);
        let setup = Setup::prepare(settings).unwrap();
        let wanted = object_pixels(&setup, "mirror ball").unwrap();
        assert_eq!(wanted.len(), 64 * 48);
        let places: Vec<(usize, usize)> = (0..wanted.len()).filter(|n| wanted[*n]).map(|n| (n % 64, n / 64)).collect();
        let [width, height] = [|p: &(usize, usize)| p.0, |p: &(usize, usize)| p.1].map(|of| {
            let places = || places.iter().map(of);
            (places().max().unwrap() - places().min().unwrap() + 1) as f64
        });
        assert!(places.iter().all(|(x, y)| *x < 32 && *y > 20), "{places:?}");
        let disk = std::f64::consts::PI / 4.0 * width * height;
        assert!((places.len() as f64 / disk - 1.0).abs() < 0.1, "{} pixels in {width} x {height}", places.len());
        let error = check_object(&setup, "ball").unwrap_err().to_string();
        assert!(error.contains("is not an object of cornell") && error.contains("mirror ball, glass ball"), "{error}");
    }
}
