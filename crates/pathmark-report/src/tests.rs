use super::block::Block;
use super::contenders::contenders;
use super::figures::{FIGURES, blocks, check_figures};
use super::page::table::Table;
use super::results::Results;
use crate::error::Error;
use crate::experiment::{Definition, RunFile, experiments};
use crate::lab::Lab;
use crate::measure::{Record, SCHEMA, SETTINGS, Setting};
use serde_json::Value;
use std::cell::Cell;
use std::collections::BTreeSet;
use tempfile::TempDir;

thread_local!(static PASSES: Cell<usize> = const { Cell::new(0) });

/// Called at the beginning of each pass of a figure over the rows.
pub(super) fn count_pass() {
    PASSES.set(PASSES.get() + 1);
}

fn definition(figures: &[&str], more: &str) -> String {
    let axes = "[matrix]\nscene = [\"cornell\"]\nestimator = [\"bsdf\", \"nee\"]\nspp = [4]\nseed = [1]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\n";
    let sizes = "[quick]\nsize = [8, 6]\nrepetitions = 1\n[full]\nsize = [8, 6]\nrepetitions = 1\n";
    format!("title = \"\"\nquestion = \"\"\nanalysis = \"\"\nfigures = {figures:?}\n{more}\n{axes}{sizes}")
}

/// A row of sixteen jobs that took a second.
pub(super) fn row() -> Record {
    let word = |word: &str| word.to_string();
    Record {
        schema: SCHEMA,
        scene: word("cornell"),
        scene_hash: word("0"),
        effects: word("smallpt"),
        width: 8,
        height: 6,
        spp: 4,
        seed: 1,
        estimator: word("bsdf"),
        sampler: word("independent"),
        kernel: word("scalar"),
        precision: word("f64"),
        accelerator: word("none"),
        roulette: word("albedo:5"),
        decomposition: word("tiles:2x2"),
        strategy: word("serial"),
        output: word("slots"),
        threads: 1,
        jobs: 16,
        workers_used: Some(1),
        makespan_s: Some(1.0),
        cpu_user_s: Some(1.0),
        cpu_system_s: Some(0.0),
        busy_sum_s: Some(1.0),
        samples: Some(192),
        rays: Some(500),
        mse: Some(0.01),
        mean_radiance: Some(0.5),
        ..Record::default()
    }
}

/// A folder of results with the rows of `an-experiment`, as a sweep leaves it; each row gets its own cell.
pub(super) fn folder_of(figures: &[&str], more: &str, rows: Vec<Record>) -> TempDir {
    let out = tempfile::tempdir().unwrap();
    let folder = out.path().join("an-experiment");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("experiment.toml"), definition(figures, more)).unwrap();
    let mut run = RunFile::of_now("pathmark run".to_string());
    run.machine.processors = 2;
    run.write(&folder.join("machine.toml")).unwrap();
    let mut file = csv::Writer::from_path(folder.join("records.csv")).unwrap();
    for (index, row) in rows.into_iter().enumerate() {
        let cell = if row.cell.is_empty() { format!("cell {index}") } else { row.cell.clone() };
        file.serialize(Record { cell, ..row }).unwrap();
    }
    file.flush().unwrap();
    out
}

/// The rows read back.
pub(super) fn results(figures: &[&str], more: &str, rows: Vec<Record>) -> crate::error::Result<Results> {
    let out = folder_of(figures, more, rows);
    Results::read(&Lab::built_in(), out.path(), &out.path().join("an-experiment"))
}

/// The text of all blocks.
pub(super) fn words(blocks: &[Block]) -> String {
    let of = |block: &Block| match block {
        Block::Finding(text) | Block::Answer { text, .. } | Block::Notice(text) => text.clone(),
        Block::Figure { figure, .. } => figure.svg().unwrap(),
        Block::Picture { title, .. } => title.clone(),
        Block::Table { table, .. } => table.rows().flatten().collect::<Vec<String>>().join("\n"),
    };
    blocks.iter().map(of).collect::<Vec<_>>().join("\n")
}

