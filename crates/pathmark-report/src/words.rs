//! Numbers and intervals as text, for tables and sentences.

use super::estimated::Estimated;
use crate::analysis::Interval;
use std::collections::BTreeSet;

/// A count with its noun: `1 thread`, `2 threads`.
pub fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// Seconds as people estimate them.
pub fn seconds(seconds: f64) -> String {
    if seconds < 1.0 { "less than 1 s".to_string() } else { format!("{seconds:.0} s") }
}

/// Bytes in kB or MB.
pub fn bytes(bytes: u64) -> String {
    let bytes = bytes as f64;
    if bytes < 1e5 { format!("{:.1} kB", bytes / 1e3) } else { format!("{:.1} MB", bytes / 1e6) }
}

/// The resources of a measurement, as far as they are known, and the machine that they belong to.
pub fn costs(time: Option<f64>, space: Option<u64>, machine: &str) -> String {
    let machine = Some(machine).filter(|machine| !machine.is_empty()).map(|machine| format!("on {machine}"));
    [time.map(seconds), space.map(bytes), machine].into_iter().flatten().collect::<Vec<String>>().join(", ")
}

/// A text as the beginning of a sentence.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// The sentence of a caption about hollow marks; empty if there are none.
pub(super) fn hollow(told: impl IntoIterator<Item = Estimated>) -> &'static str {
    let has_some = told.into_iter().any(|told| told.is_partial);
    if has_some { " Hollow: fewer seeds or repetitions than the others, so not comparable with them." } else { "" }
}

/// The sentence of a caption about bars, and that about hollow marks.
pub(super) fn bars<T: Into<Estimated>>(told: impl IntoIterator<Item = T>) -> String {
    let told: Vec<Estimated> = told.into_iter().map(Into::into).collect();
    let level = confidence(told.iter().filter_map(|told| told.interval));
    format!("Bars: {level}{}.{}", means_of_few(&told), hollow(told))
}

/// Fewest values whose extremes enclose the median with 95 % confidence.
const ENOUGH: usize = 6;

/// The part of a caption about few values, whose typical value is no median; empty if there are none.
fn means_of_few(told: &[Estimated]) -> &'static str {
    let is_few = |told: &Estimated| told.count.is_some_and(|count| (2..ENOUGH).contains(&count));
    match told.iter().filter(|told| is_few(told)).count() {
        0 => "",
        few if few == told.len() => " (the geometric mean, because there are fewer than six values)",
        _ => " (the median, or the geometric mean of fewer than six values)",
    }
}

/// The caption of ratios in pairs.
pub(super) fn ratio_bars<T: Into<Estimated>>(told: impl IntoIterator<Item = T>) -> String {
    format!("Ratios within a repetition. {}", bars(told))
}

/// An interval, with its confidence where that is not 95 %: few values cannot reach it, and medians pass it.
pub(super) fn with_level(interval: &Interval, digits: usize) -> String {
    format!("{:.digits$} to {:.digits$}{}", interval.low, interval.high, unusual_level(interval))
}

/// A value with its interval in brackets.
pub(super) fn with_interval(value: f64, interval: &Interval, digits: usize) -> String {
    format!("{value:.digits$} ({})", with_level(interval, digits).replace(" (", ", ").replace(')', ""))
}

/// The confidence of an interval in brackets; empty if it is 95 %, as the page says at its beginning.
pub(super) fn unusual_level(interval: &Interval) -> String {
    let percent = format!("{:.1}", interval.percent());
    if percent == "95.0" { String::new() } else { format!(" ({percent} %)") }
}

/// The confidence of some intervals, in words for a caption: of medians, or of means over processes of pairs.
fn confidence(intervals: impl IntoIterator<Item = Interval>) -> String {
    let mut levels: Vec<f64> = intervals.into_iter().map(|interval| interval.percent()).collect();
    levels.sort_by(f64::total_cmp);
    let levels = match levels.as_slice() {
        [] => return "no interval, for want of repetitions".to_string(),
        [least, .., most] if least < most => format!("{least:.1} to {most:.1} %"),
        [level, ..] => format!("{level:.1} %"),
    };
    format!("interval of the typical value, {levels} confidence")
}

/// Names with their places: names of the table in its order and at their places in it, then unknown names in
/// alphabetical order. So a name of the table has the same colour in every experiment, and names that a user added come
/// last.
pub(super) fn in_table_order<'a>(
    names: impl Iterator<Item = &'a str>,
    table: impl Iterator<Item = &'static str>,
) -> Vec<(usize, &'a str)> {
    let table: Vec<&str> = table.collect();
    let names: BTreeSet<&str> = names.collect();
    let unknown: Vec<&str> = names.iter().copied().filter(|name| !table.contains(name)).collect();
    let ordered = table.iter().chain(&unknown).enumerate();
    ordered.filter_map(|(place, name)| Some((place, *names.get(name)?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caption_tells_the_least_and_the_most_confidence() {
        let of = |levels: &[f64]| confidence(levels.iter().map(|&level| Interval { low: 0.0, high: 1.0, level }));
        assert_eq!(of(&[0.95, 0.75, 0.96]), "interval of the typical value, 75.0 to 96.0 % confidence");
        assert_eq!(of(&[0.95; 3]), "interval of the typical value, 95.0 % confidence");
        assert_eq!(of(&[]), "no interval, for want of repetitions");
    }

    #[test]
    fn only_an_unusual_confidence_is_told() {
        let of = |level: f64| with_level(&Interval { low: 0.5, high: 1.5, level }, 1);
        assert_eq!([of(0.95), of(0.968)], ["0.5 to 1.5", "0.5 to 1.5 (96.8 %)"]);
        let in_brackets = |level: f64| with_interval(1.0, &Interval { low: 0.5, high: 1.5, level }, 1);
        assert_eq!([in_brackets(0.95), in_brackets(0.968)], ["1.0 (0.5 to 1.5)", "1.0 (0.5 to 1.5, 96.8 %)"]);
    }

    #[test]
    fn names_that_a_table_does_not_know_come_behind_it() {
        let found = in_table_order(["mine", "sah", "beta"].into_iter(), ["none", "median", "sah"].into_iter());
        assert_eq!(found, [(2, "sah"), (3, "beta"), (4, "mine")]);
    }
}
