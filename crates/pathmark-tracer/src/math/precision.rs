//! Floating-point formats.

/// The floating-point format of a computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Double: 53 digits.
    F64,
    /// Single: 24 digits.
    F32,
}

impl Precision {
    /// All formats, the default first.
    pub const ALL: [Self; 2] = [Self::F64, Self::F32];

    /// Its name on the command line, in CSV and TOML.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}
