//! Times in UTC as ledgers and rows write them.

/// The form of a time, for errors.
pub(crate) const FORM: &str = "a time in UTC from 1970 on, such as 2026-01-31T12:00:00Z";

/// Whether a text has this form, in which a 0 stands for any digit.
fn has_form(text: &str, form: &str) -> bool {
    let fits = |(own, form): (u8, u8)| if form == b'0' { own.is_ascii_digit() } else { own == form };
    text.len() == form.len() && text.bytes().zip(form.bytes()).all(fits)
}

/// Whether a text is a date from 1970 on, such as `2026-01-31` (ISO 8601).
pub(crate) fn is_date(text: &str) -> bool {
    if !has_form(text, "0000-00-00") {
        return false;
    }
    let number = |part: &str| part.parse().unwrap_or(u32::MAX);
    let (year, month, day) = (number(&text[..4]), number(&text[5..7]), number(&text[8..]));
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        2 if is_leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => 0,
    };
    year >= 1970 && (1..=days).contains(&day)
}

/// Whether a text is a time such as `2026-01-31T12:00:00Z`. Such texts are in the order of their times.
pub(crate) fn is_time(text: &str) -> bool {
    has_form(text, "0000-00-00T00:00:00Z")
        && is_date(&text[..10])
        && text[11..13] < *"24"
        && text[14..16] < *"60"
        && text[17..19] < *"60"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_times_that_exist_are_times() {
        for right in ["1970-01-01T00:00:00Z", "2024-02-29T23:59:59Z", "2000-02-29T00:00:00Z", "9999-12-31T12:00:00Z"] {
            assert!(is_time(right), "{right}");
        }
        for wrong in [
            "",
            "soon",
            "2026-99-99T99:99:99Z",
            "0000-01-01T00:00:00Z",
            "1969-12-31T23:59:59Z",
            "2026-00-01T00:00:00Z",
            "2026-13-01T00:00:00Z",
            "2026-04-31T00:00:00Z",
            "2026-01-00T00:00:00Z",
            "2026-02-29T00:00:00Z",
            "2100-02-29T00:00:00Z",
            "2026-01-31T24:00:00Z",
            "2026-01-31T12:60:00Z",
            "2026-01-31T12:00:60Z",
            "2026-01-31 12:00:00Z",
            "2026-01-31T12:00:00",
            "2026-01-31T12:00:00z",
            "2026-01-31T12:00:00.5Z",
            "2026-01-31T12:00:00+01:00",
            "２026-01-31T12:00Z",
        ] {
            assert!(!is_time(wrong), "{wrong}");
        }
    }
}
