//! The user's text files, with size limits: a device, a pipe or a wrong path is refused before it fills the memory.

use crate::error::{Error, InputError, Result};
use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

/// Largest definition, in bytes. Every scene or experiment is far smaller, unlike a device file or a wrong path. A
/// parsed definition takes 70 times its length in memory: more objects than fit here belong in a mesh or a generator.
const LARGEST_DEFINITION: u64 = 3 << 20;

/// Some programs begin a text with this character; it is no part of the text.
pub const BYTE_ORDER_MARK: &str = "\u{feff}";

/// Size limits of a text file.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Bytes in total.
    pub bytes: u64,
    /// Bytes of a line, its end included.
    pub line: u64,
}

/// Reads the text of a definition.
pub fn read_text(path: &Path) -> Result<String> {
    read_text_up_to(path, LARGEST_DEFINITION)
}

/// Reads a user's text file of at most `most` bytes.
pub fn read_text_up_to(path: &Path, most: u64) -> Result<String> {
    let mut bytes = Vec::new();
    let limits = Limits { bytes: most, line: u64::MAX };
    open_text(path, limits)?.read_to_end(&mut bytes).map_err(|e| unreadable(path, e))?;
    let mut text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        refused(path, format!("is not UTF-8 text at byte {at}"))
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len());
    }
    Ok(text)
}

/// Opens a user's text file. [`unreadable`] converts errors from reading it.
pub fn open_text(path: &Path, limits: Limits) -> Result<BufReader<Text>> {
    // To open a pipe would wait for a writer, perhaps for ever.
    if fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo()) {
        return Err(refused(path, "is a pipe, and it may be read more than once").allowed("a file").into());
    }
    let file = File::open(path).map_err(|e| match e.kind() {
        ErrorKind::NotFound => refused(path, "there is no such file").into(),
        ErrorKind::NotADirectory => refused(path, "a part of the path is not a directory").into(),
        ErrorKind::InvalidFilename => refused(path, "the name is too long").into(),
        ErrorKind::InvalidInput => refused(path, "the name contains a zero byte").into(),
        _ => Error::system("reading", path, e),
    })?;
    let data = file.metadata().map_err(|e| Error::system("reading", path, e))?;
    if data.is_dir() {
        return Err(refused(path, "is a directory").into());
    }
    if data.len() > limits.bytes {
        return Err(refused(path, too_large("is too large", limits.bytes)).into());
    }
    Ok(BufReader::new(Text { file, is_regular: data.is_file(), limits, bytes: 0, line: 0 }))
}

/// Converts an error from reading a file: an input error if its contents are wrong, a system error otherwise.
pub fn unreadable(path: &Path, error: io::Error) -> Error {
    match error.kind() {
        ErrorKind::InvalidData => refused(path, error.to_string()).into(),
        _ => Error::system("reading", path, error),
    }
}

fn too_large(what: &str, most: u64) -> String {
    let (most, unit) = if most < 1 << 20 { (most >> 10, "KiB") } else { (most >> 20, "MiB") };
    format!("{what} (allowed: up to {most} {unit})")
}

fn refused(path: &Path, problem: impl Into<String>) -> InputError {
    InputError::new("file", path.display().to_string().replace('\0', "\\0"), problem)
}

/// A file reader that fails as soon as the file is not text or exceeds its limits.
#[derive(Debug)]
pub struct Text {
    file: File,
    /// Whether it is a regular file. The length of other files, such as devices, is unknown.
    is_regular: bool,
    limits: Limits,
    bytes: u64,
    /// Bytes of the line so far.
    line: u64,
}

impl Read for Text {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        for &byte in &buffer[..count] {
            if byte == 0 && !self.is_regular {
                let problem = format!("is not text: byte {} is zero", self.bytes);
                return Err(io::Error::new(ErrorKind::InvalidData, problem));
            }
            self.bytes += 1;
            self.line = if byte == b'\n' { 0 } else { self.line + 1 };
            let problem = if self.bytes > self.limits.bytes {
                too_large("is too large", self.limits.bytes)
            } else if self.line >= self.limits.line {
                too_large("has a line that is too long", self.limits.line)
            } else {
                continue;
            };
            return Err(io::Error::new(ErrorKind::InvalidData, problem));
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufRead;

    /// A device is read only until it is clear that it holds no text.
    #[test]
    fn devices_and_other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        let refusal = |path: &Path| read_text_up_to(path, 1 << 50).unwrap_err();
        assert_eq!(read_text_up_to(Path::new("/dev/null"), 0).unwrap(), "");
        assert!(refusal(Path::new("/dev/zero")).to_string().contains("byte 0 is zero"));
        assert!(refusal(Path::new("a\0b")).to_string().contains("file = a\\0b: the name contains a zero byte"));
        assert!(refusal(&folder.path().join("x".repeat(300))).to_string().contains("too long"));
        assert!(refusal(folder.path()).to_string().contains("is a directory"));
        // The parser reports the position of a zero byte in a regular file.
        fs::write(&path, b"fine\nbut\0").unwrap();
        assert_eq!(read_text_up_to(&path, 9).unwrap(), "fine\nbut\0");
        fs::write(&path, b"fine\xff").unwrap();
        assert!(refusal(&path).to_string().contains("not UTF-8 text at byte 4"));
        assert!(refusal(&path.join("below")).to_string().contains("not a directory"));
        assert!([&path, Path::new("a\0b")].iter().all(|path| refusal(path).exit_code() == 2));
    }

    #[test]
    fn bytes_and_lines_are_counted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        fs::write(&path, "1234\n1234\n").unwrap();
        assert_eq!(read_text_up_to(&path, 10).unwrap().len(), 10);
        assert!(read_text_up_to(&path, 9).unwrap_err().to_string().contains("is too large"));
        let lines =
            |line| open_text(&path, Limits { bytes: 10, line }).unwrap().lines().collect::<io::Result<Vec<_>>>();
        assert_eq!(lines(5).unwrap(), ["1234", "1234"]);
        let error = unreadable(&path, lines(4).unwrap_err());
        assert!(error.exit_code() == 2 && error.to_string().contains("a line that is too long"), "{error}");
    }
}
