//! The rows of a folder: `records.csv`, or `records.csv.gz` as `gzip` packs it, for studies that are kept in a repository.

use super::records_file::RECORDS;
use crate::error::{Error, InputError, Result};
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The ending of packed files.
const PACKED: &str = "gz";

/// The most bytes of unpacked rows: some five hundred thousand rows. A packed file may stand for a thousand times its size.
const LARGEST: u64 = 512 << 20;

/// The file of a folder's rows: the packed one if there is no other.
pub fn records_path(folder: &Path) -> PathBuf {
    let plain = folder.join(RECORDS);
    let packed = folder.join(format!("{RECORDS}.{PACKED}"));
    if !plain.is_file() && packed.is_file() { packed } else { plain }
}

/// Whether a folder has rows.
pub fn has_records(folder: &Path) -> bool {
    records_path(folder).is_file()
}

/// The bytes of a file of rows, unpacked.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    read_up_to(path, LARGEST)
}

/// The same for packed rows that have at most so many bytes unpacked.
fn read_up_to(path: &Path, most: u64) -> Result<Vec<u8>> {
    let refused = |problem: &str| InputError::new("records", path.display().to_string(), problem);
    let bytes = std::fs::read(path).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => refused("there is no such file").into(),
        _ => Error::system("reading", path, e),
    })?;
    if path.extension().is_none_or(|ending| ending != PACKED) {
        return Ok(bytes);
    }
    let mut unpacked = Vec::new();
    let done = MultiGzDecoder::new(bytes.as_slice()).take(most + 1).read_to_end(&mut unpacked);
    done.map_err(|e| refused(&format!("cannot be unpacked: {e}")))?;
    if unpacked.len() as u64 > most {
        let problem = format!("has more than {most} bytes when it is unpacked, the most that packed rows may have");
        return Err(refused(&problem).allowed("smaller rows, or rows that are not packed").into());
    }
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::read_records;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    #[test]
    fn packed_rows_are_read_and_damaged_ones_refused() {
        let folder = tempfile::tempdir().unwrap();
        let [plain, packed] = [RECORDS, "records.csv.gz"].map(|name| folder.path().join(name));
        assert_eq!(records_path(folder.path()), plain);
        assert!(!has_records(folder.path()));
        let text = "schema,cell\n1,a\n";
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(text.as_bytes()).unwrap();
        let bytes = encoder.finish().unwrap();
        std::fs::write(&packed, &bytes).unwrap();
        assert_eq!(records_path(folder.path()), packed);
        assert_eq!(read(&packed).unwrap(), text.as_bytes());
        // Errors name the packed file and the line in it.
        let error = read_records(&packed).unwrap_err();
        assert!(error.to_string().contains("records.csv.gz:2"), "{error}");
        std::fs::write(&packed, &bytes[..bytes.len() / 2]).unwrap();
        let error = read_records(&packed).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        assert!(error.to_string().contains("records.csv.gz"), "{error}");
        // Rows that are not packed come first.
        std::fs::write(&plain, text).unwrap();
        assert_eq!(records_path(folder.path()), plain);
    }

    /// A million zeros in a kilobyte, and twice as many in two parts.
    #[test]
    fn rows_that_are_too_large_unpacked_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let packed = folder.path().join("records.csv.gz");
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&vec![0; 1 << 20]).unwrap();
        let bomb = encoder.finish().unwrap();
        assert!(bomb.len() < 2000, "{}", bomb.len());
        for (parts, bytes) in [(1, 1 << 20), (2, 2 << 20)] {
            std::fs::write(&packed, bomb.repeat(parts)).unwrap();
            assert_eq!(read_up_to(&packed, bytes).unwrap().len() as u64, bytes);
            let error = read_up_to(&packed, bytes - 1).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{error}");
            let told = format!("records.csv.gz: has more than {} bytes", bytes - 1);
            assert!(error.to_string().contains(&told), "{error}");
        }
    }
}
