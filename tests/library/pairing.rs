//! Ratios of two rows come from one place, `crates/pathmark-report/src/rows/paired.rs`, which pairs rows of one image in one repetition. A
//! ratio of two medians that a figure divides by itself may compare other sizes, samples or repetitions.
//!
//! Elsewhere in the report, code divides only: by a number, by the number of values or by a value of the same row; a
//! number by anything; and where [`EXCEPTIONS`] says why.

use std::fs;
use std::path::{Path, PathBuf};

/// The file that pairs rows.
const PAIRED: &str = "rows/paired.rs";

/// Divisions of other values: the file, the reason, and each division as it is written.
const EXCEPTIONS: &[(&str, &str, &[&str])] = &[
    (
        "claims/judge.rs",
        "conditions of a claim: samples or pixels asked for and run",
        &["own.parse::<f64>().ok()? / wanted"],
    ),
    ("claims/measure.rs", "columns of one row", &["sum / below"]),
    ("claims/measurement.rs", "a half width over the quantile that made it", &["(units as f64).sqrt() / t"]),
    (
        "contenders.rs",
        "means over seeds; measured over predicted; seconds of one row over its samples",
        &["/ count).sqrt()", "/ count;", "rmse / predicted", "seconds / pilot", "row.rendering_s()? / f64::from(*spp)"],
    ),
    ("figures/bias.rs", "pixels of a kind over all pixels of the row", &["/ pixels(row)"]),
    ("figures/bounces.rs", "paths that are cut over all paths of the same rows", &["cut / paths"]),
    (
        "figures/clamp_bias.rs",
        "light over the mean light of the converged image: estimates of the same integral, not times",
        &["row.mean_radiance? / limit", "limit / truth", "radiance(rows)? / truth"],
    ),
    ("figures/cost_map.rs", "two tiles of one run", &["most / least"]),
    (
        "figures/equal_time.rs",
        "selects the image that is nearest in time; no ratio is shown",
        &["seconds(record) / time"],
    ),
    (
        "figures/forecast.rs",
        "two jobs of one run, and the work of all jobs over the longest",
        &["all.longest_s / mean", "all.longest_s / median(costs)?", "/ all.longest_s,"],
    ),
    ("figures/granularity.rs", "seconds of a row over its jobs", &["extra_s / row.jobs"]),
    (
        "figures/pairs.rs",
        "fitted variances, and geometric means of seconds over the same seeds, whose ratio is the mean of the pairs' ratios",
        &["first.variance()? / best.variance()?", "seconds_per_spp.value / first.renderer"],
    ),
    (
        "figures/rmse_against_time.rs",
        "the slope along one line, whose points differ in samples on purpose",
        &["first.rmse.value / last", "last.seconds.value / first", "longer / octaves"],
    ),
    ("figures/time_against_spp.rs", "seconds of one row over its samples", &["row.makespan_s? / f64::from(row.spp)"]),
    ("figures/price_list.rs", "the inverse of one estimate", &["renderer.efficiency()?.times(&renderer"]),
    (
        "figures/roulette.rs",
        "rays and paths of the same rows; efficiencies of independent seeds, with the intervals of both",
        &["rays / paths", "contender.renderer.efficiency()?.times("],
    ),
    (
        "figures/scene_accuracy.rs",
        "squared error over the light of the same image",
        &["row.mse? / (radiance * radiance)"],
    ),
    (
        "figures/self_test.rs",
        "compares a cell with itself in successive repetitions on purpose",
        &["pair[0].1 / pair[1].1"],
    ),
    (
        "figures/speedup.rs",
        "a speedup over its number of processors",
        &[
            "speedup / self.results.weight_in_use(threads)",
            "speedup.value / self.results.weight_in_use(s.key.threads)",
            "speedup.value / processors",
        ],
    ),
    ("figures/timelines.rs", "parts of one run", &["seconds / (balance.makespan_s"]),
    (
        "forecasts.rs",
        "CPU times of a pair that `paired` made; forecasts of the same jobs",
        &["own / serial", "(a / b - 1.0)"],
    ),
    ("page/table.rs", "lengths of bars in a column", &["(value - least) / (most - least)"]),
    (
        "rank_forecasts.rs",
        "costs of messages; a prediction over the time of the same run; forecasts of the same jobs",
        &["/ LOOK.as_secs_f64()", "pair[0] / pair[1]", "work_s / makespan_s", "row.speedup.value / (row.crew.ranks"],
    ),
];

