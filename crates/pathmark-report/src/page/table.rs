//! Tables: rounded on the page, and with all digits in CSV files.

use crate::error::Result;
use crate::estimated::Estimated;
use crate::{csv_file, plot};
use std::path::Path;

/// The number of digits that the page shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Digits {
    Decimals(usize),
    Significant(usize),
}

impl Digits {
    fn show(self, value: f64) -> String {
        match self {
            Self::Decimals(digits) => format!("{value:.digits$}"),
            Self::Significant(digits) => plot::number::short(value, digits),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum TableCell {
    Text(String),
    Number(Option<f64>, Digits),
    Estimated(Option<Estimated>, Digits),
}

/// The page's text for a missing number.
const NONE: &str = "-";

impl TableCell {
    fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(None, _) | Self::Estimated(None, _) => NONE.to_string(),
            Self::Number(Some(value), digits) => digits.show(*value),
            Self::Estimated(Some(Estimated { value, interval: None, .. }), digits) => {
                format!("{}, no interval", digits.show(*value))
            }
            Self::Estimated(Some(Estimated { value, interval: Some(interval), .. }), digits) => {
                let [value, low, high] = [*value, interval.low, interval.high].map(|number| digits.show(number));
                format!("{value}, {low} to {high} ({:.1} %)", 100.0 * interval.level)
            }
        }
    }

    /// Its cells in a CSV file, as many as [`Column::heads`] returns.
    fn written(&self) -> Vec<String> {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        match self {
            Self::Text(text) => vec![text.clone()],
            Self::Number(value, _) => vec![number(*value)],
            Self::Estimated(told, _) => {
                let interval = told.and_then(|told| told.interval);
                let ends = [interval.map(|i| i.low), interval.map(|i| i.high), interval.map(|i| i.level)];
                [told.map(|told| told.value)].into_iter().chain(ends).map(number).collect()
            }
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) head: String,
    pub(super) entries: Vec<TableCell>,
}

impl Column {
    /// Its heads in a CSV file; a value with an interval has four.
    fn heads(&self) -> Vec<String> {
        let head = &self.head;
        if self.entries.iter().any(|entry| matches!(entry, TableCell::Estimated(..))) {
            return vec![head.clone(), format!("{head}: low"), format!("{head}: high"), format!("{head}: confidence")];
        }
        vec![head.clone()]
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub title: String,
    pub(super) length: usize,
    pub(super) columns: Vec<Column>,
}

impl Table {
    /// A table of text alone; each row has a cell for each head.
    pub(crate) fn of_text(title: impl Into<String>, heads: &[&str], rows: &[Vec<String>]) -> Self {
        let column = |(index, head): (usize, &&str)| Column {
            head: (*head).to_string(),
            entries: rows.iter().map(|row| TableCell::Text(row[index].clone())).collect(),
        };
        let columns = heads.iter().enumerate().map(column).collect();
        Self { title: title.into(), length: rows.len(), columns }
    }

    pub fn len(&self) -> usize {
        self.length
    }

    pub fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// The heads of its columns, as the page shows them.
    pub fn heads(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.head.as_str())
    }

    /// Its rows, as the page shows them.
    pub fn rows(&self) -> impl Iterator<Item = Vec<String>> {
        (0..self.length).map(|row| self.columns.iter().map(|column| column.entries[row].shown()).collect())
    }

    pub(crate) fn save(&self, path: &Path) -> Result<()> {
        let heads: Vec<String> = self.columns.iter().flat_map(Column::heads).collect();
        let row = |row: usize| self.columns.iter().flat_map(|column| column.entries[row].written()).collect();
        csv_file::write(path, std::iter::once(heads).chain((0..self.length).map(row)))
    }
}
