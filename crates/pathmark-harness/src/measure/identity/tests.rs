use super::*;
use crate::estimator::Roulette;
use crate::measure::{Record, SETTINGS, image_columns, schedule_columns};
use serde_json::{Map, Value};
use std::collections::BTreeSet;

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

/// Measurements and notes must not tell rows apart.
#[test]
fn the_columns_of_settings_distinguish_images_or_schedules_and_no_others_do() {
    let row = Record::default();
    let (image, schedule): (Vec<&str>, Vec<&str>) = (image_columns().collect(), schedule_columns().collect());
    for column in columns(&row).keys().map(String::as_str) {
        let other = varied(&row, column);
        assert_eq!(other.image_key() != row.image_key(), image.contains(&column), "{column}");
        assert_eq!(other.schedule_key() != row.schedule_key(), schedule.contains(&column), "{column}");
    }
}

#[test]
fn words_differ_where_keys_do() {
    let row = Record { max_depth: Some(3), spp: 4, ..Record::default() };
    for column in image_columns() {
        assert_ne!(varied(&row, column).image_key().to_string(), row.image_key().to_string(), "{column}");
    }
    for column in schedule_columns() {
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
const OTHER_VALUES: [(&str, &str); 27] = [
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
    ("time-limit", "0.5"),
    ("test-knob", "7"),
    ("pin", "compact"),
    ("counters", "true"),
];

#[test]
fn each_axis_gives_another_image_or_another_schedule_as_the_table_says() {
    let base = setup(|_| ());
    let (mut images, mut schedules) = (BTreeSet::from([base.image_key()]), BTreeSet::from([base.schedule_key()]));
    // The available instruction sets depend on the machine.
    for axis in SETTINGS.iter().filter(|axis| axis.name != "simd") {
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

#[test]
fn requested_and_measured_cells_have_the_same_keys() {
    for change in [|_: &mut Settings| (), |s: &mut Settings| s.spec.sampler = "stratified".to_string()] {
        let setup = setup(change);
        let row = Record::new(&setup, &setup.run(None).unwrap());
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
