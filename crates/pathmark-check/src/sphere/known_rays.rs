//! Single rays whose roots are known to 25 digits (`data/sphere-oracle.json`): walls of radius 1e5, spheres far away, tiny and huge.

use super::exact::{Exact, is_first};
use super::formulas::{first_hits, smallpt_roots};
use crate::Trials;
use crate::math::{Vec3, dot, roots};
use serde_json::Value;

const ORACLE: &str = include_str!("../../data/sphere-oracle.json");

/// Checks that every implementation finds the roots of this ray within the bound. `smallpt_is_off` is a lower bound on
/// the error of smallpt's formula, if it is wrong there: otherwise the case could not tell the two apart.
pub(super) fn known(trials: &mut Trials, name: &str, smallpt_is_off: Option<f64>) {
    let rows: Vec<Value> = serde_json::from_str(ORACLE).expect("the oracle's file");
    let row = rows.iter().find(|row| row["name"] == name).expect("a row of that name");
    let vector = |field: &str| Vec3::from([0, 1, 2].map(|k| row[field][k].as_f64().expect("a number")));
    let root = |field: &str| row[field].as_str().and_then(|digits| digits.parse::<f64>().ok()).expect("a root");
    let (o, d, c, r) = (vector("o"), vector("d"), vector("c"), row["r"].as_f64().expect("a radius"));
    let (f, expected) = (o - c, [root("t0"), root("t1")]);
    let exact = Exact::of(f, d, r);
    let bounds = expected.map(|t| exact.bound(f, d, r, t));
    let (near, far) = roots(f, d, dot(d, d), r);
    trials.close("nearer root, f64", expected[0], near, bounds[0]);
    trials.close("farther root, f64", expected[1], far, bounds[1]);
    let ahead = usize::from(expected[0] <= 0.0);
    for (way, found) in first_hits(o, d, c, r) {
        let told = format!("{:?} +- {:.1e}", expected[ahead], bounds[ahead]);
        trials.holds(way, told, format_args!("{found:?}"), is_first(found, expected, bounds));
    }
    if let Some(least) = smallpt_is_off {
        let (near, far) = smallpt_roots(f, d, r);
        let error = (near - expected[0]).abs().min((far - expected[1]).abs());
        let told = format_args!("off by more than {least:e}, or this ray would prove nothing");
        trials.holds("smallpt's formula", told, format_args!("off by {error:.2e}"), error > least);
    }
}
