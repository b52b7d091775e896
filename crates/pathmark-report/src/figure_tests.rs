//! Single figures on rows whose ratios follow from closed forms.

use super::block::Block;
use super::figures::blocks;
use super::page::table::Table;
use super::plot::drawing::Note;
use super::tests::{self, results, row, svg, words};
use crate::measure::Record;

/// The values that the figure of that name draws.
fn notes(blocks: &[Block], name: &str) -> Vec<Note> {
    let figure = blocks.iter().find_map(|block| match block {
        Block::Figure { stem, figure } if *stem == name => Some(figure.drawing().notes),
        _ => None,
    });
    figure.unwrap_or_else(|| panic!("no figure {name}"))
}

/// The table of that name.
fn table<'a>(blocks: &'a [Block], name: &str) -> &'a Table {
    let table = blocks.iter().find_map(|block| match block {
        Block::Table { stem, table } if *stem == name => Some(table),
        _ => None,
    });
    table.unwrap_or_else(|| panic!("no table {name}"))
}

/// The only value of a series at a place.
fn value(notes: &[Note], series: &str, of: &str) -> f64 {
    let own: Vec<f64> =
        notes.iter().filter(|note| note.series == series && note.of == of).map(|note| note.value).collect();
    assert_eq!(own.len(), 1, "{series}, {of}: {notes:?}");
    own[0]
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9 * b.abs()
}

/// Ten strategies, of which `pool-1` takes twice as long as the others, and one that ran in another size.
#[test]
fn schedules_that_are_not_told_apart_are_marked_and_sizes_are_not_mixed() {
    let mut rows = Vec::new();
    for (width, strategies) in [(8, 0..10), (16, 10..11)] {
        for repetition in 0..6 {
            let noise = 1.0 + 0.01 * f64::from(repetition);
            let own = |strategy: String, threads: usize, seconds: f64| {
                let makespan_s = Some(seconds * noise);
                Record { width, repetition, strategy, threads, makespan_s, ..row() }
            };
            rows.push(own("serial".to_string(), 1, 4.0));
            rows.extend(strategies.clone().map(|index| {
                // Those of even number are faster in even repetitions.
                let turn = if (index + repetition) % 2 == 0 { 0.99 } else { 1.0 };
                own(format!("pool-{index}"), 2, if index == 1 { 4.0 } else { 2.0 * turn })
            }));
        }
    }
    let blocks = blocks(&results(&["speedup"], "", rows).unwrap()).unwrap();
    let (usual, others) = (notes(&blocks, "speedup"), notes(&blocks, "speedup-others"));
    let names = |notes: &[Note]| notes.iter().map(|note| note.of.clone()).collect::<Vec<String>>();
    assert_eq!(names(&usual).iter().filter(|name| name.starts_with('≈')).count(), 9, "{:?}", names(&usual));
    assert!(names(&usual).contains(&"pool-1".to_string()), "{:?}", names(&usual));
    assert_eq!(names(&others), ["pool-10, 16x6"]);
    let text = svg(&blocks, "speedup");
    assert!(text.contains("2 processors") && text.contains("8x6") && !text.contains("16x6"));
    // In half of the repetitions the others take 2, in half 2.02 times the time.
    assert!(text.contains("Nine schedules tie at 2.01 times serial; pool-1 takes 2 times as long"), "{text}");
    assert!(text.contains("Speedup by strategy"));
    // The table has the nine others, those that tie first.
    let rows: Vec<Vec<String>> = self::table(&blocks, "beside-the-fastest").rows().collect();
    assert_eq!(rows.len(), 10);
    assert!(rows[9][0] == "pool-1" && rows[9][2].starts_with("2.0") && rows[9][3] == "slower", "{rows:?}");
    assert!(rows[1..9].iter().all(|row| row[3] == "not told apart"), "{rows:?}");
}

