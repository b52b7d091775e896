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
