//! Single rays whose roots are known to 25 digits (`data/sphere-oracle.json`): walls of radius 1e5, spheres far away, tiny and huge.

use super::exact::{Exact, is_first};
use super::formulas::{FORMULAS, first_hits};
use super::unguarded::smallpt_roots;
use crate::math::{Vec3, dot};
use crate::{Case, Trials};
use serde_json::Value;

pub(super) const CASES: &[Case] = &[
    Case {
        id: "S01",
        tries: "the left wall of smallpt's box from its middle: |f|² - r² loses 10 digits",
        run: |trials| known(trials, "wall-left-centre", None),
    },
    Case {
        id: "S02",
        tries: "the floor of smallpt's box at a grazing angle of 1e-3",
        run: |trials| known(trials, "wall-floor-grazing 1e-3", None),
    },
    Case {
        id: "S03",
        tries: "the floor of smallpt's box at a grazing angle of 1e-2",
        run: |trials| known(trials, "wall-floor-grazing 1e-2", None),
    },
    Case {
        id: "S04",
        tries: "the back wall of smallpt's box from its camera",
        run: |trials| known(trials, "wall-back-from-camera", None),
    },
    Case {
        id: "S05",
        tries: "a unit sphere 1e3 away",
        run: |trials| known(trials, "haines fig: unit sphere at 1000", None),
    },
    Case { id: "S06", tries: "a unit sphere 1e5 away", run: |trials| known(trials, "unit sphere at 1e5", None) },
    Case {
        id: "S07",
        tries: "a unit sphere 1e8 away: b² - |f|² + r² loses r²",
        run: |trials| known(trials, "unit sphere at 1e8", Some(0.13)),
    },
    Case { id: "S08", tries: "a sphere of 1e-6 at 1", run: |trials| known(trials, "r=1e-6 at 1", Some(1e-11)) },
    Case { id: "S09", tries: "a sphere of 1e-6 at 100", run: |trials| known(trials, "r=1e-6 at 100", Some(1e-7)) },
    Case {
        id: "S10",
        tries: "from within a sphere of 1e8, 1 from its surface",
        run: |trials| known(trials, "r=1e8 from inside near surf", None),
    },
    Case {
        id: "S19",
        tries: "a direction of length 3, where smallpt takes |d|² for 1",
        run: |trials| known(trials, "non-unit d x3", Some(0.5)),
    },
    Case { id: "S20", tries: "a direction of length 1e-20", run: |trials| known(trials, "non-unit d 1e-20", None) },
];

const ORACLE: &str = include_str!("../../data/sphere-oracle.json");

/// Checks that every implementation finds the roots of this ray within the bound. `smallpt_is_off` is a lower bound on
/// the error of smallpt's formula, if it is wrong there: otherwise the case could not tell the two apart.
fn known(trials: &mut Trials, name: &str, smallpt_is_off: Option<f64>) {
    let rows: Vec<Value> = serde_json::from_str(ORACLE).expect("the oracle's file");
    let row = rows.iter().find(|row| row["name"] == name).expect("a row of that name");
    let vector = |field: &str| Vec3::from([0, 1, 2].map(|k| row[field][k].as_f64().expect("a number")));
    let root = |field: &str| row[field].as_str().and_then(|digits| digits.parse::<f64>().ok()).expect("a root");
    let (o, d, c, r) = (vector("o"), vector("d"), vector("c"), row["r"].as_f64().expect("a radius"));
    let (f, expected) = (o - c, [root("t0"), root("t1")]);
    let exact = Exact::of(f, d, r);
    let bounds = expected.map(|t| exact.bound(f, d, r, t));
    for formula in FORMULAS {
        let (near, far) = (formula.roots)(f, d, dot(d, d), r);
        trials.close(format!("nearer root, {}", formula.name), expected[0], near, bounds[0]);
        trials.close(format!("farther root, {}", formula.name), expected[1], far, bounds[1]);
    }
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
