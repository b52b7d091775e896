//! Dates and times as text.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The first second after the year 9999, after 1970.
const END_S: u64 = 253_402_300_800;

/// The date and time in UTC, like `2026-01-31T12:00:00Z`; empty if the system's clock shows no date from 1970 to 9999.
pub fn utc_now() -> String {
    utc(SystemTime::now())
}

fn utc(time: SystemTime) -> String {
    match time.duration_since(UNIX_EPOCH) {
        Ok(since) if since < Duration::from_secs(END_S) => humantime::format_rfc3339_seconds(time).to_string(),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The seconds are those of `date -u -d @N +%FT%TZ`.
    #[test]
    fn a_clock_may_show_anything() {
        let after = |seconds| utc(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(after(0), "1970-01-01T00:00:00Z");
        assert_eq!(after(1_790_000_000), "2026-09-21T14:13:20Z");
        assert_eq!(after(END_S - 1), "9999-12-31T23:59:59Z");
        assert_eq!(after(END_S), "");
        assert_eq!(after(u64::MAX / 4), "");
        assert_eq!(utc(UNIX_EPOCH - Duration::from_nanos(1)), "");
        assert_eq!(utc(UNIX_EPOCH - Duration::from_secs(1_000_000_000)), "");
    }
}
