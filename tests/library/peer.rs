//! Comparison of the estimator `smallpt` with another program of the same estimator: the C++ yardstick in
//! `experiments/peers/`.
//!
//! The two differ in language, random numbers, intersection formula and recursion. Without g++ the test reports this
//! and passes.

use pathmark::analysis::mean::Moments;
use pathmark::image_io::{self, Image};
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup, available_threads};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use std::path::Path;
use std::process::Command;

const SIZE: (u32, u32) = (128, 96);
const SPP: u32 = 16;
const SEEDS: u64 = 8;
const BLOCK: u32 = 16;

/// Mean over pixels and channels of each block of 16x16 pixels.
fn block_means(image: &Image) -> Vec<f64> {
    let mut means = Vec::new();
    for y0 in (0..image.height).step_by(BLOCK as usize) {
        for x0 in (0..image.width).step_by(BLOCK as usize) {
            let pixels = (y0..y0 + BLOCK).flat_map(|y| (x0..x0 + BLOCK).map(move |x| (x, y)));
            let sum: f64 = pixels.map(|(x, y)| image.pixel(x, y).iter().sum::<f64>()).sum();
            means.push(sum / f64::from(3 * BLOCK * BLOCK));
        }
    }
    means
}

fn ours(seed: u64) -> Image {
    let settings = Settings {
        scene: "cornell".to_string(),
        spp: SPP,
        spec: Spec { width: SIZE.0, height: SIZE.1, seed, ..Spec::default() },
        decomposition: "tiles:16x16".to_string(),
        strategy: "work-stealing".to_string(),
        threads: available_threads(),
        ..Settings::default()
    };
    Setup::prepare(settings).unwrap().run(None).unwrap().film.image()
}

/// Builds the yardstick. Returns `None` without a C++ compiler.
fn build_peer(folder: &Path) -> Option<std::path::PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments/peers/smallpt_peer.cpp");
    let program = folder.join("smallpt_peer");
    let status = Command::new("g++").arg("-O3").arg(source).arg("-o").arg(&program).status();
    match status {
        Ok(status) => {
            assert!(status.success(), "the yardstick does not compile");
            Some(program)
        }
        Err(_) => None,
    }
}

fn theirs(program: &Path, folder: &Path, seed: u64) -> Image {
    let out = folder.join("peer.pfm");
    let numbers = [SIZE.0, SIZE.1, SPP].map(|number| number.to_string());
    let status =
        Command::new(program).args(numbers).arg(&out).args(["keyed", &seed.to_string()]).output().unwrap().status;
    assert!(status.success());
    image_io::read(&out).unwrap()
}

/// Welch's t of every block over eight seeds each: none exceeds its two-sided Sidak level (1e-3 over all). The sum of
/// their squares agrees with chance, and is neither too large nor too small (two-sided 1e-3).
#[test]
fn block_means_agree_with_the_yardstick() {
    let folder = tempfile::tempdir().unwrap();
    let Some(program) = build_peer(folder.path()) else {
        println!("skipped: there is no g++ to build the yardstick with");
        return;
    };
    let blocks = block_means(&ours(1)).len();
    let (mut here, mut there) = (vec![Moments::of(&[]); blocks], vec![Moments::of(&[]); blocks]);
    for seed in 1..=SEEDS {
        for (moments, image) in [(&mut here, ours(seed)), (&mut there, theirs(&program, folder.path(), seed))] {
            moments.iter_mut().zip(block_means(&image)).for_each(|(moments, mean)| moments.push(mean));
        }
    }
    let freedom = 2.0 * (SEEDS as f64 - 1.0);
    let student = StudentsT::new(0.0, 1.0, freedom).unwrap();
    let level = pathmark::analysis::z_test::sidak(1e-3, blocks).unwrap();
    let limit = student.inverse_cdf(1.0 - level / 2.0);
    let mut chi2 = 0.0;
    for (index, (a, b)) in here.iter().zip(&there).enumerate() {
        let (ea, eb) = (a.standard_error().unwrap(), b.standard_error().unwrap());
        let t = (a.mean().unwrap() - b.mean().unwrap()) / (ea * ea + eb * eb).sqrt();
        assert!(t.abs() < limit, "block {index}: t = {t:.2}, limit {limit:.2}");
        // Maps t to a standard normal deviate of the same probability.
        let z = pathmark::analysis::z_test::normal_quantile(student.cdf(t)).unwrap();
        chi2 += z * z;
    }
    let expected = ChiSquared::new(blocks as f64).unwrap();
    let p = expected.cdf(chi2);
    assert!(
        (5e-4..1.0 - 5e-4).contains(&p),
        "the squared deviations add up to {chi2:.1} over {blocks} blocks: p = {p:.5}"
    );
}
