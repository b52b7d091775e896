//! Every figure and table on rows of two image sizes, and on cells of different numbers of repetitions.

use super::block::Block;
use super::figures::{FIGURES, blocks};
use super::results::Results;
use super::tests::{results, row, svg, table, words};
use crate::measure::Record;

/// How many times as long the second image takes as the first.
#[derive(Clone, Copy)]
struct Scales {
    /// Factor of the times of all rows.
    all: f64,
    /// Factor of the times of the second size.
    second_size: f64,
    /// Factor of the times from each repetition to the next.
    drift: f64,
}

/// Powers of two: they scale times without rounding, so a ratio that is right does not change in any bit.
const PLAIN: Scales = Scales { all: 1.0, second_size: 1.0, drift: 1.0 };

/// Rows of two sizes: serial, two strategies on two threads, on one thread, two samplers, kernels, outputs, profiles and
/// accelerators, each at three numbers of samples, three seeds and three repetitions. `axis` gives the variants of a row
/// that the figure compares.
fn rows_of(scales: Scales, variants: &[fn(&mut Record)]) -> Vec<Record> {
    let mut rows = Vec::new();
    for (index, (width, factor)) in [(8, 1.0), (16, scales.second_size)].into_iter().enumerate() {
        for (seed, spp, repetition) in (1..=3u64)
            .flat_map(|seed| [4, 8, 16].map(|spp| (seed, spp)))
            .flat_map(|(seed, spp)| (0..3u32).map(move |repetition| (seed, spp, repetition)))
        {
            let drift = (0..repetition).fold(1.0, |product, _| product * scales.drift);
            for (place, variant) in variants.iter().enumerate() {
                let mut own = Record { width, spp, seed, repetition, ..row() };
                variant(&mut own);
                // Times per sample differ by variant, seed and size, and a little by the number of samples.
                let uneven = 0.3 * place as f64 + 0.01 * seed as f64 + 0.02 * index as f64 + 0.07 * f64::from(spp % 7);
                let seconds = f64::from(spp) * (1.0 + uneven) * (scales.all * factor * drift);
                own.makespan_s = Some(seconds);
                own.cpu_user_s = Some(seconds * own.threads as f64);
                own.cpu_system_s = Some(0.0);
                own.busy_sum_s = Some(seconds);
                own.busy_max_s = Some(seconds);
                own.job_max_s = Some(seconds);
                own.idle_between_jobs_s = Some(seconds / 16.0);
                own.merge_s = Some(seconds / 32.0);
                own.mse = Some(0.1 / f64::from(spp) * (1.0 + 0.1 * seed as f64));
                rows.push(own);
            }
        }
    }
    rows
}

fn pool(row: &mut Record) {
    (row.strategy, row.threads) = ("pool".to_string(), 2);
}

fn serial(_: &mut Record) {}

/// The variants that a figure compares.
fn variants(figure: &str) -> Vec<fn(&mut Record)> {
    let mut variants: Vec<fn(&mut Record)> = vec![serial, pool];
    match figure {
        "outputs" | "mistakes" => variants.push(|row| {
            pool(row);
            row.output = "locked".to_string();
        }),
        "acceleration" => variants.extend([
            (|row: &mut Record| row.accelerator = "sah".to_string()) as fn(&mut Record),
            |row| row.scene = "balls:100".to_string(),
            |row| (row.scene, row.accelerator) = ("balls:100".to_string(), "sah".to_string()),
        ]),
        "kernels" | "precision" => variants.push(|row| row.precision = "f32".to_string()),
        "effects" | "baselines" => variants.push(|row| row.effects = "all".to_string()),
        "roughness" => variants.push(|row| row.scene = "cornell-vndf".to_string()),
        "generators" => variants.extend([
            (|row: &mut Record| row.sampler = "libc-rand".to_string()) as fn(&mut Record),
            |row| {
                pool(row);
                row.sampler = "libc-rand".to_string();
            },
            |row| (row.strategy, row.threads) = ("pool".to_string(), 1),
        ]),
        "estimators" | "pairs" | "price-list" | "error-against-time" | "rmse-against-time" => {
            variants.push(|row| row.estimator = "nee".to_string());
        }
        "roulette" => variants.push(|row| row.roulette = "albedo:2".to_string()),
        "bias" => variants.push(|row| row.epsilon = "fixed:0.1".to_string()),
        "clamp-bias" => variants.push(|row| row.clamp = "subpixel".to_string()),
        "bounces" => variants.extend([
            (|row: &mut Record| (row.max_depth, row.mean_radiance) = (Some(0), Some(0.125))) as fn(&mut Record),
            |row| (row.max_depth, row.mean_radiance) = (Some(1), Some(0.25)),
        ]),
        "oversubscription" => {
            variants = vec![
                serial,
                |row| (row.strategy, row.threads, row.decomposition) = ("pool".into(), 16, "grid:16".into()),
                |row| (row.strategy, row.threads, row.decomposition) = ("few".into(), 2, "grid:16".into()),
                |row| {
                    (row.strategy, row.threads, row.decomposition) = ("pool".into(), 4, "grid:4".into());
                    row.jobs = 4;
                },
            ];
        }
        "granularity" => variants.extend([
            (|row: &mut Record| (row.decomposition, row.jobs) = ("rows".into(), 6)) as fn(&mut Record),
            |row| {
                pool(row);
                (row.decomposition, row.jobs) = ("rows".into(), 6);
            },
            |row| (row.strategy, row.threads) = ("team".to_string(), 2),
        ]),
        "openmp" => variants.extend([
            (|row: &mut Record| (row.strategy, row.threads) = ("openmp-dynamic".to_string(), 2)) as fn(&mut Record),
            |row| (row.strategy, row.threads) = ("team".to_string(), 2),
        ]),
        _ => variants.extend([
            (|row: &mut Record| (row.strategy, row.threads) = ("pool".to_string(), 1)) as fn(&mut Record),
            |row| (row.strategy, row.threads) = ("team".to_string(), 2),
            |row| (row.strategy, row.threads) = ("team".to_string(), 4),
        ]),
    }
    variants
}