/// The figure of that name.
pub(super) fn svg(blocks: &[Block], name: &str) -> String {
    let figure = blocks.iter().find_map(|block| match block {
        Block::Figure { stem, figure } if *stem == name => Some(figure.svg().unwrap()),
        _ => None,
    });
    figure.unwrap()
}

/// The first table.
pub(super) fn table(blocks: &[Block]) -> &Table {
    blocks.iter().find_map(|block| if let Block::Table { table, .. } = block { Some(table) } else { None }).unwrap()
}

#[test]
fn rows_that_nothing_tells_apart_are_refused() {
    let twice = || vec![Record { cell: "one".to_string(), ..row() }, Record { cell: "other".to_string(), ..row() }];
    let Err(Error::Input(error)) = results(&["speedup"], "", twice()).map(|_| ()) else { panic!("accepted") };
    assert_eq!((error.field.as_str(), error.value.as_str()), ("cell", "other"));
    assert!(error.problem.contains("one") && error.to_string().contains("records.csv:3"), "{error}");
    // A row that failed is ignored, so it does not conflict with another.
    let mut rows = twice();
    rows[1].error = "killed".to_string();
    assert!(results(&["speedup"], "", rows).is_ok());
}

/// The row with another value of a setting.
fn changed(setting: &Setting, row: &Record) -> Record {
    let column = setting.columns().next().unwrap();
    let mut columns = serde_json::to_value(row).unwrap();
    let other = match &columns[column] {
        Value::Bool(own) => Value::from(!own),
        Value::Number(own) => Value::from(own.as_u64().unwrap() + 1),
        Value::String(own) => Value::from(format!("{own}-other")),
        _ => Value::from(7),
    };
    columns[column] = other;
    serde_json::from_value(columns).unwrap()
}

#[test]
fn speedups_compare_the_same_image_with_every_setting() {
    for setting in SETTINGS.iter().filter(|setting| setting.changes_image) {
        // Two images, one of which takes a hundred times as long; the pool renders each twice as fast as serial.
        let mut rows = Vec::new();
        for (repetition, slow) in [(0, false), (1, false), (0, true), (1, true)] {
            for (strategy, threads, seconds) in [("serial", 1, 2.0), ("pool", 2, 1.0)] {
                let mut row = Record { repetition, threads, strategy: strategy.to_string(), ..row() };
                row.makespan_s = Some(if slow { 100.0 * seconds } else { seconds });
                rows.push(if slow { changed(setting, &row) } else { row });
            }
        }
        let results = results(&["speedup"], "", rows).unwrap();
        let found = results.serial().unwrap().speedups();
        assert_eq!(found.len(), 1, "{}", setting.name);
        let (value, interval) = (found[0].1.value, found[0].1.interval);
        assert_eq!((value, interval.low, interval.high), (2.0, 2.0, 2.0), "{}", setting.name);
    }
}

/// Two threads on a fast core and one of half its speed use one and a half cores.
#[test]
fn efficiency_counts_slow_cores_by_their_capacity() {
    let row = |repetition: u32, strategy: &str, threads: usize, seconds: f64| {
        let strategy = strategy.to_string();
        Record { repetition, strategy, threads, makespan_s: Some(seconds), ..row() }
    };
    let rows = (0..2).flat_map(|repetition| [row(repetition, "serial", 1, 3.0), row(repetition, "pool", 2, 2.0)]);
    let mut results = results(&["speedup"], "", rows.collect()).unwrap();
    let kinds = serde_json::json!([{"capacity": 1024, "processors": "1"}, {"capacity": 512, "processors": "0"}]);
    let efficiency = |results: &Results| {
        let blocks = blocks(results).unwrap();
        let table = table(&blocks);
        let place = table.heads().position(|head| head == "efficiency per processor in use").unwrap();
        table.rows().map(|row| row[place].clone()).collect::<Vec<_>>()
    };
    results.run.machine.layout = serde_json::from_value(serde_json::json!({})).unwrap();
    assert_eq!(efficiency(&results), ["0.750"]);
    results.run.machine.layout = serde_json::from_value(serde_json::json!({"allowed": "0-1", "kinds": kinds})).unwrap();
    assert_eq!(efficiency(&results), ["1.000"]);
}

