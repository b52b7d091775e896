//! What a page is made of.

use crate::atomic_file;
use crate::error::{Error, Result};
use crate::plot::{ContactSheet, Figure};
use serde::Serialize;
use std::path::Path;

/// Columns of text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// Heads of the columns, with units.
    pub columns: Vec<String>,
    /// Rows, as wide as the heads.
    pub rows: Vec<Vec<String>>,
}

/// One part of an experiment's section.
pub enum Block {
    /// What the numbers say, in a sentence or two.
    Finding(String),
    /// A figure as SVG and PNG.
    Figure {
        /// File name without its ending.
        stem: &'static str,
        /// The drawing.
        figure: Box<dyn Figure>,
    },
    /// A picture made of pixels.
    Picture {
        /// File name without its ending.
        stem: &'static str,
        /// What it shows, for who cannot see it.
        title: String,
        /// The PNG file.
        png: Vec<u8>,
    },
    /// A table.
    Table {
        /// File name without its ending.
        stem: &'static str,
        /// The table.
        table: Table,
    },
}

impl Block {
    pub(super) fn finding(text: impl Into<String>) -> Self {
        Self::Finding(text.into())
    }

    /// The sentence of a finding.
    pub(super) fn as_finding(&self) -> Option<&str> {
        if let Self::Finding(text) = self { Some(text) } else { None }
    }

    pub(super) fn figure(stem: &'static str, figure: impl Figure + 'static) -> Self {
        Self::Figure { stem, figure: Box::new(figure) }
    }

    /// A sheet of pictures.
    pub(super) fn sheet(stem: &'static str, sheet: &ContactSheet) -> Result<Self> {
        Ok(Self::Picture { stem, title: sheet.title.clone(), png: sheet.png()? })
    }

    /// A table with a row for each thing; its columns follow.
    pub(super) fn table<T>(
        stem: &'static str,
        title: impl Into<String>,
        things: impl IntoIterator<Item = T>,
    ) -> Columns<T> {
        let things: Vec<T> = things.into_iter().collect();
        let table = Table { title: title.into(), columns: Vec::new(), rows: vec![Vec::new(); things.len()] };
        Columns { stem, table, things }
    }

    /// Writes figure, picture or table (as CSV) into the folder.
    pub(super) fn save(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder).map_err(|e| Error::system("creating", folder, e))?;
        match self {
            Self::Finding(_) => Ok(()),
            Self::Figure { stem, figure } => figure.save(folder, stem),
            Self::Picture { stem, png, .. } => {
                atomic_file::write(&folder.join(format!("{stem}.png")), |file| file.write_all(png))
            }
            Self::Table { stem, table } => {
                let path = folder.join(format!("{stem}.csv"));
                let mut writer = csv::Writer::from_writer(Vec::new());
                let rows = std::iter::once(&table.columns).chain(&table.rows);
                let written = rows.map(|row| writer.write_record(row)).collect::<csv::Result<Vec<()>>>();
                let system = |e: std::io::Error| Error::system("writing", &path, e);
                written.map_err(|e| system(e.into()))?;
                let bytes = writer.into_inner().map_err(|e| system(e.into_error()))?;
                atomic_file::write(&path, |file| file.write_all(&bytes))
            }
        }
    }
}

/// A table whose columns are being added.
pub(super) struct Columns<T> {
    stem: &'static str,
    table: Table,
    things: Vec<T>,
}

impl<T> Columns<T> {
    /// A column: its head, and what it says of a thing.
    pub(super) fn column(mut self, head: impl Into<String>, cell: impl Fn(&T) -> String) -> Self {
        self.table.columns.push(head.into());
        for (row, thing) in self.table.rows.iter_mut().zip(&self.things) {
            row.push(cell(thing));
        }
        self
    }

    pub(super) fn end(self) -> Block {
        Block::Table { stem: self.stem, table: self.table }
    }
}
