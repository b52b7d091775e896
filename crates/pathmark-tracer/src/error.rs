//! Errors, sorted by cause: the user's input (exit code 2), the system (3), or a failed check (1).

use std::borrow::Cow;
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// The result of an operation that the user's input or the system can make fail.
pub type Result<T> = std::result::Result<T, Error>;

/// A failure, sorted by who can fix it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The user's input is wrong. Nothing has been written.
    #[error("{0}")]
    Input(Box<InputError>),
    /// A self-check failed: a checksum, a coverage, a strict rule.
    #[error("check failed: {0}")]
    Check(String),
    /// The system refused an operation: disk, memory, threads, processes.
    #[error("{action} {}: {source}", printable(&path.to_string_lossy()))]
    System {
        /// The attempted action, as a gerund: "writing".
        action: &'static str,
        /// The file or other object of the action.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
}

impl Error {
    /// The process's exit code for this failure.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Check(_) => 1,
            Self::Input(_) => 2,
            Self::System { .. } => 3,
        }
    }

    /// Creates the error of a system that refused `action` on `path`.
    pub fn system(action: &'static str, path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Self::System { action, path: path.as_ref().to_path_buf(), source }
    }

    /// Lets `place` add the place to an input error that has none; other errors stay.
    #[must_use]
    pub fn placed(self, place: impl FnOnce(InputError) -> Self) -> Self {
        match self {
            Self::Input(input) if input.place.is_none() => place(*input),
            other => other,
        }
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Self {
        Self::Input(Box::new(error))
    }
}

/// A position in a text file; lines and columns count from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file's name as the user gave it, or the name of the embedded file.
    pub file: String,
    /// Line and column, if known.
    pub at: Option<(usize, usize)>,
}

/// An error in a value that the user gave.
///
/// ```
/// # use pathmark_tracer as pathmark;
/// use pathmark::error::InputError;
/// let error = InputError::new("--spp", "0", "must be at least 1").allowed("1 to 16777216");
/// assert_eq!(error.to_string(), "--spp = 0: must be at least 1 (allowed: 1 to 16777216)");
/// let error = InputError::new("radius", "-1", "must be positive").in_file("box.toml", Some((4, 10)));
/// assert_eq!(error.to_string(), "box.toml:4:10: radius = -1: must be positive");
/// let error = InputError::new("sampler", "sobel", "there is no such sampler").allowed("hash, sobol");
/// assert!(error.to_string().starts_with("sampler = sobel: there is no such sampler; did you mean sobol?"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputError {
    /// Its position, if the value came from a file.
    pub place: Option<Place>,
    /// The field, option or column.
    pub field: String,
    /// The value as the user wrote it; empty when there is none.
    pub value: String,
    pub problem: String,
    /// The allowed values; empty when `problem` already names them.
    pub allowed: String,
}

impl InputError {
    /// Creates an error: `problem` says why `field` can't be `value`.
    pub fn new(field: impl Into<String>, value: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { place: None, field: field.into(), value: value.into(), problem: problem.into(), allowed: String::new() }
    }

    /// Adds the allowed values.
    #[must_use]
    pub fn allowed(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = allowed.into();
        self
    }

    /// Adds the file and, if known, line and column.
    #[must_use]
    pub fn in_file(mut self, file: impl Into<String>, at: Option<(usize, usize)>) -> Self {
        self.place = Some(Place { file: file.into(), at });
        self
    }
}

/// Names below this similarity, from 0 to 1, are not suggested.
const SIMILAR: f64 = 0.65;
/// Shorter values are about equally similar to many names.
const SHORTEST_NAME: usize = 3;

impl InputError {
    /// The allowed name that is most similar to the value, as after a typing error.
    fn meant(&self) -> Option<&str> {
        let is_name = |text: &str| text.len() >= SHORTEST_NAME && text.starts_with(char::is_alphabetic);
        if !is_name(&self.value) {
            return None;
        }
        // If the name is right, its parameter is wrong, and the same name would not help.
        let right = self.value.split_once(':').map(|(name, _)| name);
        let is_other = |name: &&str| is_name(name) && !name.contains(' ') && name.split(':').next() != right;
        let names = self.allowed.split(", ").filter(is_other);
        let rated = names.map(|name| (strsim::normalized_damerau_levenshtein(&self.value, name), name));
        let (similarity, name) = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (SIMILAR..1.0).contains(&similarity).then_some(name)
    }
}

/// Returns a text with every control character escaped as in Rust: a terminal would obey it, and a line end would make
/// one message look like two.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return text.into();
    }
    let escape = |c: char| if c.is_control() { c.escape_default().collect() } else { String::from(c) };
    text.chars().map(escape).collect::<String>().into()
}

/// A writer that escapes control characters.
struct Printable<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl Write for Printable<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.write_str(&printable(text))
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let f = &mut Printable(f);
        if let Some(place) = &self.place {
            write!(f, "{}:", place.file)?;
            if let Some((line, column)) = place.at {
                write!(f, "{line}:{column}:")?;
            }
            f.write_str(" ")?;
        }
        f.write_str(&self.field)?;
        if !self.value.is_empty() {
            write!(f, " = {}", self.value)?;
        }
        write!(f, ": {}", self.problem)?;
        if let Some(name) = self.meant() {
            write!(f, "; did you mean {name}?")?;
        }
        if !self.allowed.is_empty() {
            write!(f, " (allowed: {})", self.allowed)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A control character of a value, a key or a file's name could colour a terminal, move its cursor or end a line.
    #[test]
    fn control_characters_are_escaped() {
        let error =
            InputError::new("a\u{1b}[2J", "\u{7}b\n", "c\t\u{9b}31m").allowed("d\r").in_file("e\0", Some((1, 2)));
        let expected = "e\\u{0}:1:2: a\\u{1b}[2J = \\u{7}b\\n: c\\t\\u{9b}31m (allowed: d\\r)";
        assert_eq!(error.to_string(), expected);
        assert_eq!(Error::from(error).to_string(), expected);
        let system = Error::system("writing", "a\u{1b}", std::io::ErrorKind::NotFound.into());
        assert_eq!(system.to_string(), "writing a\\u{1b}: entity not found");
        assert!(matches!(printable("plain \u{e4}"), Cow::Borrowed(_)));
    }

    #[test]
    fn names_are_suggested_only_for_wrong_names() {
        let meant = |value: &str| {
            InputError::new("decomposition", value, "is wrong").allowed("rows, bands:20").meant().map(String::from)
        };
        assert_eq!(meant("rws").as_deref(), Some("rows"));
        assert_eq!(meant("band:0").as_deref(), Some("bands:20"));
        assert_eq!((meant("bands:0"), meant("rows:1")), (None, None));
    }
}