#[test]
fn contenders_are_told_apart_by_every_setting_with_a_label() {
    // Each scene has its own contenders.
    for setting in SETTINGS.iter().filter(|setting| setting.is_label() && setting.name != "scene") {
        let mut rows = Vec::new();
        for (seed, spp) in [(1, 4), (1, 8), (2, 4), (2, 8), (3, 4), (3, 8)] {
            let mut plain = Record { spp, seed, pilot_s: Some(0.0), ..row() };
            plain.mse = Some(0.1 / f64::from(spp) * (1.0 + seed as f64));
            plain.makespan_s = Some(f64::from(spp) * (1.0 + 0.1 * seed as f64));
            rows.extend([changed(setting, &plain), plain]);
        }
        let results = results(&["price-list"], "", rows).unwrap();
        let names: BTreeSet<String> = contenders(&results).unwrap().into_values().flatten().map(|c| c.name).collect();
        assert_eq!(names.len(), 2, "{}: {names:?}", setting.name);
    }
}

/// The pilot that distributes adaptive samples counts as rendering time; the pilot that orders pieces does not.
#[test]
fn the_pilot_of_adaptive_samples_is_paid_for() {
    let even = Record { makespan_s: Some(2.0), pilot_s: Some(1.0), ..Record::default() };
    assert_eq!(even.rendering_s(), Some(2.0));
    let adaptive = Record { adaptive: true, ..even };
    assert_eq!(adaptive.rendering_s(), Some(3.0));
    assert_eq!(Record { makespan_s: None, ..adaptive }.rendering_s(), None);
}

/// Rows of `each` strategies, scenes and samplers, with names that the program does not know.
fn of_unknown_names(each: usize) -> Vec<Record> {
    let numbered = |name: &str, index: usize| format!("{name}-{index}");
    let mut rows = Vec::new();
    for (seed, index) in (1..=3).flat_map(|seed| (0..each).map(move |index| (seed, index))) {
        let names = Record { sampler: numbered("my-sampler", index), estimator: "my-estimator".to_string(), ..row() };
        let (mse, makespan_s) = (Some(0.01 * seed as f64), Some(1.0 + 0.1 * seed as f64));
        let image = Record { seed, makespan_s, mse, ..names };
        for strategy in ["serial", &numbered("my-pool", index)] {
            for scene in ["my-scene".to_string(), numbered("balls:1", index).replace('-', "")] {
                for (accelerator, output, effects) in
                    [("none", "slots", "smallpt"), ("my-tree", "my-output", "my-effects")]
                {
                    let word = |word: &str| word.to_string();
                    rows.push(Record {
                        scene: scene.clone(),
                        strategy: word(strategy),
                        threads: if strategy == "serial" { 1 } else { 2 },
                        accelerator: word(accelerator),
                        output: word(output),
                        effects: word(effects),
                        ..image.clone()
                    });
                }
            }
        }
    }
    rows
}

#[test]
fn unknown_names_are_drawn() {
    let shown = [
        ("speedup", &["my-pool-0", "my-pool-1"][..]),
        ("schedules", &["my-pool-0", "my-scene"]),
        ("clock", &["my-pool-1"]),
        ("granularity", &["my-pool-0"]),
        ("outputs", &["my-output"]),
        ("acceleration", &["my-tree"]),
        ("generators", &["my-sampler-0"]),
        ("time-against-spp", &["my-sampler-1"]),
        ("rmse-against-spp", &["my-sampler-1", "my-scene"]),
        ("price-list", &["my-estimator", "my-sampler-1"]),
        ("error-against-time", &["my-estimator"]),
    ];
    for (figure, names) in shown {
        let mut rows = of_unknown_names(2);
        if figure == "outputs" || figure == "acceleration" {
            // The figure compares one axis at a time.
            rows.retain(|row| row.effects == "smallpt");
            let other = |row: &Record| match figure {
                "outputs" => Record { output: "my-output".to_string(), ..row.clone() },
                _ => Record { accelerator: "my-tree".to_string(), ..row.clone() },
            };
            rows.extend(rows.clone().iter().map(other));
        }
        let results = results(&[figure], "", rows).unwrap();
        let text = words(&blocks(&results).unwrap());
        for name in names {
            assert!(text.contains(name), "{figure} does not show {name}: {text}");
        }
    }
}

