//! Blocks: the parts that a page is made of.

use super::table::Table;
use crate::atomic_file;
use crate::error::{Error, Result};
use crate::plot::{Comparison, ContactSheet, Figure, Placed};
use std::path::Path;

/// One part of an experiment's section. A stem is the name of its file without the ending.
pub enum Block {
    /// The result in a sentence or two.
    Finding(String),
    /// The result in one sentence for the beginning of the page, with the name of its figure, and whether the rows tell it:
    /// `false` if their intervals leave it open.
    Answer { text: String, stem: &'static str, is_told: bool },
    /// A missing part, with the reason. It says nothing about the measurements.
    Notice(String),
    /// A figure as SVG and PNG.
    Figure { stem: &'static str, figure: Box<dyn Figure> },
    /// A PNG image of several, with its subject for readers who cannot see it, and the places of the images.
    Picture { stem: &'static str, title: String, png: Vec<u8>, comparison: Comparison, images: Vec<Placed> },
    /// A table, which is also a CSV file.
    Table { stem: &'static str, table: Table },
}

impl Block {
    pub(crate) fn finding(text: impl Into<String>) -> Self {
        Self::Finding(text.into())
    }

    pub(crate) fn notice(text: impl Into<String>) -> Self {
        Self::Notice(text.into())
    }

    /// The sentence of a finding.
    pub(crate) fn as_finding(&self) -> Option<&str> {
        if let Self::Finding(text) = self { Some(text) } else { None }
    }

    pub(crate) fn figure(stem: &'static str, figure: impl Figure + 'static) -> Self {
        Self::Figure { stem, figure: Box::new(figure) }
    }

    pub(crate) fn sheet(stem: &'static str, sheet: &ContactSheet) -> Result<Self> {
        let (png, images) = sheet.png()?;
        Ok(Self::Picture { stem, title: sheet.title.clone(), png, comparison: sheet.comparison, images })
    }

    /// The file of a figure or picture in the folder, and its title; `None` for other blocks.
    pub(crate) fn picture_file(&self) -> Option<(String, String)> {
        match self {
            Self::Figure { stem, figure } => Some((format!("{stem}.svg"), figure.drawing().title)),
            Self::Picture { stem, title, .. } => Some((format!("{stem}.png"), title.clone())),
            _ => None,
        }
    }

    /// Writes the figure, picture or table (as CSV) into the folder.
    pub fn save(&self, folder: &Path) -> Result<()> {
        std::fs::create_dir_all(folder).map_err(|e| Error::system("creating", folder, e))?;
        match self {
            Self::Finding(_) | Self::Answer { .. } | Self::Notice(_) => Ok(()),
            Self::Figure { stem, figure } => figure.save(folder, stem),
            Self::Picture { stem, png, .. } => {
                atomic_file::write(&folder.join(format!("{stem}.png")), |file| file.write_all(png))
            }
            Self::Table { stem, table } => table.save(&folder.join(format!("{stem}.csv"))),
        }
    }
}
