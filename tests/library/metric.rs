//! Metrics compared with values that can be computed by hand.

use pathmark::image_io::{self, Image, tone_map};
use pathmark::metric::{
    self, METRICS, REL_MSE_EPSILON, bias_squared, cross_mse, cross_mse_display, cross_rel_mse, heatmap, root,
};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

fn value(name: &str, test: &Image, reference: &Image) -> f64 {
    metric::find(name).expect("a metric").compute(test, reference).expect("pictures of one size")
}

fn assert_close(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{value} is not {expected}");
}

/// A grey ramp with some colour, in [0.1, 0.6].
fn scene(width: u32, height: u32) -> Image {
    let mut image = Image::new(width, height);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        let t = (i * 7 % 50) as f64 / 100.0;
        *pixel = [0.1 + t, 0.6 - t, 0.3];
    }
    image
}

fn map(image: &Image, f: impl Fn(f64) -> f64) -> Image {
    Image { pixels: image.pixels.iter().map(|pixel| pixel.map(&f)).collect(), ..image.clone() }
}

/// `image` with independent noise of mean 0 and variance `sigma`^2 in every channel.
fn noisy(image: &Image, sigma: f64, random: &mut Pcg64Mcg) -> Image {
    let mut noisy = image.clone();
    for value in noisy.pixels.as_flattened_mut() {
        let uniform = random.next_u64() as f64 / u64::MAX as f64;
        *value += sigma * 12.0_f64.sqrt() * (uniform - 0.5);
    }
    noisy
}

#[test]
fn a_constant_offset_is_its_own_error() {
    let reference = scene(16, 12);
    for offset in [0.25, -0.25] {
        let test = map(&reference, |v| v + offset);
        assert_close(value("rmse", &test, &reference), 0.25);
        assert_close(value("mae", &test, &reference), 0.25);
        assert_close(value("mse", &test, &reference), 0.0625);
    }
    // One channel of one of four pixels is 3 off: sqrt(9 / 12) and 3 / 12.
    let reference = Image::new(2, 2);
    let mut test = reference.clone();
    test.pixels[2][1] = 3.0;
    assert_close(value("rmse", &test, &reference), 0.75_f64.sqrt());
    assert_close(value("mae", &test, &reference), 0.25);
    assert_close(value("rel-mse", &test, &reference), 0.75 / REL_MSE_EPSILON);
}

#[test]
fn the_relative_error_is_relative() {
    let reference = map(&Image::new(3, 3), |_| 2.0);
    let test = map(&reference, |v| v + 0.5);
    assert_close(value("rel-mse", &test, &reference), 0.25 / 4.01);
    let bright = (map(&test, |v| 1e3 * v), map(&reference, |v| 1e3 * v));
    assert!((value("rel-mse", &bright.0, &bright.1) - 0.0625).abs() < 1e-8);
}

#[test]
fn display_metrics_see_displayed_values() {
    let reference = Image::new(12, 12);
    let test = map(&reference, |_| tone_map::linear(0.1));
    assert_close(value("rmse-display", &test, &reference), 0.1);
    assert_close(value("psnr", &test, &reference), 20.0);
    // A display shows values above white as white.
    let (white, sun) = (map(&reference, |_| 1.0), map(&reference, |_| 50.0));
    assert_close(value("rmse-display", &sun, &white), 0.0);
    assert_close(value("rmse", &sun, &white), 49.0);
}

#[test]
fn equal_pictures_have_the_best_value_of_each_metric() {
    let image = scene(20, 15);
    for entry in METRICS {
        let value = entry.compute(&image, &image).unwrap();
        assert!(value.total_cmp(&entry.best).is_eq(), "{} = {value}", entry.name);
    }
}

