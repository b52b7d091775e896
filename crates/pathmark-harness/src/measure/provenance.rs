//! Provenance of a picture: the film that it shows, kept beside its pixels in formats that hold notes.

use crate::film_file::FilmKey;
use crate::image_io::Note;

/// The name of the note that holds the key, as JSON.
const KEY: &str = "pathmark.film";
/// The name of the note that holds the checksum.
const CHECKSUM: &str = "pathmark.checksum";

/// The film that a picture shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    pub key: FilmKey,
    /// The film's checksum, if it has one.
    pub checksum: Option<String>,
}

impl Provenance {
    /// The notes of a picture that shows this film.
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
