//! Rows in CSV files.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

pub fn write<R: Serialize>(path: &Path, rows: impl IntoIterator<Item = R>) -> Result<()> {
    atomic_file::write(path, |file| {
        let mut writer = csv::Writer::from_writer(file);
        rows.into_iter().try_for_each(|row| writer.serialize(row))?;
        writer.flush()
    })
}

pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>> {
    let file = std::fs::File::open(path).map_err(|e| Error::system("reading", path, e))?;
    let rows: csv::Result<Vec<R>> = csv::Reader::from_reader(file).into_deserialize().collect();
    rows.map_err(|error| {
        let at = error.position().map(|position| (position.line() as usize, 1));
        let problem = format!("cannot be read: {error}");
        InputError::new("row", "", problem).in_file(path.display().to_string(), at).into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cell with a comma comes back, and a wrong cell is named with its line.
    #[test]
    fn rows_come_back_and_a_wrong_one_is_told_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        let rows = [("a, b".to_string(), 1), ("c".to_string(), 2)];
        write(&path, &rows).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, format!("name,number\n{text}")).unwrap();
        assert_eq!(read::<(String, u32)>(&path).unwrap(), rows);
        std::fs::write(&path, format!("name,number\n{text}d,many\n")).unwrap();
        let error = read::<(String, u32)>(&path).unwrap_err().to_string();
        assert!(error.contains("rows.csv:4") && error.contains("invalid digit"), "{error}");
    }
}