#[test]
fn ssim_has_its_closed_form_values() {
    // Two constant pictures: only the luminance term is left, (2 a b + C1) / (a^2 + b^2 + C1).
    let (a, b): (f64, f64) = (0.3, 0.6);
    let flat = |display: f64| map(&Image::new(13, 11), |_| tone_map::linear(display));
    let expected = (2.0 * a * b + 1e-4) / (a * a + b * b + 1e-4);
    assert_close(value("ssim", &flat(a), &flat(b)), expected);
    // A checkerboard against its inverse, both of mean 1/2: the structure term is -1 up to the constants.
    let board = |odd: bool| {
        let mut image = Image::new(31, 31);
        for (i, pixel) in image.pixels.iter_mut().enumerate() {
            *pixel = [tone_map::linear(if (i % 2 == 0) == odd { 0.25 } else { 0.75 }); 3];
        }
        image
    };
    let ssim = value("ssim", &board(true), &board(false));
    let structure = (-2.0 * 0.0625 + 9e-4) / (2.0 * 0.0625 + 9e-4);
    assert!((ssim - structure).abs() < 1e-3, "{ssim} {structure}");
    // One impulse in the middle of an 11 x 11 picture against black: one window, whose centre weight w has a closed form.
    let bell = |d: i32| libm::exp(-f64::from(d * d) / 4.5);
    let sum: f64 = (-5..=5).map(bell).sum();
    let w = 1.0 / (sum * sum);
    let mut impulse = Image::new(11, 11);
    impulse.pixels[60] = [1.0; 3];
    let expected = 1e-4 / (w * w + 1e-4) * (9e-4 / (w - w * w + 9e-4));
    assert_close(value("ssim", &impulse, &Image::new(11, 11)), expected);
    // Luma weighs the channels by BT.601.
    let mut green = Image::new(11, 11);
    green.pixels.fill([0.0, 1.0, 0.0]);
    let mut grey = Image::new(11, 11);
    grey.pixels.fill([tone_map::linear(0.587); 3]);
    assert_close(value("ssim", &green, &grey), 1.0);
    assert!(value("ssim", &scene(10, 40), &scene(10, 40)).is_nan());
}

#[test]
fn ssim_is_the_mean_of_the_definition_at_every_place() {
    let (width, height) = (17, 14);
    let mut random = Pcg64Mcg::new(3);
    let reference = noisy(&scene(width, height), 0.02, &mut random);
    let test = noisy(&reference, 0.1, &mut random);
    let luma = |image: &Image, x: u32, y: u32| {
        let [r, g, b] = image.pixel(x, y).map(tone_map::display);
        0.299 * r + 0.587 * g + 0.114 * b
    };
    let bell = |d: u32| libm::exp(-(f64::from(d) - 5.0) * (f64::from(d) - 5.0) / 4.5);
    let mut similarities = Vec::new();
    for (left, top) in (0..height - 10).flat_map(|top| (0..width - 10).map(move |left| (left, top))) {
        let window: Vec<(f64, f64, f64)> = (0..121)
            .map(|i| (i % 11, i / 11))
            .map(|(x, y)| (bell(x) * bell(y), (left + x, top + y)))
            .map(|(w, (x, y))| (w, luma(&test, x, y), luma(&reference, x, y)))
            .collect();
        let total: f64 = window.iter().map(|(w, _, _)| w).sum();
        let mean = |f: &dyn Fn(f64, f64) -> f64| window.iter().map(|&(w, a, b)| w * f(a, b)).sum::<f64>() / total;
        let (ma, mb) = (mean(&|a, _| a), mean(&|_, b| b));
        let (va, vb) = (mean(&|a, _| (a - ma) * (a - ma)), mean(&|_, b| (b - mb) * (b - mb)));
        let cov = mean(&|a, b| (a - ma) * (b - mb));
        let luminance = (2.0 * ma * mb + 1e-4) / (ma * ma + mb * mb + 1e-4);
        similarities.push(luminance * (2.0 * cov + 9e-4) / (va + vb + 9e-4));
    }
    let expected = similarities.iter().sum::<f64>() / similarities.len() as f64;
    assert!(expected > 0.2 && expected < 0.9, "a case that tells: {expected}");
    assert_close(value("ssim", &test, &reference), expected);
}

