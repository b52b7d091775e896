//! Tables: rounded on the page, and with all digits in CSV files. They are made from lists of things: a row for each
//! thing, a column for each property.

use super::block::Block;
use crate::error::Result;
use crate::estimated::Estimated;
use crate::words::unusual_level;
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
enum TableCell {
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
                format!("{value}, {low} to {high}{}", unusual_level(interval))
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
struct Column {
    head: String,
    entries: Vec<TableCell>,
}

impl Column {
    fn bar(&self, row: usize) -> Option<[f64; 2]> {
        let ends = |entry: &TableCell| match entry {
            TableCell::Estimated(Some(told), _) => told.bar().filter(|(low, high)| low.is_finite() && high.is_finite()),
            _ => None,
        };
        let (low, high) = ends(&self.entries[row])?;
        let all: Vec<(f64, f64)> = self.entries.iter().filter_map(ends).collect();
        let least = all.iter().map(|(low, _)| *low).fold(f64::INFINITY, f64::min);
        let most = all.iter().map(|(_, high)| *high).fold(f64::NEG_INFINITY, f64::max);
        let place = |value: f64| (value - least) / (most - least);
        (all.len() > 1 && most > least).then(|| [place(low), place(high)])
    }

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
    length: usize,
    columns: Vec<Column>,
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

    /// For each cell of a row the place of its interval, from 0 to 1 between the ends of the column's intervals; `None`
    /// without several intervals to compare.
    pub(crate) fn bars(&self, row: usize) -> impl Iterator<Item = Option<[f64; 2]>> {
        self.columns.iter().map(move |column| column.bar(row))
    }

    /// Whether a value has an interval.
    pub(crate) fn has_intervals(&self) -> bool {
        let has_interval =
            |entry: &TableCell| matches!(entry, TableCell::Estimated(Some(told), _) if told.interval.is_some());
        self.columns.iter().flat_map(|column| &column.entries).any(has_interval)
    }

    /// Whether a column has no value in any row.
    pub(crate) fn is_blank(&self, column: usize) -> bool {
        let is_nothing = |entry: &TableCell| matches!(entry.shown().as_str(), "" | NONE);
        self.columns[column].entries.iter().all(is_nothing)
    }

    pub(crate) fn save(&self, path: &Path) -> Result<()> {
        let heads: Vec<String> = self.columns.iter().flat_map(Column::heads).collect();
        let row = |row: usize| self.columns.iter().flat_map(|column| column.entries[row].written()).collect();
        csv_file::write(path, std::iter::once(heads).chain((0..self.length).map(row)))
    }
}

/// A table whose columns are being added.
pub(crate) struct Columns<T> {
    stem: &'static str,
    table: Table,
    things: Vec<T>,
}

impl Block {
    /// Starts a table with a row for each item; its columns follow. `stem` is its file's name without the ending.
    pub(crate) fn table<T>(
        stem: &'static str,
        title: impl Into<String>,
        things: impl IntoIterator<Item = T>,
    ) -> Columns<T> {
        let things: Vec<T> = things.into_iter().collect();
        Columns { stem, table: Table { title: title.into(), length: things.len(), columns: Vec::new() }, things }
    }
}

impl<T> Columns<T> {
    fn add(mut self, head: impl Into<String>, entry: impl Fn(&T) -> TableCell) -> Self {
        self.table.columns.push(Column { head: head.into(), entries: self.things.iter().map(entry).collect() });
        self
    }

    /// Adds a column of text: its head, and the text for an item.
    pub(crate) fn column(self, head: impl Into<String>, text: impl Fn(&T) -> String) -> Self {
        self.add(head, |thing| TableCell::Text(text(thing)))
    }

    pub(crate) fn number<N: Into<Option<f64>>>(
        self,
        head: impl Into<String>,
        digits: Digits,
        value: impl Fn(&T) -> N,
    ) -> Self {
        self.add(head, |thing| TableCell::Number(value(thing).into(), digits))
    }

    pub(crate) fn estimated<N: Into<Option<Estimated>>>(
        self,
        head: impl Into<String>,
        digits: Digits,
        value: impl Fn(&T) -> N,
    ) -> Self {
        self.add(head, |thing| TableCell::Estimated(value(thing).into(), digits))
    }

    pub(crate) fn end(self) -> Block {
        Block::Table { stem: self.stem, table: self.table }
    }
}

#[cfg(test)]
mod tests {
    use super::Digits::{Decimals, Significant};
    use super::*;
    use crate::analysis::Interval;

    /// The page rounds, the file does not. In the file a value with an interval takes four columns; without an interval
    /// three of them are empty.
    #[test]
    fn files_have_all_digits_and_ends_of_intervals() {
        let third = 1.0 / 3.0;
        let interval = Interval { low: 0.25, high: 0.5, level: 0.96875 };
        let rows = [Some(Estimated::of(third, Some(interval))), Some(Estimated::of(2.0, None)), None];
        let block = Block::table("table", "A table", rows)
            .column("name", |told| format!("{}", told.is_some()))
            .number("value", Significant(2), |told| told.map(|told| told.value))
            .estimated("ratio", Decimals(2), |told| *told)
            .end();
        let Block::Table { table, .. } = &block else { panic!("a table") };
        let shown: Vec<Vec<String>> = table.rows().collect();
        assert_eq!(shown[0], ["true", "0.33", "0.33, 0.25 to 0.50 (96.8 %)"]);
        assert_eq!(shown[1], ["true", "2", "2.00, no interval"]);
        assert_eq!(shown[2], ["false", "-", "-"]);
        let folder = tempfile::tempdir().unwrap();
        block.save(folder.path()).unwrap();
        let text = std::fs::read_to_string(folder.path().join("table.csv")).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "name,value,ratio,ratio: low,ratio: high,ratio: confidence");
        assert_eq!(lines[1], format!("true,{third},{third},0.25,0.5,0.96875"));
        assert_eq!(lines[2..], ["true,2,2,,,", "false,,,,,"]);
    }

    /// Intervals 0 to 1 and 2 to 4 lie at the first quarter and the second half of their column.
    #[test]
    fn intervals_have_places_in_their_column_and_blank_columns_are_known() {
        let told = |low: f64, high: f64| Estimated::of(0.5 * (low + high), Some(Interval { low, high, level: 0.95 }));
        let block = Block::table("table", "A table", [told(0.0, 1.0), told(2.0, 4.0)])
            .column("nothing", |_| String::new())
            .number("missing", Decimals(1), |_| None)
            .estimated("ratio", Decimals(1), |told| *told)
            .end();
        let Block::Table { table, .. } = &block else { panic!("a table") };
        assert_eq!([0, 1, 2].map(|column| table.is_blank(column)), [true, true, false]);
        let bars = |row| table.bars(row).collect::<Vec<_>>();
        assert_eq!(bars(0), [None, None, Some([0.0, 0.25])]);
        assert_eq!(bars(1), [None, None, Some([0.5, 1.0])]);
        assert_eq!(table.rows().next().unwrap()[2], "0.5, 0.0 to 1.0");
    }
}
