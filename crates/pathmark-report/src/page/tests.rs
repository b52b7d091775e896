use super::*;
use crate::experiment::EXTERNAL;
use crate::figures::blocks;
use crate::lab::Lab;
use crate::tests::{folder_of, row};

/// The section of an experiment with these figures and rows.
fn section_of(figures: &[&str], more: &str, rows: Vec<Record>) -> Section {
    let out = folder_of(figures, more, rows);
    let results = Results::read(&Lab::built_in(), out.path(), &out.path().join("an-experiment")).unwrap();
    let blocks = blocks(&results).unwrap();
    Section::of(results, blocks)
}

/// A notice says nothing about the measurements, so it is not among the findings, whatever their number.
#[test]
fn a_notice_is_no_finding() {
    let rows = || vec![row(), Record { repetition: 1, makespan_s: Some(2.0), ..row() }];
    let section = section_of(&["contact-sheet", "error-against-time"], "in-short = 1", rows());
    assert_eq!(section.in_short, None);
    let html = html(&[section]).unwrap();
    assert!(html.contains("<p class=\"notice\">There is no contact sheet"), "{html}");
    assert!(!html.contains("class=\"finding\"") && !html.contains("id=\"in-short\""), "{html}");
}

/// The rows of an older version name a scene file by its path where ours have its stem; its content joins them.
#[test]
fn other_programs_share_the_scene_of_our_rows() {
    let mut rows = Vec::new();
    for seed in [1, 2] {
        let (mse, makespan_s) = (Some(0.01 * seed as f64), Some(seed as f64));
        let row = || Record { seed, makespan_s, mse, ..row() };
        let hash = || "0123".to_string();
        rows.push(Record { scene: "room".to_string(), scene_hash: hash(), ..row() });
        let (sampler, strategy) = (EXTERNAL.to_string(), EXTERNAL.to_string());
        let (scene, estimator) = ("my/room.toml".to_string(), "other".to_string());
        rows.push(Record { scene, scene_hash: hash(), estimator, sampler, strategy, ..row() });
    }
    let section = section_of(&["pairs"], "", rows);
    let html = html(&[section]).unwrap();
    assert!(html.contains("bsdf takes 1.00 times the seconds of other"), "{html}");
}

/// With half of the times in doubt, figures are pale and say so.
#[test]
fn disturbed_figures_are_pale_and_say_so() {
    let page = |doubted: u32| {
        let runs = (0..6).flat_map(|repetition| [("serial", 1, 2.0), ("rayon", 2, 1.0)].map(|run| (repetition, run)));
        let rows = runs.map(|(repetition, (strategy, threads, seconds))| Record {
            repetition,
            strategy: strategy.to_string(),
            threads,
            makespan_s: Some(seconds),
            warnings: if repetition < doubted { "drift(+40 %)" } else { "" }.to_string(),
            ..row()
        });
        html(&[section_of(&["speedup"], "", rows.collect())]).unwrap()
    };
    let is_pale = |html: &str| html.contains("<figure class=\"disturbed\" id=\"an-experiment-speedup\">");
    let (half, fewer) = (page(3), page(2));
    assert!(is_pale(&half) && half.contains("Pale, because the times of 6 of 12 rows are in doubt."), "{half}");
    assert!(!is_pale(&fewer) && !fewer.contains("Pale, because"), "{fewer}");
}
