//! The places of faults in a ledger: line and column, from the spans of the TOML parser.

use crate::input::line_and_column;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// The part of a ledger that an error is about.
#[derive(Debug, Clone, Copy)]
pub(super) enum Part {
    Head,
    /// The table with this index.
    Table(usize),
    /// The claim with this index.
    Claim(usize),
}

/// Line and column of a field's value, or of its name if `value` is empty; of the part if it has no such field. A field
/// may name one within it, too: `rows.program`.
pub(super) fn place(text: &str, part: Part, field: &str, value: &str) -> Option<(usize, usize)> {
    let root = DeTable::parse(text).ok()?;
    let item = |name: &str, index: usize| root.get_ref().get(name)?.get_ref().as_array()?.get(index);
    let (table, start) = match part {
        Part::Head => (root.get_ref(), 0),
        Part::Table(index) => of_item(item("table", index)?)?,
        Part::Claim(index) => of_item(item("claim", index)?)?,
    };
    Some(line_and_column(text, within(table, text, field, value).unwrap_or(start)))
}

fn of_item<'a, 'i>(item: &'a Spanned<DeValue<'i>>) -> Option<(&'a DeTable<'i>, usize)> {
    Some((item.get_ref().as_table()?, item.span().start))
}

/// The offset of a value of a field, of the field's whole value, or of its name.
fn within(table: &DeTable<'_>, text: &str, field: &str, value: &str) -> Option<usize> {
    let (field, inner) = field.split_once('.').map_or((field, None), |(field, inner)| (field, Some(inner)));
    let (key, whole) = table.get_key_value(field)?;
    if value.is_empty() {
        return Some(key.span().start);
    }
    let inner = inner.and_then(|inner| whole.get_ref().as_table()?.get(inner));
    let own = inner.unwrap_or(whole);
    Some(found(own, text, value).unwrap_or(own.span().start))
}

/// The offset of the first key or value that is so written.
fn found(own: &Spanned<DeValue<'_>>, text: &str, wanted: &str) -> Option<usize> {
    let written = match own.get_ref() {
        DeValue::Array(items) => return items.iter().find_map(|item| found(item, text, wanted)),
        DeValue::Table(table) => {
            let of_entry = |(key, value): (&Spanned<DeString<'_>>, &Spanned<DeValue<'_>>)| {
                let is_key = key.get_ref().as_ref() == wanted;
                if is_key { Some(key.span().start) } else { found(value, text, wanted) }
            };
            return table.iter().find_map(of_entry);
        }
        DeValue::String(written) => written.as_ref(),
        _ => text.get(own.span())?,
    };
    (written == wanted).then(|| own.span().start)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "report = \"a\" # id = 1\r\n[[table]]\r\nname='t'\r\n[[claim]] # first\r\nid=1\r\nquote = '''\r\nid = 2\r\n'''\r\n\
                        [[claim]]\r\n  id = 1 # again\r\nrows = { n = [1, 20], \"p q\" = \"x\" }\r\n[claim.over]\r\nn = 5\r\n";

    /// Comments, line ends of Windows, missing spaces, quoted text and a number that occurs twice mislead nobody.
    #[test]
    fn places_are_those_of_the_parser() {
        for (part, field, value, expected) in [
            (Part::Head, "report", "a", (1, 10)),
            (Part::Head, "title", "", (1, 1)),
            (Part::Table(0), "name", "", (3, 1)),
            (Part::Table(0), "name", "t", (3, 6)),
            (Part::Claim(0), "id", "1", (5, 4)),
            (Part::Claim(1), "id", "1", (10, 8)),
            (Part::Claim(1), "id", "", (10, 3)),
            (Part::Claim(1), "rows", "n", (11, 10)),
            (Part::Claim(1), "rows.n", "20", (11, 18)),
            (Part::Claim(1), "rows.p q", "x", (11, 31)),
            (Part::Claim(1), "rows", "none", (11, 8)),
            (Part::Claim(1), "over.n", "5", (13, 5)),
            (Part::Claim(1), "level", "2", (9, 1)),
        ] {
            assert_eq!(place(TEXT, part, field, value), Some(expected), "{part:?} {field} {value}");
        }
        assert_eq!(place(TEXT, Part::Claim(2), "id", "1"), None);
    }
}