/// Options that give a figure its findings.
fn options(figure: &str) -> &'static str {
    match figure {
        "generators" => "[figure.generators]\ncompare = { shared = \"libc-rand\", own = \"independent\" }",
        "granularity" => "[figure.granularity]\ncompare = [\"pool\", \"team\"]",
        "oversubscription" => {
            "[figure.oversubscription.claim]\nper-section = \"pool\"\nfew = \"few\"\nsections = [16, 49]\nagainst = \"grid:4\""
        }
        "effects" => {
            "[[figure.effects.price]]\neffect = \"all\"\nabsent = { scene = \"cornell\", profile = \"smallpt\" }\nunused = { scene = \"cornell\", profile = \"all\" }\nused = { scene = \"cornell\", profile = \"all\" }"
        }
        "mistakes" => {
            "[figure.mistakes]\nknown = 1.0\n[[figure.mistakes.pair]]\nname = \"a lock\"\nwrong = { sampler = \"independent\", output = \"locked\" }\nright = { sampler = \"independent\", output = \"slots\" }"
        }
        _ => "",
    }
}

fn of(figure: &str, rows: Vec<Record>) -> Results {
    results(&[figure], options(figure), rows).unwrap()
}

/// The words of findings, tables, and values that a figure carries; without drawing, whose axes follow the values.
fn told(results: &Results) -> Vec<String> {
    let text = |block: &Block| match block {
        Block::Figure { figure, .. } => {
            let svg = figure.svg().unwrap();
            let notes = svg.lines().filter(|line| line.contains("class=\"note\""));
            let titles = notes.filter_map(|line| line.split("<title>").nth(1)?.split("</title>").next());
            titles.collect::<Vec<&str>>().join(" ; ")
        }
        other => words(std::slice::from_ref(other)),
    };
    let separators = |c: char| c.is_whitespace() || "(),:;=".contains(c);
    let words = blocks(results).unwrap().iter().map(text).collect::<Vec<String>>().join(" ");
    words.split(separators).filter(|word| !word.is_empty()).map(str::to_string).collect()
}

/// The numbers that do not change if all times get longer: ratios of times, and numbers that are no times.
fn dimensionless(figure: &str, scales: Scales) -> Vec<String> {
    let variants = variants(figure);
    let [own, longer] = [1.0, 1024.0].map(|all| told(&of(figure, rows_of(Scales { all, ..scales }, &variants))));
    assert_eq!(own.len(), longer.len(), "{figure}: longer times change the number of words");
    let same = own.into_iter().zip(longer).filter(|(a, b)| a == b).map(|(word, _)| word);
    // A rate that rounds to zero does not change either.
    let is_number = |word: &String| word.trim_end_matches('.').parse::<f64>().is_ok_and(|number| number != 0.0);
    let mut numbers: Vec<String> = same.filter(is_number).collect();
    numbers.sort();
    numbers
}