/// Two strategies of which each is faster in half of the repetitions, and one that is faster than OpenMP in each.
#[test]
fn titles_claim_only_results_that_the_intervals_support() {
    let rows = |others: &[(&str, [f64; 2])]| -> Vec<Record> {
        let own = |strategy: &str, repetition: u32, threads: usize, seconds: f64| Record {
            strategy: strategy.to_string(),
            repetition,
            threads,
            makespan_s: Some(seconds),
            ..row()
        };
        let of = |repetition: u32| {
            let others =
                others.iter().map(move |(name, turns)| own(name, repetition, 2, turns[repetition as usize % 2]));
            others.chain([own("serial", repetition, 1, 4.0)]).collect::<Vec<Record>>()
        };
        (0..6).flat_map(of).collect()
    };
    let title = |figure: &str, others: &[(&str, [f64; 2])]| {
        let blocks = blocks(&results(&[figure], "", rows(others)).unwrap()).unwrap();
        svg(&blocks, figure)
    };
    let open = title("speedup", &[("one", [2.0, 2.1]), ("other", [2.1, 2.0])]);
    assert!(open.contains("This machine cannot tell 2 schedules apart: "), "{open}");
    let one = title("speedup", &[("one", [2.5, 2.5])]);
    assert!(one.contains("one is 1.6 times as fast as serial on 2 processors"), "{one}");
    let apart = title("speedup", &[("one", [2.0, 2.0]), ("other", [2.52, 2.52])]);
    assert!(apart.contains("one is the fastest, 2 times serial; other takes 26 % longer"), "{apart}");
    let yardstick = ("openmp-dynamic", [2.0, 2.0]);
    let openmp = |others: &[(&str, [f64; 2])]| title("openmp", &[&[yardstick], others].concat());
    let dynamic = "OpenMP's dynamic schedule";
    let open = openmp(&[("one", [1.9, 2.1])]);
    assert!(open.contains(&format!("This machine cannot tell 1 schedule from {dynamic}")), "{open}");
    let faster = openmp(&[("one", [1.8, 1.8]), ("other", [1.9, 2.1])]);
    let told = format!("one takes 10 % less time than {dynamic}; 1 of 2 schedules tie with it");
    assert!(faster.contains(&told), "{faster}");
    let slower = openmp(&[("one", [2.0, 2.0]), ("other", [2.1, 2.1])]);
    let told = format!("No schedule is faster than {dynamic}: 1 of 2 schedules tie with it, other takes 5.0 % longer");
    assert!(slower.contains(&told), "{slower}");
}

/// A kernel that needs a second to start and none for samples: short renders would show the start.
#[test]
fn kernels_are_compared_at_the_most_samples_that_both_have() {
    let mut rows = Vec::new();
    for repetition in 0..3 {
        for (spp, kernel, seconds) in
            [(4, "scalar", 4.0), (4, "lanes", 1.4), (64, "scalar", 64.0), (64, "lanes", 7.4), (256, "lanes", 26.6)]
        {
            let makespan_s = Some(seconds * (1.0 + 0.01 * f64::from(repetition)));
            rows.push(Record { repetition, spp, kernel: kernel.to_string(), makespan_s, ..row() });
        }
    }
    let blocks = blocks(&results(&["kernels"], "", rows).unwrap()).unwrap();
    let notes = notes(&blocks, "kernels");
    let [only] = &notes[..] else { panic!("{notes:?}") };
    assert!(only.of.contains("64 spp") && close(only.value, 64.0 / 7.4), "{only:?}");
    let title = "The fastest kernel is 8.65 times as fast as the scalar kernel";
    assert!(svg(&blocks, "kernels").contains(title));
    let text = words(&blocks);
    assert!(text.contains("On one thread the fastest kernel is 8.65 (8.65 to 8.65"), "{text}");
    assert!(text.contains(" times as fast as scalar on cornell: bsdf + independent, 64 spp (lanes)."), "{text}");
}

