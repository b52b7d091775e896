//! Rows that are left out: they were not run, because the machine lacks what they need.

use super::{Record, Warning};
use std::collections::BTreeMap;
use std::fmt;

impl Record {
    fn has(&self, warning: &Warning) -> bool {
        self.warnings.split(';').any(|own| own == warning.to_string())
    }

    /// Whether it was not run, because the machine has no device for it.
    pub fn lacks_device(&self) -> bool {
        self.has(&Warning::NoDevice)
    }

    /// The missing program or device, in words; `None` if the row was run.
    pub(crate) fn lacks(&self) -> Option<String> {
        if self.lacks_device() {
            let kernel = &self.kernel;
            return Some(format!("kernel {kernel}: neither CUDA nor OpenCL finds a GPU on this machine"));
        }
        self.has(&Warning::NoProgram).then(|| match self.ranks {
            Some(_) => "several processes: there is no launcher such as mpiexec on this machine".to_string(),
            None => format!("{}: its program is not on this machine", self.estimator),
        })
    }

    pub fn is_left_out(&self) -> bool {
        self.lacks().is_some()
    }
}

/// The number of rows that were left out, by the reason.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LeftOut {
    by_reason: BTreeMap<String, usize>,
}

impl LeftOut {
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a Record>) -> Self {
        let mut left_out = Self::default();
        rows.into_iter().for_each(|row| left_out.add(row));
        left_out
    }

    pub fn add(&mut self, row: &Record) {
        if let Some(reason) = row.lacks() {
            *self.by_reason.entry(reason).or_default() += 1;
        }
    }

    pub fn merge(&mut self, other: &Self) {
        for (reason, count) in &other.by_reason {
            *self.by_reason.entry(reason.clone()).or_default() += count;
        }
    }

    pub fn count(&self) -> usize {
        self.by_reason.values().sum()
    }

    /// A line for each reason: the number of rows, and what they lack.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        let rows = |count: usize| if count == 1 { "1 row".to_string() } else { format!("{count} rows") };
        self.by_reason.iter().map(move |(reason, count)| format!("{} of {reason}", rows(*count)))
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "left out: {}", self.lines().collect::<Vec<_>>().join("; "))
    }
}
