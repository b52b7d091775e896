//! Tables from lists of things: a row for each thing, a column for each property.

use super::block::Block;
use super::table::{Column, Digits, Table, TableCell};
use crate::estimated::Estimated;

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
        assert_eq!(shown[0], ["true", "0.33", "0.33, 0.25 to 0.50 (96.9 %)"]);
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
}