/// RMSE = 1 / sqrt(n) and t = n by the scalar kernel: an RMSE of .01 takes 10 000 s. Lanes halve the time, and the
/// other estimator halves the error, so both together take 1250 s.
#[test]
fn choices_that_multiply_are_told_by_the_time_to_an_error() {
    let mut rows = Vec::new();
    for (seed, spp) in (1..=3).flat_map(|seed| [1, 4, 16].map(|spp| (seed, spp))) {
        for (kernel, estimator, mse, seconds) in
            [("scalar", "bsdf", 1.0, 1.0), ("lanes", "bsdf", 1.0, 0.5), ("lanes", "nee", 0.25, 0.5)]
        {
            let factor = 1.0 + 0.01 * seed as f64;
            let (mse, makespan_s) = (mse * factor / f64::from(spp), Some(seconds * factor * f64::from(spp)));
            let (kernel, estimator) = (kernel.to_string(), estimator.to_string());
            rows.push(Record { seed, spp, kernel, estimator, mse: Some(mse), makespan_s, ..row() });
        }
    }
    let blocks = blocks(&results(&["kernels"], "", rows).unwrap()).unwrap();
    let text = words(&blocks);
    assert!(text.contains(" is 8.0 (") && text.contains(" to an RMSE of 0.01."), "{text}");
    let rows: Vec<Vec<String>> = table(&blocks, "kernels-at-equal-error").rows().collect();
    let [only] = &rows[..] else { panic!("{rows:?}") };
    assert!(only[..2] == ["cornell", "1"] && only[2].contains("nee") && only[4].starts_with("8.0, "), "{only:?}");
}

/// Each number of threads has an area of its own, and each output a row for its pieces.
#[test]
fn outputs_have_an_area_for_each_number_of_threads() {
    let mut rows = Vec::new();
    for repetition in 0..6 {
        for (threads, decomposition, output, seconds) in [
            (1, "rows", "slots", 2.0),
            (1, "rows", "locked", 2.5),
            (2, "rows", "slots", 1.0),
            (2, "rows", "locked", 4.0),
            (2, "tiles:2x2", "slots", 1.0),
            (2, "tiles:2x2", "locked", 1.0),
        ] {
            let [strategy, decomposition, output] = ["pool", decomposition, output].map(str::to_string);
            let makespan_s = Some(seconds);
            rows.push(Record { repetition, strategy, threads, decomposition, output, makespan_s, ..row() });
        }
    }
    let blocks = blocks(&results(&["outputs"], "", rows).unwrap()).unwrap();
    let notes = notes(&blocks, "outputs");
    for (series, of, expected) in [
        ("1 thread", "locked, rows", 1.25),
        ("2 threads", "locked, rows", 4.0),
        ("2 threads", "locked, tiles:2x2", 1.0),
    ] {
        assert_eq!(value(&notes, series, of), expected, "{series}, {of}");
    }
    assert_eq!(notes.len(), 3);
    let places =
        |series: &str| notes.iter().filter(|note| note.series == series).map(|note| note.at.0).collect::<Vec<f64>>();
    let (one, two) = (places("1 thread"), places("2 threads"));
    assert!(two.iter().all(|x| *x > one[0]), "{one:?} {two:?}");
    assert!(svg(&blocks, "outputs").contains("locked takes 4 times as long with rows, 2 threads"));
}