/// A ratio of two images would be 32 times as large; one of two repetitions would follow the drift.
#[test]
fn no_figure_compares_two_images_or_two_repetitions() {
    let mut silent = Vec::new();
    for entry in FIGURES {
        let plain = dimensionless(entry.name, PLAIN);
        let larger = dimensionless(entry.name, Scales { second_size: 32.0, ..PLAIN });
        assert_eq!(plain, larger, "{}: a second size that takes 32 times as long changes ratios", entry.name);
        // The self-test compares successive repetitions.
        if entry.name != "self-test" {
            let drifting = dimensionless(entry.name, Scales { drift: 4.0, ..PLAIN });
            assert_eq!(plain, drifting, "{}: times that drift between repetitions change ratios", entry.name);
        }
        if plain.is_empty() {
            silent.push(entry.name);
        }
    }
    // These show pictures, traces or other files beside the rows.
    let of_files = [
        "contact-sheet",
        "equal-time",
        "timelines",
        "cost-map",
        "forecast",
        "ranks-forecast",
        "message-costs",
        "gallery",
        "scene-accuracy",
        "precision",
    ];
    assert_eq!(silent, of_files, "figures that show no ratio");
}

/// Serial runs and two strategies. A drift that begins at the third repetition halves the speedups; `early` has no
/// later repetitions and is slower than `late` in each that both have.
fn drifting() -> Vec<Record> {
    let mut rows = Vec::new();
    for repetition in 0..12 {
        let drift = if repetition < 3 { 1.0 } else { 2.0 };
        for (strategy, threads, seconds) in [("serial", 1, 8.0), ("late", 2, 4.0 * drift), ("early", 2, 5.0 * drift)] {
            if strategy == "early" && repetition >= 3 {
                continue;
            }
            for (effects, factor) in [("smallpt", 1.0), ("all", 1.25)] {
                rows.push(Record {
                    repetition,
                    threads,
                    strategy: strategy.to_string(),
                    effects: effects.to_string(),
                    makespan_s: Some(factor * seconds),
                    cpu_user_s: Some(factor * seconds),
                    ..row()
                });
            }
        }
    }
    rows
}

/// `early` has a median speedup of 1.6 and `late` one of 1, but in the same repetitions `late` is faster.
#[test]
fn cells_with_fewer_repetitions_are_hollow_and_not_ranked() {
    let rows = || drifting().into_iter().filter(|row| row.effects == "smallpt");
    let results = results(&["speedup", "clock"], "", rows().collect()).unwrap();
    let found = results.serial().unwrap().speedups();
    let found: Vec<_> = found.iter().map(|(own, ratio)| (&*own.name, ratio.value, ratio.is_partial)).collect();
    assert_eq!(found, [("early", 1.6, true), ("late", 1.0, false)]);
    let blocks = blocks(&results).unwrap();
    let finding = blocks.iter().find_map(Block::as_finding).unwrap();
    // Paired with `late`, `early` takes 1.25 times as long in the repetitions that both have.
    assert!(finding.contains("is that of late: 1.000 times serial"), "{finding}");
    assert!(finding.contains("1 of 1 others take longer, early the longest: 1.250 (1.250"), "{finding}");
    assert!(svg(&blocks, "speedup").contains("Hollow:"));
    let clock = words(&blocks[blocks.len() - 2..]);
    assert!(
        clock.contains("Timed with clock() of the C library") && clock.contains("a speedup of 1.00 (median"),
        "{clock}"
    );
    assert_eq!(clock.matches("not comparable").count(), 1, "{clock}");
}

/// Two schedules that each lack another repetition, as after two failures, are compared over those that both have.
#[test]
fn cells_that_each_lack_a_repetition_are_compared() {
    let repeated = drifting().into_iter().filter(|row| row.effects == "smallpt" && row.strategy != "early");
    let (serial, late): (Vec<Record>, Vec<Record>) = repeated.partition(|row| row.strategy == "serial");
    let other = late.iter().map(|row| Record { strategy: "rayon".to_string(), ..row.clone() });
    let last = late.iter().map(|row| row.repetition).max().unwrap();
    let late = late.iter().filter(|row| row.repetition != 0).cloned();
    let rows = serial.into_iter().chain(late).chain(other.filter(|row| row.repetition != last));
    let results = results(&["speedup"], "", rows.collect()).unwrap();
    let found: Vec<_> = results.serial().unwrap().speedups().into_iter().map(|(_, ratio)| ratio).collect();
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|ratio| !ratio.is_partial && ratio.count == Some(last as usize - 1)), "{found:?}");
}

