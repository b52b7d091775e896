//! The texts of the committed experiments and of the claims on the reports.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{LazyLock, OnceLock};

pub type Named = &'static [(&'static str, &'static str)];

#[derive(Debug, Clone, Copy)]
pub struct Texts {
    pub experiments: Named,
    pub claims: Named,
}

static EMBEDDED: OnceLock<Texts> = OnceLock::new();

/// Makes the texts known that the program carries. Only the first call counts.
pub fn embed(texts: Texts) {
    EMBEDDED.get_or_init(|| texts);
}

/// The folder of the sources from which this crate was built: an edited definition counts without a new build.
const SOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../experiments");

/// The definitions in a folder of the sources, by name; those that the program carries if the folder is not there.
fn read(folder: &Path, embedded: fn(&Texts) -> Named) -> Vec<(String, String)> {
    let of_disk = || {
        let mut texts = BTreeMap::new();
        for entry in fs::read_dir(folder).ok()? {
            let path = entry.ok()?.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                let name = path.file_stem()?.to_str()?.to_string();
                texts.insert(name, fs::read_to_string(&path).ok()?);
            }
        }
        Some(texts.into_iter().collect()).filter(|texts: &Vec<_>| !texts.is_empty())
    };
    let own = || EMBEDDED.get().map(embedded).unwrap_or_default();
    of_disk().unwrap_or_else(|| own().iter().map(|(name, text)| ((*name).to_string(), (*text).to_string())).collect())
}

pub fn experiments() -> &'static [(String, String)] {
    static EXPERIMENTS: LazyLock<Vec<(String, String)>> =
        LazyLock::new(|| read(Path::new(SOURCES), |texts| texts.experiments));
    &EXPERIMENTS
}

pub fn claims() -> &'static [(String, String)] {
    static CLAIMS: LazyLock<Vec<(String, String)>> =
        LazyLock::new(|| read(&Path::new(SOURCES).join("claims"), |texts| texts.claims));
    &CLAIMS
}
