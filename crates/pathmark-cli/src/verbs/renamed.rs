//! Names that verbs had in version 0.1. They are read for one release: 0.3 removes this file.

use std::ffi::OsString;

/// Each old name, and the words that replace it.
const RENAMED: [(&str, &[&str]); 12] = [
    ("bounces", &["inspect", "bounces"]),
    ("check", &["selftest"]),
    ("compare", &["image", "compare"]),
    ("completions", &["shell", "completions"]),
    ("convert", &["image", "convert"]),
    ("explain", &["list", "warnings"]),
    ("man", &["shell", "man"]),
    ("message-costs", &["inspect", "messages"]),
    ("rays", &["inspect", "rays"]),
    ("reference", &["image", "reference"]),
    ("replay", &["inspect", "path"]),
    ("trace", &["inspect", "jobs"]),
];

/// The arguments of a command line, the program's name first, with today's name of the verb.
pub(crate) fn with_new_names(arguments: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = arguments.into_iter().collect();
    // No option that stands before the verb takes a value.
    let is_option = |argument: &OsString| argument.as_encoded_bytes().starts_with(b"-");
    let verb = arguments.iter().skip(1).position(|argument| !is_option(argument)).map(|place| place + 1);
    let renamed =
        verb.and_then(|place| RENAMED.iter().find(|(old, _)| arguments[place] == *old).map(|(_, new)| (place, new)));
    if let Some((place, new)) = renamed {
        arguments.splice(place..=place, new.iter().map(OsString::from));
    }
    arguments
}
