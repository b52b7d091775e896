//! A setting is added in one place: `test_knob` stands only in the list of settings.

use super::{Definition, Profile, keys};
use crate::film_file::FilmKey;
use crate::lab::Lab;
use crate::measure::{COLUMNS, Record, ScheduleKey, Setting, Settings, Setup};

const KNOB: &str = "test-knob";

fn with(knob: Option<u16>) -> Setup {
    Setup::prepare(Settings { test_knob: knob, ..Settings::default() }).unwrap()
}

#[test]
fn a_setting_of_the_list_is_an_option_and_a_key_of_experiments() {
    let setting = Setting::named(KNOB).unwrap();
    assert_eq!((setting.value_name, setting.about), ("N", "Knob of tests"));
    assert!(keys().any(|(key, about)| key == "matrix.test-knob" && about == setting.about));
    let text = "title = \"t\"\nquestion = \"q\"\nfigures = []\n[matrix]\nscene = [\"cornell\"]\nspp = [4]\n\
        strategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\ntest-knob = [3, 4]\n[quick]\n";
    let definition = Definition::from_text(&Lab::built_in(), "x", "x.toml", text).unwrap();
    let cells = definition.cells(Profile::Quick).unwrap();
    assert_eq!(cells.iter().map(|cell| cell.settings.test_knob).collect::<Vec<_>>(), [Some(3), Some(4)]);
    for (cell, word) in cells.iter().zip(["/test-knob-3/", "/test-knob-4/"]) {
        assert!(cell.id.contains(word), "{}", cell.id);
    }
    assert_eq!(cells.iter().map(|cell| cell.matches("test-knob=4").unwrap()).collect::<Vec<_>>(), [false, true]);
    let changed = definition.with_values(&["test-knob=9".to_string()]).unwrap().cells(Profile::Quick).unwrap();
    assert_eq!(changed.iter().map(|cell| cell.settings.test_knob).collect::<Vec<_>>(), [Some(9)]);
}

#[test]
fn a_setting_of_the_list_tells_images_films_and_rows_apart() {
    let (three, four) = (with(Some(3)), with(Some(4)));
    assert_ne!(three.image_key(), four.image_key());
    assert_eq!(three.schedule_key(), four.schedule_key());
    assert_ne!(FilmKey::of(three.image_key()), FilmKey::of(four.image_key()));
    let row = Record::of(&three);
    assert_eq!((row.test_knob, row.image_key()), (Some(3), three.image_key()));
    assert!(COLUMNS.iter().any(|column| column.name == "test_knob"));
    let label = |setup: &Setup| Setting::named(KNOB).unwrap().label_of(&setup.image_key(), &ScheduleKey::default());
    assert_eq!((label(&three), label(&with(None))), (Some("knob 3".to_string()), None));
    assert_eq!(Setting::named(KNOB).unwrap().absent, "no knob");
}

/// Another build reads the settings of a cell, and they say what was asked for.
#[test]
fn settings_are_read_back_from_what_is_written() {
    let given = Settings { test_knob: Some(3), adaptive: true, spp: 4, ..Settings::default() };
    let text = serde_json::to_string(&given).unwrap();
    assert!(text.contains("\"test_knob\":3"), "{text}");
    assert_eq!(serde_json::from_str::<Settings>(&text).unwrap(), given);
    assert!(!serde_json::to_string(&Settings::default()).unwrap().contains("test_knob"));
}
