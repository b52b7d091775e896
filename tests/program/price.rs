//! The price of an accuracy: the prediction, and whether the render at that price has the predicted accuracy.

use crate::program::{Finished, finish, in_memory, pathmark};
use serde_json::Value;

fn price(arguments: &[&str]) -> Finished {
    let folder = in_memory();
    finish(pathmark(folder.path(), &[&["price", "cornell", "--quiet"], arguments].concat()))
}

fn rows(arguments: &[&str]) -> Vec<Value> {
    let finished = price(&[&["--json"], arguments].concat()).with_code(0);
    serde_json::from_str(&finished.out).unwrap()
}

/// The squared error of independent samples falls as 1/n, so half the RMSE takes four times the samples and seconds.
#[test]
fn half_the_error_is_predicted_to_cost_four_times_as_much() {
    let rows = rows(&["--size", "24x18", "--rmse", "0.2,0.1", "--pilot-spp", "8", "--threads", "1"]);
    let number = |row: usize, field: &str| rows[row][field].as_f64().unwrap();
    assert_eq!(rows.len(), 2);
    for row in &rows {
        let number = |field: &str| row[field].as_f64().unwrap();
        assert!(number("seconds_low") < number("seconds") && number("seconds") < number("seconds_high"));
        assert!(number("spp_low") < number("spp") && number("spp") < number("spp_high") + 4.0);
        assert!((number("half_rmse_seconds") / number("seconds") - 4.0).abs() < 1e-9);
        assert!(number("kurtosis") > 1.0 && (0.0..1.0).contains(&number("largest_share")));
        assert!(row["paid_rmse"].is_null(), "nobody paid");
    }
    // Rounded up to a multiple of the four subpixels.
    assert!((number(1, "spp") - 4.0 * number(0, "spp")).abs() <= 16.0 && number(0, "spp") % 4.0 == 0.0);
}

/// The goal is reached: two images with seeds that the pilot has not used differ by as much as predicted. The pilot's
/// interval bounds the prediction's error. The rest is the noise of two images of 1728 pixels, a standard deviation of
/// about 3 %.
#[test]
fn paying_meets_the_prediction() {
    for (estimator, sampler) in [("bsdf", "independent"), ("smallpt", "sobol")] {
        let rows = rows(&[
            "--size",
            "48x36",
            "--rmse",
            "0.15",
            "--estimator",
            estimator,
            "--sampler",
            sampler,
            "--verify",
            "--pilot-spp",
            "16",
        ]);
        let ratio = rows[0]["rmse_ratio"].as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 0.12, "{estimator} with {sampler}: {}", rows[0]);
        // Sobol sample counts are rounded up to a power of two, so the error may be smaller.
        let reached = rows[0]["paid_rmse"].as_f64().unwrap() / 0.15;
        let least = if sampler == "sobol" { 0.5 } else { 0.86 };
        assert!((least..1.14).contains(&reached), "{}", rows[0]);
        let spp = rows[0]["spp"].as_u64().unwrap();
        assert!(sampler != "sobol" || spp.is_power_of_two(), "{}", rows[0]);
        assert!(rows[0]["paid_seconds"].as_f64().unwrap() > 0.0 && rows[0]["seconds_ratio"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn a_comparison_ends_with_all_estimators_in_a_line_and_what_it_cannot_tell() {
    let all = price(&["--size", "32x24", "--rmse", "0.2", "--estimator", "all"]).with_code(0).out;
    let (last, names) = (all.lines().nth_back(1).unwrap(), ["smallpt", "bsdf", "nee", "mis"]);
    assert!(all.trim_end().ends_with("the interval of the ratio of their seconds contains 1."), "{all}");
    assert!(last.starts_with("RMSE 0.2: ") && names.iter().all(|name| last.contains(name)), "{all}");
    assert!(!last.contains("whitted"), "its error has a part that no sample mends: {all}");
}

#[test]
fn every_estimator_is_priced_in_one_array() {
    let rows = rows(&["--size", "24x18", "--rmse", "0.2,0.1", "--estimator", "all", "--pilot-spp", "8"]);
    let names: Vec<&str> = rows.iter().map(|row| row["estimator"].as_str().unwrap()).collect();
    assert_eq!(names, ["smallpt", "smallpt", "bsdf", "bsdf", "nee", "nee", "mis", "mis"]);
    // Two estimators of a goal that share no group differ in their seconds.
    for a in &rows {
        for b in rows.iter().filter(|b| b["rmse"] == a["rmse"]) {
            let [own, others] = [a, b].map(|row| row["groups"].as_array().unwrap());
            let share = own.iter().any(|group| others.contains(group));
            assert!(!own.is_empty() && (share || a["seconds"] != b["seconds"]), "{a} and {b}");
        }
    }
}

#[test]
fn renders_without_a_price_are_refused() {
    for (arguments, field) in [
        (["--rmse", "0"].as_slice(), "rmse"),
        (&["--rmse", "0.1,-1"], "rmse"),
        (&["--rmse", "nan"], "rmse"),
        (&["--rmse", "1e-9", "--size", "8x6"], "rmse"),
        (&["--rmse", "0.1", "--pilot-spp", "6", "--estimator", "bsdf"], "pilot-spp"),
        (&["--rmse", "0.1", "--clamp", "subpixel", "--size", "8x6"], "clamp"),
        (&["--rmse", "0.1", "--seed", "9223372036854775807"], "seed"),
        (&["--rmse", "0.1", "--pilot-seeds", "2"], "pilot-seeds"),
    ] {
        let refused = price(arguments).with_code(2);
        assert!(refused.err.contains(field), "{arguments:?}: {}", refused.err);
        assert!(refused.out.is_empty());
    }
}

/// An estimator that needs no more may have a pilot of one sample, even beside estimators that need more.
#[test]
fn a_short_pilot_is_compared_with_estimators_that_need_more() {
    let folder = in_memory();
    let arguments =
        ["price", "spheres:50", "--size", "16x12", "--rmse", "1", "--estimator", "bsdf", "--pilot-spp", "1"];
    let priced = finish(pathmark(folder.path(), &arguments)).with_code(0);
    assert!(priced.out.contains("spheres:50, bsdf"), "{}", priced.out);
}
