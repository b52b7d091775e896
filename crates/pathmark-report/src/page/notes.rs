//! The values under the pointer, as the page holds them: with seven digits, and none of them twice. They take a third of a
//! figure's text. The page's script gives each its attributes.

use crate::plot::drawing::Note;
use crate::plot::svg::{escaped, place_of};

/// Digits of a value; the files of tables have all.
const DIGITS: usize = 7;

/// The notes of a figure, in groups of one series.
pub(super) fn of(notes: &[Note]) -> String {
    let groups = notes.chunk_by(|note, next| note.series == next.series);
    let group = |notes: &[Note]| {
        let circles: String = notes.iter().map(valued).collect();
        format!("<g data-series=\"{}\">{circles}</g>", escaped(&notes[0].series))
    };
    groups.map(group).collect()
}

/// The notes of a figure on other axes. Where they have the values of the `first` axes in the same order, only their
/// places.
pub(super) fn again(notes: &[Note], first: &[Note]) -> String {
    let is_same = |(note, first): (&Note, &Note)| Note { at: first.at, ..note.clone() } == *first;
    if notes.len() == first.len() && notes.iter().zip(first).all(is_same) {
        notes.iter().map(|note| circle(note, "", "")).collect()
    } else {
        of(notes)
    }
}

fn valued(note: &Note) -> String {
    let short = |value: f64| {
        let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
        rounded.to_string()
    };
    let (low, high) = note.interval.map_or_else(Default::default, |(low, high)| (short(low), short(high)));
    let count = note.count.map_or_else(String::new, |count| count.to_string());
    let data = format!(" data-note=\"{}|{low}|{high}|{count}|{}\"", short(note.value), escaped(&note.of));
    circle(note, &data, &format!("<title>{}</title>", escaped(&note.text)))
}

fn circle(note: &Note, data: &str, title: &str) -> String {
    let (x, y) = place_of(note);
    format!("<circle class=\"note\" cx=\"{x}\" cy=\"{y}\"{data}>{title}</circle>")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note(series: &str, value: f64, at: (f64, f64)) -> Note {
        let (interval, count) = (Some((value - 1.0, value + 1.0)), Some(3));
        Note {
            at,
            series: series.to_string(),
            of: "a|b".to_string(),
            value,
            interval,
            count,
            text: "t < u".to_string(),
        }
    }

    #[test]
    fn notes_of_a_series_share_its_name_and_other_axes_repeat_no_value() {
        let notes = [note("a", 2.0, (1.0, 2.0)), note("a", 10.0 / 3.0, (3.0, 2.0)), note("b", 2.0, (5.0, 2.0))];
        let text = of(&notes);
        let first = "<g data-series=\"a\"><circle class=\"note\" cx=\"2\" cy=\"4\" data-note=\"2|1|3|3|a|b\"><title>t &lt; u</title></circle>";
        assert!(text.starts_with(first), "{text}");
        assert!(text.contains("data-note=\"3.333333|2.333333|4.333333|3|a|b\""), "{text}");
        assert_eq!(text.matches("<g data-series=").count(), 2);
        let moved = notes.clone().map(|own| Note { at: (9.0, 9.0), ..own });
        assert_eq!(again(&moved, &notes), "<circle class=\"note\" cx=\"18\" cy=\"18\"></circle>".repeat(3));
        assert_eq!(again(&moved[..2], &notes), of(&moved[..2]));
    }
}
