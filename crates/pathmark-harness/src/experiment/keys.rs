//! The keys of an experiment's file, for `pathmark list keys`.

use super::table::REQUIRED;
use crate::measure::SETTINGS;

const KEYS: &[(&str, &str)] = &[
    ("title", "heading of its section [required]"),
    ("question", "question that it answers [required]"),
    ("figures", "names of `pathmark list figures` [required]"),
    ("analysis", "how to read the figures; empty lines separate paragraphs"),
    ("chapter", "chapter of the page: accuracy, scheduling, hard-inputs or effects"),
    ("place", "position among the chapter's experiments"),
    ("in-short", "number of the finding to list at the beginning of the page"),
    ("keep", "files to keep beside the rows: images, traces, calibration, messages"),
    ("unverified", "true: allows samplers that draw different random numbers in each run, so images have no checksum"),
    (
        "timeout",
        "time limit of each cell's process, as in \"10min\", or \"none\" [default: ten times its estimate, at least a minute]",
    ),
    ("requires", "optional features that the build must have: openmp, more-pools, lane-profiles"),
    ("matrix", "a table of axes, or several under [[matrix]]; cells are all combinations [required]"),
    ("matrix.weak", "true: weak scaling, spp is multiplied by the number of workers"),
    ("matrix.curve", "true: each render gives rows at 1, 2, 4 ... times the fewest samples, up to its spp"),
    ("matrix.repetitions", "largest number of repetitions of its cells [default: the profile's]"),
    ("matrix.profiles", "the profiles that use the matrix [default: all]"),
    ("compare", "what runs side by side, under [[compare]]"),
    ("compare.what", "cells, by the values of axes, as in { threads = [2] } [default: all cells]"),
    ("compare.with", "the cells that they are compared with, likewise [required]"),
    ("compare.goal", "half of the interval that each ratio of times should have, as in \"2 %\""),
    ("figure", "a table [figure.NAME] with the parameters of a figure"),
    ("reference", "a table: errors are measured against a reference"),
    ("reference.estimator", "estimator of the references"),
    ("reference.object", "also measures errors on the pixels of this object"),
    ("external", "another program to run beside the cells, under [[external]]"),
    (
        "quick",
        "the profile --quick: any axis, size, repetitions (a number, or { until = \"3 %\", at-most = 200, max-time = \"60 s\" }; until may be \"fastest\" or \"order\"; or { at-least = 16, at-most = 48, max-time = \"2 min\" }: more for comparisons that missed their goal), pairs (of each process, where cells are compared), reference-spp, timeout [default: 320x240, 6 repetitions]",
    ),
    ("full", "the profile --full, likewise"),
    ("reports", "the profile --reports, likewise"),
];

/// Axes whose option, if there is one, is not made from the list of settings.
const AXES: &[(&str, &str)] = &[
    ("scene", "Names of `pathmark list scenes` or `list workloads`, or paths of .toml files"),
    ("spp", "Samples per pixel"),
    ("seed", "Seeds of the random numbers"),
    ("clamp", "Clamps of bright light, as for `render --clamp`"),
    ("adaptive", "true: more samples where the noise is, as with `render --adaptive`"),
    ("time-limit", "Seconds of rendering after which a render stops"),
    ("ranks", "Numbers of processes, which MPI connects"),
    ("rank-rule", "Rules by which processes share the jobs, as for `render --ranks`"),
];

/// Key and meaning of all fields that an experiment's file may have.
pub fn keys() -> impl Iterator<Item = (String, String)> {
    let axes = SETTINGS.iter().map(|axis| {
        let own = AXES.iter().find(|(name, _)| *name == axis.name).map(|(_, about)| *about);
        let about = own.unwrap_or(axis.about);
        let is_required = REQUIRED.contains(&axis.name);
        // The option of a render has a default where an experiment must say what it compares.
        let required = || format!("{} [required]", about.split(" [default").next().unwrap_or_default());
        (format!("matrix.{}", axis.name), if is_required { required() } else { about.to_string() })
    });
    KEYS.iter().map(|(key, about)| ((*key).to_string(), (*about).to_string())).chain(axes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Definition;
    use crate::lab::Lab;
    use std::collections::BTreeSet;

    /// The error about an unknown key lists the keys that the parser knows.
    #[test]
    fn the_listed_keys_are_those_that_are_read() {
        let read = |text: &str| Definition::from_text(&Lab::built_in(), "x", "x.toml", text).unwrap_err().to_string();
        let told = read("mood = 1");
        let names = told.split('`').skip(1).step_by(2).filter(|name| *name != "mood");
        let listed: BTreeSet<&str> = KEYS.iter().map(|(key, _)| *key).filter(|key| !key.contains('.')).collect();
        assert_eq!(names.collect::<BTreeSet<&str>>(), listed, "{told}");
        let told = read("title = \"t\"\nquestion = \"q\"\nfigures = []\n[matrix]\nmood = 1");
        for (key, _) in keys().filter(|(key, _)| key.starts_with("matrix.")) {
            assert!(told.contains(&format!("`{}`", key.trim_start_matches("matrix."))), "{key}: {told}");
        }
    }

    #[test]
    fn every_axis_is_explained() {
        for (key, about) in keys() {
            assert!(!about.trim_end_matches("[required]").trim().is_empty(), "{key}");
            assert!(!(about.contains("[required]") && about.contains("[default")), "{key}: {about}");
        }
        let unknown = AXES.iter().find(|(name, _)| !SETTINGS.iter().any(|axis| axis.name == *name));
        assert_eq!(unknown, None);
    }

    #[test]
    fn names_of_figures_under_the_key_of_their_parameters_are_told_the_right_key() {
        let text = "title = \"t\"\nquestion = \"q\"\nfigure = [\"speedup\"]";
        let told = Definition::from_text(&Lab::built_in(), "x", "x.toml", text).unwrap_err().to_string();
        assert!(told.starts_with("x.toml:3:") && told.contains("did you mean `figures`"), "{told}");
    }

    #[test]
    fn missing_required_axes_are_named() {
        let matrix: Vec<String> = REQUIRED.iter().map(|axis| value(axis)).collect();
        for (index, axis) in REQUIRED.iter().enumerate() {
            let mut left = matrix.clone();
            left.remove(index);
            let text = format!("title = \"t\"\nquestion = \"q\"\nfigures = []\n[matrix]\n{}", left.join("\n"));
            let told = Definition::from_text(&Lab::built_in(), "x", "x.toml", &text).unwrap_err().to_string();
            assert!(told.contains(&format!("`{axis}`")), "{axis}: {told}");
        }
    }

    fn value(axis: &str) -> String {
        let value = if ["spp", "threads"].contains(&axis) { "1" } else { "\"rows\"" };
        format!("{axis} = [{value}]")
    }
}
