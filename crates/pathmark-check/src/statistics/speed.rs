//! The price of an accuracy in time, and speedups that are too good.

use crate::Trials;
use crate::analysis::jackknife::{Curve, SeedCurves};
use crate::analysis::price::{Law, Renderer};
use crate::analysis::speedup::{
    Cause, Evidence, Oddity, cause, efficiency, is_superlinear, oddity, serial_fraction, speedup,
};
use crate::analysis::{Estimate, Interval};
use crate::film::Film;
use crate::kernel::KERNELS;
use crate::rendering::{run, spec};
use crate::scene::Scene;
use crate::stage::{camera, diffuse, object, plane, scene, sphere};

/// A diffuse ball under half a sky, seen where its normal is horizontal: 1/4 in every pixel, without a heavy tail.
fn half_lit() -> Scene {
    scene(&[
        "background = [1.0, 1.0, 1.0]\n".to_string(),
        camera([4.0, 0.0, 0.0], [0.0; 3]),
        object(&plane([0.0, -5.0, 0.0], [0.0, 1.0, 0.0]), &diffuse(0.0), [0.0; 3]),
        object(&sphere([0.0; 3], 1.0), &diffuse(0.5), [0.0; 3]),
    ])
}

fn squared_error(film: &Film) -> f64 {
    let errors = film.pixels().iter().map(|pixel| pixel.mean()[0] - 0.25);
    errors.map(|error| error * error).sum::<f64>() / film.pixels().len() as f64
}

/// An error e takes v/e^2 samples and t v/e^2 seconds, and the efficiency is 1/(v t). A render with the predicted
/// number of samples has the requested error within 5 %.
pub(super) fn price(trials: &mut Trials) {
    let (variance, seconds) = (9.0, 0.02);
    let seed = |factor: f64| -> Curve { [4.0, 16.0, 64.0].map(|spp| (spp, factor * variance / spp)).to_vec() };
    let known = Interval::between(seconds * 0.99, seconds * 1.01, 0.95).expect("an interval");
    let renderer = |curves: &[Curve]| Renderer {
        curves: SeedCurves::of_errors(curves).expect("curves"),
        law: Law::Independent,
        seconds_per_spp: Estimate { value: seconds, interval: known },
    };
    let even = renderer(&[seed(0.99), seed(1.01), seed(1.0)]);
    for goal in [0.1, 0.05] {
        let price = even.price(goal).expect("a price");
        let spp = variance / (goal * goal);
        trials.close(format!("samples for {goal}"), spp, price.spp.value, 1e-3 * spp);
        trials.close(format!("seconds for {goal}"), seconds * spp, price.seconds.value, 1e-3 * seconds * spp);
        let back = even.rmse_after(seconds * spp).map_or(f64::NAN, |error| error.value);
        trials.close(format!("error after so many seconds, {goal}"), goal, back, 1e-3 * goal);
    }
    let found = even.efficiency().map_or(f64::NAN, |efficiency| efficiency.value);
    trials.close("efficiency", 1.0 / (variance * seconds), found, 1e-3 / (variance * seconds));

    let scene = half_lit();
    let render = |seed, spp| squared_error(&run(&scene, spec("bsdf", KERNELS[0].name, [64; 2], seed), spp).film);
    let curves: Vec<Curve> =
        (1..=5).map(|seed| [4, 8, 16].map(|spp| (f64::from(spp), render(seed, spp))).to_vec()).collect();
    for goal in [0.03, 0.015] {
        let wanted = renderer(&curves).price(goal).expect("a price").spp.value;
        // The rounded number of samples has a slightly different goal.
        let spp = libm::round(wanted).max(1.0);
        let found = render(77, spp as u32).sqrt() / (goal * (wanted / spp).sqrt());
        trials.close(format!("paid for {goal}: found over asked"), 1.0, found, 0.05);
    }
}

/// From 1 to 2 processes, report C is 2.2 times as fast: Karp and Flatt's serial fraction is negative. The program
/// reports this with a cause for which there is evidence, and never guesses one.
pub(super) fn odd_speedups(trials: &mut Trials) {
    let interval = |low, high| Interval::between(low, high, 0.95).expect("an interval");
    trials.same("12 s to 3 s on 8", (Some(4.0), Some(0.5)), (speedup(12.0, 3.0), efficiency(4.0, 8)));
    // e = (1/S - 1/p)/(1 - 1/p)
    let fraction = |speedup, workers| serial_fraction(speedup, workers).unwrap_or(f64::NAN);
    trials.close("2.2 on 2: serial fraction", -1.0 / 11.0, fraction(2.2, 2), 1e-15);
    trials.close("4.71 on 8: serial fraction", 0.099_787_685_774_946_93, fraction(4.71, 8), 1e-12);
    trials.close("0.5 on 2: serial fraction", 3.0, fraction(0.5, 2), 1e-15);
    trials.same("2.01 and 2 on 2", (true, false), (is_superlinear(2.01, 2), is_superlinear(2.0, 2)));
    for (low, high, workers, expected) in [
        (2.1, 2.3, 2, Some(Oddity::Superlinear)),
        (1.9, 2.1, 2, None),
        (1.0, 2.0, 2, None),
        (0.8, 0.99, 4, Some(Oddity::Slowdown)),
        (0.9, 1.1, 4, None),
    ] {
        let found = oddity(&interval(low, high), workers);
        trials.same(format!("{low} to {high} on {workers}"), expected, found);
    }
    let none = Evidence::default();
    let one = |low, high| Some(interval(low, high));
    for (what, evidence, expected) in [
        ("nothing known", none, Cause::Unexplained),
        ("the baseline is as fast", Evidence { at_one_worker: one(0.97, 1.02), ..none }, Cause::Unexplained),
        (
            "the baseline is slower",
            Evidence { at_one_worker: one(1.01, 1.05), warnings: 3, ..none },
            Cause::SlowBaseline,
        ),
        ("warnings", Evidence { warnings: 1, ..none }, Cause::Disturbance),
        ("shared cores", Evidence { processors: Some(4), physical_cores: Some(2), ..none }, Cause::SharedCores),
        ("whole cores", Evidence { processors: Some(2), physical_cores: Some(2), ..none }, Cause::Unexplained),
    ] {
        trials.same(format!("2.2 on 2, {what}"), expected, cause(&evidence));
    }
}
