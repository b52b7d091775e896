//! Small multiples: a large chart with names and words, and small ones of the same lines below it.

use super::Figure;
use super::drawing::{Align, Drawing};
use super::font;
use super::frame::{self, Frame, WIDTH};
use super::line_chart::LineChart;
use super::style::{INK, LEADING, MARGIN, SMALL_SIZE, TEXT_SIZE};

/// Height of the data area of a small chart.
const HEIGHT: f64 = 220.0;
/// Space between small charts.
const GAP: f64 = 20.0;

/// Lines of one name have the same look in all charts, so only the large one names them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panels {
    /// The large chart; its caption is that of the figure.
    pub main: LineChart,
    /// The small charts, up to three in a row. Only their titles and data are drawn.
    pub others: Vec<LineChart>,
}

impl Figure for Panels {
    fn drawing(&self) -> Drawing {
        let main = LineChart { caption: String::new(), ..self.main.clone() };
        let mut drawing = main.drawing();
        let columns = self.others.len().clamp(1, 3);
        let width = (WIDTH - 2.0 * MARGIN - GAP * (columns - 1) as f64) / columns as f64;
        let mut top = drawing.height;
        for row in self.others.chunks(columns) {
            let mut end = top;
            for (column, chart) in row.iter().enumerate() {
                let left = MARGIN + column as f64 * (width + GAP);
                let mut title_end = top;
                for line in font::wrap(chart.title.head(), TEXT_SIZE, width) {
                    drawing.text((left, title_end + 0.5 * TEXT_SIZE), &line, TEXT_SIZE, INK, Align::Left);
                    title_end += TEXT_SIZE * LEADING;
                }
                let area = [left, title_end + 6.0, left + width, title_end + 6.0 + HEIGHT];
                let frame = Frame::within(&mut drawing, area, (&chart.x, &chart.y), chart.ranges());
                chart.draw_data(&mut drawing, &frame);
                end = end.max(frame.end() + TEXT_SIZE + GAP);
            }
            top = end;
        }
        let end = frame::words_below(&mut drawing, &self.main.caption, top);
        drawing.height = (end + SMALL_SIZE).ceil();
        drawing
    }
}
