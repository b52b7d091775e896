//! Figures: plain data in, SVG and PNG out.
//!
//! Code that cannot fail turns a chart into a [`Drawing`], a list of marks in pixels that tests can inspect. The marks
//! become elements of an SVG, or pixels by plotters. Text is set in an embedded font. So no font has to be installed, and
//! equal data gives equal bytes.

pub mod axis;
mod colour_bar;
pub mod contact_sheet;
pub mod dot_plot;
pub mod drawing;
mod end_labels;
pub mod font;
mod frame;
pub mod gantt;
pub mod heat_map;
pub mod legend;
pub mod line_chart;
mod marker;
pub mod number;
pub mod overlay;
mod paint;
pub mod panels;
#[cfg(test)]
mod schedule_tests;
pub mod stacked_bar;
pub mod style;
pub(crate) mod svg;
#[cfg(test)]
mod tests;
mod title;

use std::path::Path;

use crate::atomic_file;
use crate::error::{Error, Result};

pub use axis::{Axis, Scale};
pub use contact_sheet::{Cell, ColourBar, Comparison, ContactSheet, Placed};
pub use dot_plot::{Dot, DotPlot, DotRow};
pub use drawing::Drawing;
pub use gantt::{GanttChart, JobBar, Schedule};
pub use heat_map::{HeatMap, Tile};
pub use line_chart::{LineChart, Point, Series, Spread};
pub use overlay::{Curve, Overlay};
pub use panels::Panels;
pub use stacked_bar::{Piece, StackPart, StackRow, StackedBars};
pub use title::Title;

/// A figure that can be drawn as vectors and as pixels, by any thread.
pub trait Figure: Sync {
    fn drawing(&self) -> Drawing;

    /// The same figure on other axes, and the name of those axes, for a page to switch to.
    fn other_axes(&self) -> Option<(&'static str, Drawing)> {
        None
    }

    /// Data of single jobs for a page, as JSON.
    fn data(&self) -> Option<String> {
        None
    }

    /// The figure as a complete SVG document, which can be embedded in an HTML page unchanged.
    fn svg(&self) -> Result<String> {
        svg::svg(&self.drawing())
    }

    /// The figure as a PNG file, with twice the width and height of the SVG.
    fn png(&self) -> Result<Vec<u8>> {
        paint::png(&paint::pixels(&self.drawing(), paint::SCALE)?)
    }

    /// Writes `stem.svg` and `stem.png` into `dir`, which is created if needed.
    fn save(&self, dir: &Path, stem: &str) -> Result<()> {
        let (svg, png) = (self.svg()?, self.png()?);
        std::fs::create_dir_all(dir).map_err(|error| Error::system("creating", dir, error))?;
        atomic_file::write(&dir.join(format!("{stem}.svg")), |file| file.write_all(svg.as_bytes()))?;
        atomic_file::write(&dir.join(format!("{stem}.png")), |file| file.write_all(&png))
    }
}