/// In the other figures that rank, too, the first place goes to `late`.
#[test]
fn no_figure_ranks_a_cell_with_fewer_repetitions() {
    let sentence = |figure: &str, more: &str, rows: Vec<Record>| {
        let results = results(&[figure], more, rows).unwrap();
        let blocks = blocks(&results).unwrap();
        assert!(words(&blocks).contains("Hollow:"), "{figure}");
        blocks.iter().filter_map(Block::as_finding).collect::<Vec<&str>>().join("\n")
    };
    let plain = || drifting().into_iter().filter(|row| row.effects == "smallpt").collect::<Vec<Record>>();
    let mut against = plain();
    // A yardstick with a drift of its own: over all its repetitions `late` takes twice its time, `early` 1.25 times.
    against.extend(plain().into_iter().filter(|row| row.strategy == "serial").map(|row| Record {
        strategy: "openmp-dynamic".to_string(),
        threads: 2,
        makespan_s: Some(4.0),
        ..row
    }));
    let openmp = sentence("openmp", "", against);
    assert!(openmp.contains("strategies is late: 2.000 times"), "{openmp}");
    let baselines = sentence("baselines", "", drifting());
    assert!(
        baselines.contains("late on 2 threads, effects smallpt over serial, effects all: 1.25 times"),
        "{baselines}"
    );
    assert!(!baselines.contains("early"), "{baselines}");
    assert_eq!(sentence("granularity", "", plain()), "");
}

/// Points of a line that show other images are compared over their common repetitions, too: the drift that begins at
/// the third repetition would bend a line whose last point has no such repetition.
#[test]
fn no_line_joins_points_of_other_repetitions() {
    let of = |repetitions: u32, shape: fn(&mut Record)| {
        (0..repetitions).map(move |repetition| {
            let mut own = Record { repetition, ..row() };
            shape(&mut own);
            own
        })
    };
    let drift = |row: &Record| if row.repetition < 3 { 1.0 } else { 2.0 };
    let blocks_of = |figure: &str, rows: Vec<Record>| blocks(&results(&[figure], "", rows).unwrap()).unwrap();
    let is_hollow = |svg: String| svg.contains("Hollow:");

    // Weak scaling: each number of threads renders an image of its own.
    let weak = |last: u32| {
        let mut rows = Vec::new();
        for (spp, repetitions) in [(4, 12), (8, 12), (16, last)] {
            let threads = spp as usize / 4;
            let seconds = f64::from(spp);
            rows.extend(of(repetitions, |_| ()).map(|row| Record { spp, makespan_s: Some(seconds), ..row }));
            rows.extend(of(repetitions, pool).map(|row| {
                let makespan_s = Some(seconds / threads as f64 * drift(&row));
                Record { spp, threads, makespan_s, ..row }
            }));
        }
        svg(&blocks_of("weak-scaling", rows), "weak-scaling")
    };
    assert!(!is_hollow(weak(12)));
    assert!(is_hollow(weak(3)));

    // Acceleration: each number of spheres is a scene of its own, and each number of samples an image.
    let accelerated = |last: u32| {
        let mut rows = Vec::new();
        for (place, spp, repetitions) in [(10, 4, 12), (100, 8, 12), (1000, 16, last)] {
            for (accelerator, seconds) in [("none", 8.0), ("sah", 4.0)] {
                let own = |row: Record| {
                    let drift = if accelerator == "sah" { drift(&row) } else { 1.0 };
                    let (accelerator, makespan_s) = (accelerator.to_string(), Some(seconds * drift));
                    Record { accelerator, makespan_s, rays: Some(1000), ..row }
                };
                rows.extend(of(repetitions, |_| ()).map(|row| own(Record { spp, ..row })));
                rows.extend(of(repetitions, |_| ()).map(|row| own(Record { scene: format!("balls:{place}"), ..row })));
            }
        }
        blocks_of("acceleration", rows)
    };
    let (whole, partial) = (accelerated(12), accelerated(3));
    for name in ["acceleration", "acceleration-spp"] {
        assert!(!is_hollow(svg(&whole, name)), "{name}");
        assert!(is_hollow(svg(&partial, name)), "{name}");
    }
    // Over all repetitions the gain is 1; only the point of three repetitions, which is not ranked, has 2.
    let findings = |blocks: &[Block]| blocks.iter().filter_map(Block::as_finding).collect::<Vec<_>>().join("\n");
    assert!(findings(&whole).contains("at 1000 spheres"), "{}", findings(&whole));
    assert!(findings(&partial).contains("at 100 spheres"), "{}", findings(&partial));
    let gains = |blocks: &[Block]| {
        let table = blocks.iter().find_map(|block| match block {
            Block::Table { stem: "acceleration-gains", table } => Some(table),
            _ => None,
        });
        let rows = table.unwrap().rows().filter(|row| row[0].ends_with(" spp"));
        rows.map(|row| (row[0].clone(), row[2].split(',').next().unwrap().to_string(), row[3].is_empty())).collect()
    };
    let at = |spp: u32, gain: &str, is_whole: bool| (format!("cornell, 8x6, {spp} spp"), gain.to_string(), is_whole);
    let found: Vec<(String, String, bool)> = gains(&partial);
    assert_eq!(found, [at(4, "1.00", true), at(8, "1.00", true), at(16, "2.00", false)]);

    // Error against time: each number of samples is an image.
    let priced = |last: u32| {
        let mut rows = Vec::new();
        for (spp, repetitions) in [(4, 12), (8, 12), (16, last)] {
            let of_spp = |row: Record| {
                let (makespan_s, mse) = (Some(f64::from(spp) * drift(&row)), Some(1.0 / f64::from(spp)));
                Record { spp, makespan_s, mse, ..row }
            };
            rows.extend(of(repetitions, |_| ()).map(of_spp));
        }
        svg(&blocks_of("rmse-against-time", rows), "rmse-against-time")
    };
    assert!(!is_hollow(priced(12)));
    assert!(is_hollow(priced(3)));
}