/// The code of a file without comments, texts and tests.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let (mut code, mut rest) = (String::new(), text);
    while let Some(at) = rest.find(['/', '"', '\'']) {
        code += &rest[..at];
        rest = &rest[at..];
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if let Some(inside) = rest.strip_prefix('"') {
            let mut escaped = false;
            let end = inside.find(|c: char| {
                let is_end = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                is_end
            });
            end.map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with("'\"'") || rest.starts_with("'/'") {
            3
        } else {
            code.push_str(&rest[..1]);
            rest = &rest[1..];
            continue;
        };
        rest = &rest[length..];
    }
    code + rest
}

/// Whether a division needs no reason: by a number, by the number of values, of a number, or of values of one row.
fn is_plain(left: &str, right: &str) -> bool {
    let starts_with_number = |text: &str| text.trim_start_matches('(').starts_with(|c: char| c.is_ascii_digit());
    let (left, right) = (left.trim_end(), right.trim_start());
    let divided = left.rsplit(|c: char| !(c.is_alphanumeric() || "._".contains(c))).next().unwrap_or_default();
    let divisor: String = right.chars().take_while(|c| c.is_alphanumeric() || "._?()".contains(*c)).collect();
    let of_one_row = divisor.starts_with("row.") && left.contains("row.") && !left.contains("/ ");
    starts_with_number(right)
        || right.starts_with("f64::from(1 <<")
        || divisor.ends_with(".len()")
        || starts_with_number(divided)
        || of_one_row
        || left.ends_with("count(row)? as f64")
        || divisor.starts_with("row.elements")
}

/// The lines of a file that divide other values.
fn divisions(code: &str) -> Vec<&str> {
    let divides = |line: &&str| {
        let mut places = line.match_indices('/').map(|(at, _)| line.split_at(at));
        places.any(|(left, right)| !is_plain(left, &right[1..]))
            || [".recip()", ".div(", ".inverse()"].iter().any(|call| line.contains(call))
    };
    code.lines().map(str::trim).filter(divides).collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let of = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    entries.flat_map(of).collect()
}

#[test]
fn only_one_file_divides_values_of_two_rows() {
    let report = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/pathmark-report/src");
    let mut wrong = Vec::new();
    for path in files(&report) {
        let name = path.strip_prefix(&report).unwrap().display().to_string();
        // Charts divide lengths on paper.
        if name == PAIRED || name.ends_with("tests.rs") || name.starts_with("plot/") {
            continue;
        }
        let code = code(&fs::read_to_string(&path).unwrap());
        let own = EXCEPTIONS.iter().find(|(file, ..)| *file == name);
        let known = own.map_or(&[][..], |(.., known)| known);
        let lines = divisions(&code);
        let is_known = |line: &&&str| known.iter().any(|division| line.contains(division));
        wrong.extend(lines.iter().filter(|line| !is_known(line)).map(|line| format!("{name}: {line}")));
        let is_used = |division: &&&str| lines.iter().any(|line| line.contains(**division));
        let stale = known.iter().filter(|division| !is_used(division));
        wrong.extend(stale.map(|division| format!("{name} no longer has the exception {division}")));
    }
    assert!(
        wrong.is_empty(),
        "divide by `rows::paired`, or tell the reason in tests/library/pairing.rs:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn ratios_of_medians_are_found_and_rates_are_not() {
    let found = |line: &str| divisions(&code(line)).len();
    let ratios = [
        "let speedup = serial.wall_s / own.wall_s;",
        "median(&serial)? / median(&own)?",
        "Some(row.makespan_s? / other.makespan_s?)",
        "Some(row.makespan_s? / times.get(&key)?)",
        "serial.inverse()",
    ];
    for line in ratios {
        assert_eq!(found(line), 1, "{line}");
    }
    let rates = [
        "Some(row.cpu_s()? / row.makespan_s?)",
        "sum / values.len() as f64",
        "let half = all / 2.0;",
        "let inverse = 1.0 / share;",
        "// serial / own",
        "format!(\"{} / {}\", serial, own)",
    ];
    for line in rates {
        assert_eq!(found(line), 0, "{line}");
    }
}