/// Without a hierarchy a ray takes time in proportion to the spheres.
#[test]
fn the_gain_of_a_hierarchy_is_told_at_the_most_spheres() {
    let mut rows = Vec::new();
    for repetition in 0..6 {
        for (spheres, accelerator, seconds) in [
            (10, "none", 1.0),
            (10, "sah", 2.0),
            (100, "none", 10.0),
            (100, "sah", 4.0),
            (1000, "none", 100.0),
            (1000, "sah", 5.0),
            (1000, "median", 10.0),
        ] {
            let (scene, accelerator) = (format!("balls:{spheres}"), accelerator.to_string());
            rows.push(Record { repetition, scene, accelerator, makespan_s: Some(seconds), ..row() });
        }
    }
    let blocks = blocks(&results(&["acceleration"], "", rows).unwrap()).unwrap();
    let findings: Vec<&str> = blocks.iter().filter_map(Block::as_finding).collect();
    let told = "The best hierarchy at 1000 spheres is sah: 20.0 (20.0 to 20.0, 96.8 %) times as fast as testing every \
                sphere. It is faster from 100 spheres on; at 10 it is slower.";
    assert_eq!(findings, [told]);
    let gains =
        table(&blocks, "acceleration-gains").rows().map(|row| format!("{} {} {}", row[0], row[1], &row[2][..5]));
    let expected =
        ["10 spheres sah 0.50,", "100 spheres sah 2.50,", "1000 spheres median 10.00", "1000 spheres sah 20.00"];
    assert_eq!(gains.collect::<Vec<String>>(), expected);
}

/// Two generators at two numbers of samples stand below each other, in seconds.
#[test]
fn generators_of_one_workload_share_a_row() {
    let mut rows = Vec::new();
    for (spp, sampler, seconds) in
        [(4, "independent", 1.0), (4, "libc-rand", 3.0), (8, "independent", 2.0), (8, "libc-rand", 6.0)]
    {
        rows.push(Record { spp, sampler: sampler.to_string(), makespan_s: Some(seconds), ..row() });
    }
    let blocks = blocks(&results(&["generators"], "", rows).unwrap()).unwrap();
    let notes = notes(&blocks, "generators");
    assert_eq!(value(&notes, "libc-rand", "4 spp, serial, 1 thread"), 3.0);
    assert_eq!(value(&notes, "independent", "8 spp, serial, 1 thread"), 2.0);
}

/// A render of n samples takes 1 + n seconds, so a sample of 4 takes 1.25 s and one of 16 takes 1.0625 s.
#[test]
fn the_seconds_of_a_sample_are_compared_with_those_of_the_longest_renders() {
    let rows = (0..3).flat_map(|repetition| {
        [4, 8, 16].map(|spp| Record { repetition, spp, makespan_s: Some(1.0 + f64::from(spp)), ..row() })
    });
    let blocks = blocks(&results(&["time-against-spp"], "", rows.collect()).unwrap()).unwrap();
    let found = notes(&blocks, "time-per-sample");
    let at = |spp: &str| found.iter().find(|note| note.of == spp).unwrap().value;
    assert!(close(at("4"), 1.25 / 1.0625) && close(at("8"), 1.125 / 1.0625), "{found:?}");
    assert!(!found.iter().any(|note| note.of == "16"), "the longest is 1 by construction");
    let title = "Short renders pay for their start: at 4 samples per pixel a sample takes 18 % longer";
    assert!(svg(&blocks, "time-per-sample").contains(title));
}

/// An epsilon that adds 3 % of light, one that takes a hundredth of a percent, and one that is too small to matter.
#[test]
fn changes_of_light_have_a_side_and_a_place() {
    let mut rows = Vec::new();
    for seed in 1..=3 {
        let light = 0.5 + 0.1 * seed as f64;
        for (epsilon, factor, fireflies) in
            [("", 1.0, 0), ("1", 1.03, 24), ("0.5", 0.9999, 12), ("1e-9", 1.0 + 1e-12, 0)]
        {
            let (epsilon, mean_radiance) = (epsilon.to_string(), Some(light * factor));
            rows.push(Record { seed, epsilon, mean_radiance, fireflies: Some(fireflies), ..row() });
        }
    }
    let more = "[figure.bias]\naxis = \"epsilon\"\nusual = \"exact\"";
    let blocks = blocks(&results(&["bias"], more, rows).unwrap()).unwrap();
    let light = notes(&blocks, "bias");
    assert!((value(&light, "lighter", "1") - 3.0).abs() < 1e-9, "{light:?}");
    assert!((value(&light, "darker", "0.5") - 0.01).abs() < 1e-9, "{light:?}");
    assert_eq!(light.len(), 2, "{light:?}");
    // 24 of 48 pixels.
    assert!(close(notes(&blocks, "fireflies").iter().find(|note| note.of == "1").unwrap().value, 5e5));
    assert!(words(&blocks).contains("change of the mean radiance against exact"));
}