/// Prices of effects come from groups of cells with seeds of their own, and some have more processes than others: all count,
/// and the dearest effect, in the group of the most processes, is the title's.
#[test]
fn prices_of_effects_count_all_processes_of_their_groups() {
    let mut rows = Vec::new();
    for (seed, processes, effects, factor) in [(1, 4, "lens", 1.25), (2, 4, "fog", 1.125), (3, 7, "all", 1.5)] {
        for (repetition, pair) in (0..processes).flat_map(|process| [0, 1].map(|pair| (process, pair))) {
            let noise = 1.0 + 0.01 * f64::from(repetition % 3);
            for (effects, seconds) in [("smallpt", 1.0), (effects, factor * noise)] {
                let own = Record { seed, repetition, pair: Some(pair), effects: effects.to_string(), ..row() };
                rows.push(Record { cpu_user_s: Some(seconds), cpu_system_s: Some(0.0), ..own });
            }
        }
    }
    let price = |profile: &str| {
        format!(
            "[[figure.effects.price]]\neffect = \"{profile}\"\nabsent = {{ scene = \"cornell\", profile = \"smallpt\" }}\n\
             unused = {{ scene = \"cornell\", profile = \"{profile}\" }}\n\
             used = {{ scene = \"cornell\", profile = \"{profile}\" }}\n"
        )
    };
    let prices = ["lens", "fog", "all"].map(price).concat();
    let blocks = blocks(&results(&["effects"], &prices, rows).unwrap()).unwrap();
    let drawing = svg(&blocks, "effects");
    assert!(!drawing.contains("Hollow:"), "{drawing}");
    assert!(drawing.contains("An unused effect costs up to 51"), "{drawing}");
    let told = table(&blocks).rows().map(|row| row[row.len() - 2..].to_vec()).collect::<Vec<_>>();
    assert_eq!(told, [["4", "4"], ["4", "4"], ["7", "7"]]);
}

/// Times of two images have no common order: the typical run is one of the image with the most runs.
#[test]
fn the_typical_run_is_of_one_image() {
    let times = [(8, 1.0), (8, 2.0), (8, 3.0), (16, 100.0), (16, 200.0)];
    let rows = (0..).zip(times).map(|(repetition, (width, seconds))| Record {
        repetition,
        width,
        makespan_s: Some(seconds),
        ..row()
    });
    let results = results(&["schedules"], "", rows.collect()).unwrap();
    let all: Vec<_> = results.rows().collect();
    assert_eq!(Results::typical(&all).and_then(|row| row.makespan_s), Some(2.0));
}

/// A case that a search through all schedules for each schedule would hardly finish.
#[test]
fn many_strategies_are_compared() {
    let mut rows = Vec::new();
    for (repetition, index) in (0..2).flat_map(|repetition| (0..2000).map(move |index| (repetition, index))) {
        let own = Record { repetition, makespan_s: Some(1.0), ..row() };
        let parallel = |own| Record { strategy: format!("pool-{index}"), threads: 2, ..own };
        rows.push(if index == 0 { own } else { parallel(own) });
    }
    let found = blocks(&results(&["speedup"], "", rows).unwrap()).unwrap();
    assert_eq!(table(&found).len(), 1999);
}