/// An output that was tried on some pieces only has no rows for the others.
#[test]
fn outputs_are_told_only_where_they_were_tried() {
    let rows = Record { decomposition: "rows".to_string(), ..row() };
    let locked = Record { output: "locked".to_string(), makespan_s: Some(2.0), ..row() };
    let results = results(&["outputs"], "", vec![row(), rows, locked]).unwrap();
    let tables = blocks(&results).unwrap();
    let told: Vec<[String; 4]> =
        table(&tables).rows().map(|row| [0, 1, 3, 4].map(|column: usize| row[column].clone())).collect();
    let expected = [
        ["slots", "rows", "1000.000", "1.000, no interval"],
        ["slots", "tiles:2x2", "1000.000", "1.000, no interval"],
        // One repetition has no interval, so its ratio is not shown.
        ["locked", "tiles:2x2", "2000.000", "-"],
    ];
    assert_eq!(told, expected);
}

#[test]
fn no_figure_goes_through_the_rows_once_for_each_of_many_groups() {
    for entry in FIGURES {
        let passes = |each: usize| {
            let mut rows = of_unknown_names(each);
            if ["outputs", "acceleration", "kernels"].contains(&entry.name) {
                rows.retain(|row| row.effects == "smallpt");
            }
            let results = results(&[entry.name], "", rows).unwrap();
            PASSES.set(0);
            blocks(&results).unwrap();
            PASSES.get()
        };
        let (few, many) = (passes(2), passes(6));
        assert_eq!(few, many, "{}: three times the groups, and {many} instead of {few} passes", entry.name);
    }
}

/// A lamp that fills the display keeps its error in linear radiance, whatever the samples; its display value has none.
#[test]
fn errors_of_display_values_are_drawn_where_an_experiment_asks_for_them() {
    let at = |spp: u32, seed: u64| {
        let noise = 1.0 + 1e-3 * f64::from(spp % 7) * seed as f64;
        let (mse, mse_display) = (Some(4.0 * noise), Some(noise / f64::from(spp)));
        Record { spp, seed, mse, mse_display, cell: format!("{spp}/{seed}"), ..row() }
    };
    let rows: Vec<Record> = [4, 16, 64, 256].into_iter().flat_map(|spp| [at(spp, 1), at(spp, 2)]).collect();
    let told = |options: &str| {
        let results = results(&["rmse-against-spp"], options, rows.clone()).unwrap();
        words(&blocks(&results).unwrap())
    };
    let (linear, display) = (told(""), told("[figure.rmse-against-spp]\nvalues = \"display\""));
    assert!(linear.contains("power 0.00") || linear.contains("power -0.00"), "{linear}");
    assert!(display.contains("power -0.50") || display.contains("power -0.49"), "{display}");
    assert!(display.contains("RMSE, display values") && !linear.contains("RMSE, display values"));
    assert!(refusal(&["rmse-against-spp"], "[figure.rmse-against-spp]\nvalues = \"gamma\"").contains("display"));
}

/// A scene with a fault beside the right one: half of the light, and half of the pixels are black.
#[test]
fn variants_of_a_scene_are_compared_with_the_usual_one() {
    let of = |scene: &str, mean_radiance: f64, black_pixels: u64, seed: u64| Record {
        scene: scene.to_string(),
        scene_hash: scene.to_string(),
        mean_radiance: Some(mean_radiance),
        black_pixels: Some(black_pixels),
        seed,
        ..row()
    };
    let rows =
        vec![of("box", 0.5, 0, 1), of("box", 0.6, 0, 2), of("box-fault", 0.25, 24, 1), of("box-fault", 0.3, 24, 2)];
    let results = results(&["bias"], "[figure.bias]\naxis = \"scene\"\nusual = \"box\"", rows).unwrap();
    let tables = blocks(&results).unwrap();
    let told: Vec<[String; 4]> =
        table(&tables).rows().map(|row| [0, 1, 3, 6].map(|column: usize| row[column].clone())).collect();
    let expected = [["box", "box", "100.000", "0.000"], ["box", "box-fault", "50.000", "50.000"]];
    let told: Vec<[&str; 4]> =
        told.iter().map(|row| [0, 1, 2, 3].map(|k: usize| row[k].split(&[' ', ','][..]).next().unwrap())).collect();
    assert_eq!(told, expected);
}