#[test]
fn the_cross_form_does_not_see_the_noise_of_the_references() {
    let truth = scene(64, 64);
    let mut random = Pcg64Mcg::new(11);
    let (sigma_t, sigma_r, bias) = (0.05, 0.05, 0.02);
    let expected = sigma_t * sigma_t + bias * bias;
    let (mut cross, mut plain, mut display, runs) = (0.0, 0.0, 0.0, 40);
    for _ in 0..runs {
        let test = map(&noisy(&truth, sigma_t, &mut random), |v| v + bias);
        let references = [noisy(&truth, sigma_r, &mut random), noisy(&truth, sigma_r, &mut random)];
        cross += cross_mse(&test, &references[0], &references[1]).unwrap() / f64::from(runs);
        let rmse = value("rmse", &test, &references[0]);
        plain += rmse * rmse / f64::from(runs);
        let exact = value("rmse-display", &test, &truth);
        display +=
            cross_mse_display(&test, &references[0], &references[1]).unwrap() / (exact * exact) / f64::from(runs);
    }
    // 40 x 12288 products: a standard deviation of 0.3 %.
    assert!((cross / expected - 1.0).abs() < 0.012, "{cross} {expected}");
    assert!((plain / (expected + sigma_r * sigma_r) - 1.0).abs() < 0.012, "{plain}");
    assert!((display - 1.0).abs() < 0.1, "nearly unbiased: {display}");
}

/// Each reference has only four times the test's samples, so a quarter of its variance. The plain RMSE is then sqrt(1
/// + 1/4) times the truth, and the cross form is right.
#[test]
fn a_reference_of_four_times_the_samples_is_enough_for_the_cross_form() {
    let truth = scene(256, 192);
    let mut random = Pcg64Mcg::new(5);
    let sigma = 0.05;
    let test = noisy(&truth, sigma, &mut random);
    let halves = [noisy(&truth, 0.5 * sigma, &mut random), noisy(&truth, 0.5 * sigma, &mut random)];
    let cross = root(cross_mse(&test, &halves[0], &halves[1]).unwrap()).unwrap() / sigma;
    let naive = value("rmse", &test, &halves[0]) / sigma;
    let relative = |image: &Image| cross_rel_mse(image, &halves[0], &halves[1]).unwrap();
    let exact = value("rel-mse", &test, &truth);
    assert!((relative(&test) / exact - 1.0).abs() < 0.02, "{} {exact}", relative(&test));
    // 147456 values: a standard deviation of 0.2 %.
    assert!((cross - 1.0).abs() < 0.01, "{cross}");
    assert!(naive > 1.1 && (naive - 1.25_f64.sqrt()).abs() < 0.01, "{naive}");
}

#[test]
fn percentiles_count_pixels() {
    let reference = Image::new(20, 10);
    let mut test = reference.clone();
    for (index, pixel) in test.pixels.iter_mut().enumerate() {
        // Errors 1 to 200 in another order. They are in one channel only, so the metric divides them by the root of 3.
        *pixel = [0.0, ((index * 77) % 200 + 1) as f64 * 3.0_f64.sqrt(), 0.0];
    }
    for (name, expected) in [("error-50", 100.0), ("error-90", 180.0), ("error-99", 198.0), ("error-100", 200.0)] {
        assert_close(value(name, &test, &reference), expected);
    }
}

#[test]
fn a_negative_cross_error_has_no_root() {
    let zero = Image::new(2, 2);
    let (above, below) = (map(&zero, |_| 0.5), map(&zero, |_| -0.25));
    let mse = cross_mse(&zero, &above, &below).unwrap();
    assert_close(mse, -0.125);
    assert_eq!((root(mse), root(f64::NAN), root(0.0), root(0.25)), (None, None, Some(0.0), Some(0.5)));
    assert_close(cross_mse_display(&map(&zero, |_| 1.0), &zero, &map(&zero, |_| tone_map::linear(0.5))).unwrap(), 0.5);
}

#[test]
fn a_nan_is_never_hidden() {
    let reference = scene(12, 12);
    let mut test = reference.clone();
    test.pixels[70][0] = f64::NAN;
    for entry in METRICS {
        for (a, b) in [(&test, &reference), (&reference, &test)] {
            let found = entry.compute(a, b).unwrap();
            // One pixel of 144 has the largest error. The others, 99.3 % of them, are equal.
            if ["error-50", "error-90", "error-99"].contains(&entry.name) {
                assert_eq!(found, 0.0, "{}", entry.name);
            } else {
                assert!(found.is_nan(), "{}", entry.name);
            }
        }
    }
    assert!(cross_mse(&reference, &reference, &test).unwrap().is_nan());
}

