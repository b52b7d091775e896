use super::*;
use crate::estimator::Roulette;
use crate::measure::{AXES, Measured, Settings};
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Columns that change the image.
const IMAGE: [&str; 16] = [
    "scene",
    "scene_hash",
    "estimator",
    "sampler",
    "width",
    "height",
    "spp",
    "seed",
    "max_depth",
    "camera_rays",
    "roulette",
    "clamp",
    "filter",
    "epsilon",
    "precision",
    "adaptive",
];

/// Columns that describe how the same image is rendered.
const SCHEDULE: [&str; 11] = [
    "strategy",
    "decomposition",
    "threads",
    "ranks",
    "rank_rule",
    "output",
    "kernel",
    "kernel_fallback",
    "simd",
    "effects",
    "accelerator",
];

/// Columns that identify the row, follow from the others, or hold measurements.
const OTHER: [&str; 59] = [
    "mpi",
    "object_mse",
    "within_tolerance",
    "fireflies",
    "black_pixels",
    "image_write_s",
    "schema",
    "experiment",
    "cell",
    "repetition",
    "order",
    "target_error",
    "time_limit_s",
    "rounds",
    "biased",
    "jobs",
    "workers_used",
    "build_s",
    "device_compile_s",
    "device_copy_s",
    "pilot_s",
    "setup_s",
    "makespan_s",
    "merge_s",
    "cpu_user_s",
    "cpu_system_s",
    "busy_sum_s",
    "busy_max_s",
    "gap_sum_s",
    "tail_sum_s",
    "job_min_s",
    "job_median_s",
    "job_max_s",
    "voluntary_switches",
    "involuntary_switches",
    "foreign_cpu_s",
    "steal_s",
    "peak_rss_bytes",
    "paths",
    "rays",
    "box_tests",
    "primitive_tests",
    "escaped",
    "truncated",
    "invalid_samples",
    "estimated_rmse",
    "mse",
    "rmse",
    "mse_display",
    "rmse_display",
    "rel_mse",
    "variance",
    "mean_radiance",
    "checksum",
    "warnings",
    "error",
    "commit",
    "dirty",
    "started_utc",
];

fn columns(record: &Record) -> Map<String, Value> {
    match serde_json::to_value(record).unwrap() {
        Value::Object(columns) => columns,
        other => panic!("{other}"),
    }
}

/// The row with another value in one column.
fn varied(record: &Record, column: &str) -> Record {
    let mut columns = columns(record);
    let other = match &columns[column] {
        Value::Bool(own) => Value::from(!own),
        Value::Number(own) => Value::from(own.as_u64().unwrap() + 1),
        Value::String(own) => Value::from(format!("{own}-other")),
        _ => Value::from(7),
    };
    columns.insert(column.to_string(), other);
    serde_json::from_value(Value::Object(columns)).unwrap()
}

#[test]
fn every_column_distinguishes_images_or_schedules_or_neither() {
    let row = Record::default();
    let sorted: BTreeSet<&str> = IMAGE.into_iter().chain(SCHEDULE).chain(OTHER).collect();
    let own = columns(&row);
    assert_eq!(own.keys().map(String::as_str).collect::<BTreeSet<_>>(), sorted);
    for column in sorted {
        let other = varied(&row, column);
        assert_eq!(other.image_key() != row.image_key(), IMAGE.contains(&column), "{column}");
        assert_eq!(other.schedule_key() != row.schedule_key(), SCHEDULE.contains(&column), "{column}");
    }
}

#[test]
fn words_differ_where_keys_do() {
    let row = Record { max_depth: Some(3), spp: 4, ..Record::default() };
    for column in IMAGE {
        assert_ne!(varied(&row, column).image_key().to_string(), row.image_key().to_string(), "{column}");
    }
    for column in SCHEDULE {
        assert_ne!(varied(&row, column).schedule_key().to_string(), row.schedule_key().to_string(), "{column}");
    }
    // The same value on two axes gives two different words.
    let of = |roulette: &str, clamp: &str| {
        Record { roulette: roulette.to_string(), clamp: clamp.to_string(), ..Record::default() }.image_key().to_string()
    };
    assert_ne!(of("x", ""), of("", "x"));
}

fn setup(change: impl Fn(&mut Settings)) -> Setup {
    let mut settings = Settings { spp: 16, threads: 1, ..Settings::default() };
    (settings.spec.width, settings.spec.height, settings.spec.estimator) = (8, 6, "bsdf".to_string());
    change(&mut settings);
    Setup::prepare(settings).unwrap()
}

/// For each axis, a value that differs from the setups above.
const OTHER_VALUES: [(&str, &str); 23] = [
    ("scene", "sky"),
    ("size", "9x6"),
    ("estimator", "mis"),
    ("sampler", "sobol"),
    ("max-depth", "3"),
    ("camera-rays", "4"),
    ("spp", "8"),
    ("adaptive", "true"),
    ("seed", "2"),
    ("clamp", "subpixel"),
    ("filter", "box"),
    ("epsilon", "1e-4"),
    ("kernel", "scalar"),
    ("precision", "f32"),
    ("effects", "all"),
    ("accelerator", "sah"),
    ("roulette", "albedo:2"),
    ("strategy", "serial"),
    ("threads", "2"),
    ("decomposition", "rows"),
    ("output", "channel-piece"),
    ("rank-rule", "guided"),
    ("ranks", "3"),
];

#[test]
fn each_axis_gives_another_image_or_another_schedule_as_the_table_says() {
    let base = setup(|_| ());
    let (mut images, mut schedules) = (BTreeSet::from([base.image_key()]), BTreeSet::from([base.schedule_key()]));
    // The available instruction sets depend on the machine.
    for axis in AXES.iter().filter(|axis| axis.name != "simd") {
        let (_, value) = OTHER_VALUES.iter().find(|(name, _)| *name == axis.name).expect("a value for each axis");
        let other = setup(|settings| axis.set(settings, value).unwrap());
        if axis.changes_image {
            assert!(images.insert(other.image_key()), "{}", axis.name);
        } else {
            assert_eq!(other.image_key(), base.image_key(), "{}", axis.name);
            assert!(schedules.insert(other.schedule_key()), "{}", axis.name);
        }
    }
    let words: BTreeSet<String> = images.iter().map(ToString::to_string).collect();
    assert_eq!(words.len(), images.len(), "{words:#?}");
}

/// The columns by the table of axes are those by which the keys differ.
#[test]
fn the_table_of_axes_names_the_columns_of_the_keys() {
    let sorted = |columns: Vec<String>| columns.into_iter().collect::<BTreeSet<String>>();
    let of = |columns: &[&str]| columns.iter().map(ToString::to_string).collect::<BTreeSet<String>>();
    assert_eq!(sorted(image_columns()), of(&IMAGE));
    assert_eq!(sorted(schedule_columns()), of(&SCHEDULE));
}

#[test]
fn requested_and_measured_cells_have_the_same_keys() {
    for change in [|_: &mut Settings| (), |s: &mut Settings| s.spec.sampler = "stratified".to_string()] {
        let setup = setup(change);
        let row = Record::new(&setup, &setup.run(None).unwrap(), Measured::default());
        assert_eq!((row.image_key(), row.schedule_key()), (setup.image_key(), setup.schedule_key()));
    }
}

#[test]
fn an_estimators_own_rule_is_the_same_image_as_that_rule_asked_for() {
    let asked = setup(|s| s.spec.roulette = Some(Roulette::SMALLPT.to_string()));
    let own = setup(|_| ());
    assert_eq!(own.image_key(), asked.image_key());
    assert!(!own.image_key().roulette.is_empty());
}
