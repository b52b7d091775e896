//! Times in UTC as ledgers and rows write them.

use humantime::{format_rfc3339_seconds, parse_rfc3339};

/// The form of a time, for errors.
pub(crate) const FORM: &str = "a time in UTC from 1970 on, such as 2026-01-31T12:00:00Z";

/// Whether a text is a date from 1970 on, such as `2026-01-31` (ISO 8601).
pub(crate) fn is_date(text: &str) -> bool {
    is_time(&format!("{text}T00:00:00Z"))
}

/// Whether a text is a time such as `2026-01-31T12:00:00Z`. Such texts are in the order of their times.
pub(crate) fn is_time(text: &str) -> bool {
    // Fractions, offsets and leap seconds are read, too, but not written again.
    parse_rfc3339(text).is_ok_and(|time| format_rfc3339_seconds(time).to_string() == text)
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