#[test]
fn pictures_of_two_sizes_are_refused_with_both() {
    let (a, b) = (Image::new(4, 3), Image::new(3, 4));
    let mut errors: Vec<_> = METRICS.iter().map(|entry| entry.compute(&a, &b).unwrap_err()).collect();
    errors.push(cross_mse(&a, &a, &b).unwrap_err());
    errors.push(bias_squared([&a, &a], [&a, &b]).unwrap_err());
    errors.push(cross_mse_display(&a, &b, &a).unwrap_err());
    errors.push(cross_rel_mse(&a, &a, &b).unwrap_err());
    errors.push(heatmap(&a, &b, None).unwrap_err());
    for error in errors {
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("4x3") && error.to_string().contains("3x4"), "{error}");
    }
    let error = metric::find("butterflies").unwrap_err().to_string();
    assert!(
        error.contains(
            "mse, rmse, rel-mse, mae, error-50, error-90, error-99, error-100, rmse-display, psnr, flip, ssim"
        ),
        "{error}"
    );
}

#[test]
fn a_heatmap_grows_lighter_in_equal_steps() {
    let reference = Image::new(256, 1);
    let mut test = reference.clone();
    for (x, pixel) in test.pixels.iter_mut().enumerate() {
        *pixel = [x as f64 / 255.0; 3];
    }
    let map = heatmap(&test, &reference, Some(1.0)).unwrap();
    let lightness: Vec<f64> = map.pixels.iter().copied().map(cie_lightness).collect();
    let steps: Vec<f64> = lightness.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step != 0.0).collect();
    // CIE L* was not used to construct the map. Its range of 90 is divided into 31 steps, between 32 colours.
    assert_eq!(steps.len(), 31);
    assert!(steps.iter().all(|step| (2.0..4.0).contains(step)), "{steps:?}");
    assert!(lightness[0] < 8.0 && lightness[255] > 93.0, "{} {}", lightness[0], lightness[255]);
    // The colours end at the scale, and a negative difference counts like a positive one.
    let double = heatmap(&test, &reference, Some(2.0)).unwrap();
    assert_eq!(double.pixels[254], map.pixels[127]);
    assert_eq!(heatmap(&test, &reference, Some(0.5)).unwrap().pixels[200], map.pixels[255]);
    assert_eq!(heatmap(&reference, &test, Some(1.0)).unwrap(), map);
}

/// CIE 1976 L* of an sRGB colour.
fn cie_lightness(pixel: [u8; 3]) -> f64 {
    let linear = pixel.map(|v| {
        let v = f64::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
    });
    let y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    if y > 0.008_856 { 116.0 * libm::cbrt(y) - 16.0 } else { 903.3 * y }
}

#[test]
fn a_heatmap_chooses_its_scale_and_marks_missing_numbers() {
    let reference = Image::new(100, 2);
    let mut test = map(&reference, |_| 0.5);
    test.pixels[7] = [1000.0; 3];
    test.pixels[8] = [f64::NAN; 3];
    let map = heatmap(&test, &reference, None).unwrap();
    assert_close(map.scale, 0.5);
    assert_eq!(map.pixels[7], map.pixels[0]);
    assert_eq!(map.pixels[8], [0, 255, 255]);
    assert_close(heatmap(&reference, &reference, None).unwrap().scale, 1.0);
    test = reference.clone();
    test.pixels[3] = [0.1; 3];
    assert_close(heatmap(&test, &reference, None).unwrap().scale, 0.1);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(heatmap(&test, &reference, Some(scale)).unwrap_err().exit_code(), 2);
    }
}

#[test]
fn a_written_heatmap_has_its_own_colours() {
    let (test, reference) = (scene(30, 20), map(&scene(30, 20), |v| v * v));
    let map = heatmap(&test, &reference, None).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("map.png");
    image_io::write(&path, &map.to_image()).unwrap();
    let back = image_io::read(&path).unwrap();
    let colours: Vec<_> = back.pixels.iter().map(|pixel| pixel.map(|v| tone_map::quantise(v).unwrap())).collect();
    assert_eq!(colours, map.pixels);
}
