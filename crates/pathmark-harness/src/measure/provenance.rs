//! Provenance: the commit of the program, the date, and the film that a picture shows.

use crate::film_file::FilmKey;
use crate::image_io::Note;
use std::sync::OnceLock;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The state of the sources at the time of the build. The program itself states it, so that a commit rebuilds nothing else.
#[derive(Debug, Clone, Copy)]
pub struct Stamp {
    pub commit: &'static str,
    pub is_dirty: bool,
}

static STAMP: OnceLock<Stamp> = OnceLock::new();

impl Stamp {
    /// Makes it the stamp of this process's rows. Only the first call counts.
    pub fn set(self) {
        STAMP.get_or_init(|| self);
    }

    /// The stamp of this process's rows; an unknown commit if the program states none.
    pub fn of_program() -> Self {
        STAMP.get().copied().unwrap_or(Self { commit: "unknown", is_dirty: false })
    }
}

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

const KEY: &str = "pathmark.film";
const CHECKSUM: &str = "pathmark.checksum";

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    pub key: FilmKey,
    /// The film's checksum, if it has one.
    pub checksum: Option<String>,
}

impl Provenance {
    pub fn notes(&self) -> Vec<Note> {
        let software = ("Software", concat!("Pathmark ", env!("CARGO_PKG_VERSION")).to_string());
        let key = serde_json::to_string(&self.key).ok().map(|json| (KEY, json));
        let checksum = self.checksum.clone().map(|checksum| (CHECKSUM, checksum));
        [Some(software), key, checksum].into_iter().flatten().collect()
    }

    /// Reads the film from a picture's notes; `None` if another program, or another version, wrote them.
    pub fn of_notes(notes: &[(String, String)]) -> Option<Self> {
        let find = |wanted| notes.iter().find(|(name, _)| name == wanted).map(|(_, text)| text);
        let key = serde_json::from_str(find(KEY)?).ok()?;
        Some(Self { key, checksum: find(CHECKSUM).cloned() })
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