fn refusal(figures: &[&str], more: &str) -> String {
    let text = definition(figures, more);
    let definition = Definition::from_text(&Lab::built_in(), "mine", "mine.toml", &text).unwrap();
    match check_figures(&definition) {
        Err(Error::Input(error)) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn options_that_a_figure_does_not_have_are_refused_at_their_line() {
    let cases = [
        ("[figure.forecast]\ncore = [2]", "mine.toml:6:1", "cores"),
        ("[figure.forecast]\ncores = [2, 0]", "mine.toml:6:", "nonzero"),
        ("[figure.forecast]\ncores = \"few\"", "mine.toml:6:", "few"),
        ("[figure.speedup]\nyardstick = \"serial\"", "mine.toml:6:1", "yardstick"),
        ("[figure.clock]\n", "mine.toml:5:1", "forecast, speedup"),
    ];
    for (more, place, word) in cases {
        let error = refusal(&["forecast", "speedup"], more);
        assert!(error.contains(place) && error.contains(word), "{more}: {error}");
    }
}

#[test]
fn options_reach_the_figure_of_any_experiment() {
    let rows = |strategy: &str| Record { strategy: strategy.to_string(), threads: 2, ..row() };
    let rows = (0..6).flat_map(|repetition| ["mine", "other"].map(|name| Record { repetition, ..rows(name) }));
    let results = results(&["openmp"], "[figure.openmp]\nyardstick = \"mine\"", rows.collect()).unwrap();
    let text = words(&blocks(&results).unwrap());
    assert!(text.contains("time / time of mine") && text.contains("other"), "{text}");
}

/// Six seeds, of which the wrong way takes twice the time and has three times the error; three of the rows are of pairs
/// whose later runs say nothing about the error.
#[test]
fn mistakes_are_told_by_time_and_by_error() {
    let rows = (0..6).flat_map(|seed| {
        let own = |sampler: &str, seconds: f64, error: f64| Record {
            seed,
            sampler: sampler.to_string(),
            threads: 2,
            makespan_s: Some(seconds),
            mean_radiance: Some(1.0 + error),
            ..row()
        };
        let error = if seed % 2 == 0 { 0.01 } else { -0.01 };
        [own("bad", 2.0, 3.0 * error), own("good", 1.0, error)]
    });
    let mut rows: Vec<Record> = rows.collect();
    for row in &mut rows[..6] {
        row.pair = Some(0);
    }
    let later = |row: &Record| Record { pair: Some(1), cell: String::new(), mean_radiance: Some(9.0), ..row.clone() };
    rows.extend(rows[..6].iter().map(later).collect::<Vec<_>>());
    let rows = rows.into_iter().map(|row| Record { cell: format!("{} {}", row.sampler, row.seed), ..row });
    let kind = |sampler: &str| format!("{{ sampler = \"{sampler}\", output = \"slots\" }}");
    let pair = format!("name = \"a mistake\"\nwrong = {}\nright = {}", kind("bad"), kind("good"));
    let options = format!("[figure.mistakes]\nknown = 1.0\n[[figure.mistakes.pair]]\n{pair}");
    let results = results(&["mistakes"], &options, rows.collect()).unwrap();
    let blocks = blocks(&results).unwrap();
    let row = table(&blocks).rows().next().unwrap();
    assert_eq!(row[..4], ["a mistake", "bad, slots", "good, slots", "2"]);
    // F(6, 6) has the quantile 5.820 at 0.975, so the interval is 3 over and times its root, 2.412.
    assert!(row[5].starts_with("2.000") && row[6].starts_with("3.00, 1.24 to 7.24"), "{row:?}");
    let text = words(&blocks);
    assert!(text.contains("The time grows most by a mistake: 2.00 times with 2 threads"), "{text}");
    assert!(text.contains("The error of the mean grows most by a mistake: 3.00 times with 2 threads"), "{text}");
    assert!(refusal(&["mistakes"], &options.replace("right", "rihgt")).contains("rihgt"));
}

#[test]
fn every_built_in_experiment_gives_its_figures_known_options() {
    for (name, text) in experiments() {
        let definition = Definition::from_text(&Lab::built_in(), name, &format!("{name}.toml"), text).unwrap();
        check_figures(&definition).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

/// Two strategies beside serial, six times.
fn speedup_rows() -> Vec<Record> {
    let times = [("serial", 1, 2.0), ("static-blocks", 2, 1.25), ("rayon", 2, 1.0)];
    let rows = (0..6).flat_map(|repetition| times.map(|time| (repetition, time)));
    let row = |(repetition, (strategy, threads, seconds)): (u32, (&str, usize, f64))| Record {
        repetition,
        strategy: strategy.to_string(),
        threads,
        makespan_s: Some(seconds),
        ..row()
    };
    rows.map(row).collect()
}

#[test]
fn the_page_begins_with_answers_and_with_the_findings_that_experiments_name() {
    let out = folder_of(&["speedup"], "chapter = \"scheduling\"\nin-short = 1", speedup_rows());
    let page = super::write(&Lab::built_in(), out.path()).unwrap();
    let html = std::fs::read_to_string(page).unwrap();
    let place = |text: &str| html.find(text).unwrap_or_else(|| panic!("the page lacks {text}"));
    let (start, short, chapter) = (place("<main"), place("id=\"answers\""), place("id=\"chapter-scheduling\""));
    assert!(start < short && short < chapter && chapter < place("id=\"an-experiment\""));
    assert!(
        html[short..chapter].contains("is 2.00 (2.00 to 2.00, 96.8 %) times as fast as serial"),
        "{}",
        &html[short..chapter]
    );
    assert!(html[short..chapter].contains("href=\"#an-experiment\""));
    // Chapters without a section are left out, and a finding that is an answer is told once.
    assert!(!html.contains("chapter-effects") && !html.contains("id=\"in-short\"") && !html.contains("#in-short"));
    // Figures without an answer leave the findings that `in-short` names.
    let out = folder_of(&["clock"], "in-short = 1", speedup_rows());
    let html = std::fs::read_to_string(super::write(&Lab::built_in(), out.path()).unwrap()).unwrap();
    assert!(
        !html.contains("id=\"answers\"") && html.contains("id=\"in-short\"") && html.contains("Timed with clock()")
    );
    // If `in-short` names a finding that does not exist, the page is written without that section.
    let out = folder_of(&["clock"], "in-short = 99", speedup_rows());
    let html = std::fs::read_to_string(super::write(&Lab::built_in(), out.path()).unwrap()).unwrap();
    assert!(!html.contains("id=\"in-short\"") && html.contains("<h2 id=\"chapter-others\">Experiments</h2>"));
}

/// A reader who points at a mark sees the row's value.
#[test]
fn figures_carry_the_values_that_they_draw() {
    let results = results(&["speedup"], "", speedup_rows()).unwrap();
    let blocks = blocks(&results).unwrap();
    let svg = svg(&blocks, "speedup");
    let note = |series: &str| {
        svg.lines().find(|line| line.contains("class=\"note\"") && line.contains(&format!("data-series=\"{series}\"")))
    };
    assert!(note("static-blocks").unwrap().contains("data-value=\"1.6\""), "{svg}");
    assert!(note("rayon").unwrap().contains("<title>rayon: 2 (2 to 2) at threads = 2</title>"), "{svg}");
    // Each series can be switched off at its legend entry.
    for series in ["rayon", "static-blocks"] {
        for class in ["series", "legend"] {
            assert!(svg.contains(&format!("<g class=\"{class}\" data-series=\"{series}\">")), "{class} {series}");
        }
    }
}