/// Directions by the cosine leave eight times the squared error on the object, twice that of the image.
#[test]
fn roughness_compares_the_reports_way_on_the_object() {
    let mut rows = Vec::new();
    for seed in 1..=3 {
        for (scene, object, image) in [("kd-ks-25", 0.08, 0.02), ("kd-ks-25-vndf", 0.01, 0.01)] {
            let factor = 1.0 + 0.1 * seed as f64;
            let (object_mse, mse) = (Some(object * factor), Some(image * factor));
            rows.push(Record { seed, scene: scene.to_string(), object_mse, mse, ..row() });
        }
    }
    let blocks = blocks(&results(&["roughness"], "", rows).unwrap()).unwrap();
    let found = notes(&blocks, "roughness");
    let error = found.iter().find(|note| note.series.starts_with("squared error")).unwrap();
    assert!(close(error.value, 8.0), "{found:?}");
    let title = "On kd-ks-25 the cosine leaves 8 times the squared error of the facets";
    assert!(svg(&blocks, "roughness").contains(title));
}

/// A slope is fitted to four numbers of samples, and not to three.
#[test]
fn three_points_have_no_slope() {
    let text = |all: &[u32]| {
        let rows = (1..=5).flat_map(|seed| {
            all.iter().map(move |&spp| Record { seed, spp, mse: Some(0.1 / f64::from(spp)), ..row() })
        });
        let noisy = rows.map(|row| Record { mse: row.mse.map(|mse| mse * (1.0 + 0.01 * row.seed as f64)), ..row });
        words(&blocks(&results(&["rmse-against-spp"], "", noisy.collect()).unwrap()).unwrap())
    };
    assert!(text(&[4, 8, 16, 32]).contains("5 seeds") && !text(&[4, 8, 16]).contains("fit: slope"));
}

/// Squared errors of 1, 2 and 3 hundredths have the mean 0.02, whatever samples each seed and repetition reached.
#[test]
fn errors_under_a_time_limit_are_over_all_seeds() {
    let of = |factor: f64| {
        let mut rows = Vec::new();
        for (estimator, factor) in [("bsdf", 1.0), ("nee", factor)] {
            for (seed, repetition) in (1..=3).flat_map(|seed| [(seed, 0), (seed, 1)]) {
                let (estimator, mse) = (estimator.to_string(), Some(0.01 * factor * seed as f64));
                let limited = Record { time_limit_s: Some(0.5.into()), makespan_s: Some(0.49), ..row() };
                rows.push(Record { estimator, seed, repetition, mse, spp: 10 * seed as u32 + repetition, ..limited });
            }
        }
        blocks(&results(&["equal-time"], "", rows).unwrap()).unwrap()
    };
    let blocks = of(0.01);
    let shown: Vec<Vec<String>> = tests::table(&blocks).rows().collect();
    assert_eq!(shown.len(), 2, "{shown:?}");
    assert_eq!(shown[0][..3], ["cornell", "0.5", "bsdf"]);
    assert!(shown[0][3].starts_with("0.141, ") && shown[1][3].starts_with("0.0141, "), "{shown:?}");
    assert_eq!(shown[0][5..], ["10 to 30", "3"]);
    let told = words(&blocks);
    assert!(told.contains("cornell after 0.5 s: nee has the smallest RMSE, 0.0141 ("), "{told}");
    assert!(told.contains("The intervals of all others lie above it."), "{told}");
    let told = words(&of(0.5));
    assert!(told.contains("Not told apart from it, because the intervals overlap: bsdf."), "{told}");
}
