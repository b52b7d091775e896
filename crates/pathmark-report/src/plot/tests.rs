//! Tests of whole figures: nothing is clipped, overlaps or fails, and the bytes are the same each time.

use super::drawing::{Align, Mark, Part, PartKind, Text};
use super::style::{GRID, Look};
use super::{
    Axis, Cell, ColourBar, ContactSheet, Curve, Drawing, Figure, LineChart, Overlay, Point, Scale, Series, Spread,
    font, paint,
};

const THREADS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// A speedup chart with `count` series.
fn speedups(count: usize) -> LineChart {
    let curve =
        |i: usize| THREADS.map(|p| Point::new(p, p * 0.9 - 0.02 * i as f64).with_y(Some((p * 0.8, p)))).to_vec();
    let series = (0..count).map(|i| Series::new(format!("strategy-number-{i}"), Look::nth(i), curve(i))).collect();
    let (x, y) = (Axis::log("threads").ticks_at(THREADS), Axis::linear("speedup").including([0.0]));
    let mut chart = LineChart::new("Speedup <against> threads & more", x, y, series);
    chart.subtitle = "cornell; ".repeat(30);
    chart.caption = "A caption of some length. ".repeat(8);
    chart.overlays = vec![
        Overlay::guide("ideal", Curve::Line { intercept: 0.0, slope: 1.0 }),
        Overlay::fit("a fit with a long annotation\nover two lines", Curve::Line { intercept: 0.1, slope: 0.8 }, 0),
    ];
    chart
}

fn chart_of(points: Vec<Point>, scale: Scale) -> LineChart {
    let axis = |label: &str| if scale == Scale::Log { Axis::log(label) } else { Axis::linear(label) };
    LineChart::new("t", axis("x"), axis("y"), vec![Series::new("s", Look::nth(0), points)])
}

pub(super) fn says(drawing: &Drawing, what: &str) -> bool {
    drawing.texts().any(|text| text.text.contains(what))
}

impl Text {
    /// Left, top, right and bottom of its bounding box.
    pub fn bounds(&self) -> [f64; 4] {
        let (width, half) = (font::width(&self.text, self.size), 0.5 * self.size);
        let before = match self.align {
            Align::Left => 0.0,
            Align::Centre => 0.5 * width,
            Align::Right => width,
        };
        let (x, y) = self.at;
        if self.upwards {
            [x - half, y + before - width, x + half, y + before]
        } else {
            [x - before, y - half, x - before + width, y + half]
        }
    }
}

/// Asserts that every text is inside the drawing, and that no two overlap.
pub(super) fn assert_legible(drawing: &Drawing) {
    let bounds: Vec<(&Text, [f64; 4])> = drawing.texts().map(|text| (text, text.bounds())).collect();
    for (i, (text, [left, top, right, bottom])) in bounds.iter().enumerate() {
        let inside = *left >= 0.0 && *top >= 0.0 && *right <= drawing.width && *bottom <= drawing.height;
        assert!(inside, "{:?} at {left} {top} {right} {bottom}", text.text);
        for (other, [l, t, r, b]) in &bounds[..i] {
            let apart = right <= l || r <= left || bottom <= t || b <= top;
            assert!(apart, "{:?} lies over {:?}", text.text, other.text);
        }
    }
}

#[test]
fn same_data_same_bytes() {
    let chart = speedups(8);
    assert_eq!(chart.svg().unwrap(), speedups(8).svg().unwrap());
    assert_eq!(chart.png().unwrap(), speedups(8).png().unwrap());
}

#[test]
fn equal_lines_are_one_with_both_names() {
    let mut chart = speedups(3);
    chart.series[2].points = chart.series[0].points.clone();
    let marks =
        |drawing: &Drawing| drawing.marks.iter().filter(|m| matches!(m, Mark::Path { .. } | Mark::Area { .. })).count();
    for spread in [Spread::Bars, Spread::Band] {
        chart.series.iter_mut().for_each(|series| series.spread = spread);
        let drawing = chart.drawing();
        assert!(says(&drawing, "strategy-number-0 ="), "both names");
        // As many marks as for two series, but a note for each value of all three.
        let two = LineChart { series: chart.series[..2].to_vec(), ..chart.clone() }.drawing();
        assert_eq!(marks(&drawing), marks(&two), "{spread:?}");
        assert_eq!(chart.svg().unwrap().matches("strategy-number-2: ").count(), 4);
        assert_legible(&drawing);
    }
}

#[test]
fn text_is_legible_and_the_legend_beside_the_data() {
    for count in [1, 8, 32] {
        let drawing = speedups(count).drawing();
        assert_legible(&drawing);
        let grid_ends = drawing.marks.iter().filter_map(|mark| match mark {
            Mark::Path { places, colour, .. } if *colour == GRID => places.iter().map(|p| p.0).reduce(f64::max),
            _ => None,
        });
        let data_ends = grid_ends.fold(0.0, f64::max);
        let legend = drawing.texts().filter(|text| text.text.starts_with("strategy-number"));
        assert!(legend.map(|text| text.bounds()[0]).all(|left| left > data_ends));
    }
}

/// The series that the legends of a drawing name, from top to bottom.
fn legend_parts(drawing: &Drawing) -> Vec<&str> {
    let legends = drawing.parts.iter().filter(|part| part.kind == PartKind::Legend);
    legends.map(|part| part.series.as_str()).collect()
}

/// Lines that end in the order of their numbers, with a guide above them and a fit that goes with the first line.
#[test]
fn lines_are_named_at_their_ends_where_the_names_fit() {
    let named = |count: usize| {
        let fit = Overlay::fit("fit", Curve::Line { intercept: 0.1, slope: 0.8 }, 0);
        let overlays = vec![Overlay::guide("ideal", Curve::Line { intercept: 0.0, slope: 1.0 }), fit];
        LineChart { overlays, ..speedups(count) }.drawing()
    };
    let drawing = named(8);
    assert_legible(&drawing);
    assert!(says(&drawing, "strategy-number-0 (fit)"));
    let names: Vec<String> = (0..8).map(|i| format!("strategy-number-{i}")).collect();
    let expected: Vec<&str> = std::iter::once("ideal").chain(names.iter().map(String::as_str)).collect();
    assert_eq!(legend_parts(&drawing), expected);
    // A reader who switches the first line off switches its fit off.
    let is_of = |part: &Part, name: &str| part.kind == PartKind::Series && part.series == name;
    let of = |name: &str| drawing.parts.iter().filter(|part| is_of(part, name)).count();
    assert_eq!((of("strategy-number-0"), of("fit")), (2, 0));
    // Forty names do not fit.
    assert!(!says(&named(40), "strategy-number-0 (fit)"));
    assert_legible(&named(40));
    // A line without a point has no end.
    let mut empty = speedups(2);
    empty.series[1].points.clear();
    assert!(says(&empty.drawing(), "strategy-number-1 (no data)"));
}

#[test]
fn svg_names_its_fonts_and_escapes_its_words() {
    let svg = speedups(2).svg().unwrap();
    assert!(svg.starts_with("<svg width=\"960\"") && svg.trim_end().ends_with("</svg>"));
    assert!(svg.contains("font-family=\"DejaVu Sans, sans-serif\""));
    assert!(svg.contains("<title>Speedup &lt;against&gt; threads &amp; more</title>"));
}

#[test]
fn hard_data_gives_figures() {
    let span = |x, y, low, high| Point::new(x, y).with_y(Some((low, high))).with_x(Some((low, high)));
    let cases = [
        vec![Point::new(3.0, 4.0)],
        vec![Point::new(0.0, 0.0)],
        vec![Point::new(2.0, 5.0); 3],
        vec![Point::new(1e-300, 1e300), Point::new(1e300, 1e-300)],
        vec![Point::new(-1e300, -1e300), Point::new(1e300, 1e300)],
        vec![Point::new(1e15, 1.0), Point::new(1e15 + 1.0, 1.0 + 1e-15)],
        vec![span(1.0, 2.0, -5.0, 3.0), span(2.0, 1.0, f64::NAN, f64::INFINITY), span(3.0, 1.0, 2.0, 0.5)],
        vec![Point::new(1.0, f64::MAX), Point::new(f64::MIN_POSITIVE, 5e-324)],
    ];
    for points in cases {
        for scale in [Scale::Linear, Scale::Log] {
            let mut chart = chart_of(points.clone(), scale);
            chart.overlays = vec![Overlay::guide("g", Curve::Power { scale: 1.0, exponent: -0.5 })];
            let drawing = chart.drawing();
            assert_legible(&drawing);
            assert!(!chart.svg().unwrap().contains("NaN"));
            chart.series[0] = chart.series[0].clone().banded().scattered();
            paint::pixels(&chart.drawing(), 1.0).unwrap();
        }
    }
}

#[test]
fn points_without_a_place_are_left_out_and_counted() {
    let points =
        vec![Point::new(1.0, 1.0), Point::new(2.0, f64::NAN), Point::new(f64::INFINITY, 1.0), Point::new(4.0, 0.0)];
    assert!(says(&chart_of(points.clone(), Scale::Log).drawing(), "3 points have no place"));
    assert!(says(&chart_of(points, Scale::Linear).drawing(), "2 points have no place"));
    assert!(!says(&chart_of(vec![Point::new(1.0, 1.0)], Scale::Log).drawing(), "no place"));
}

#[test]
fn charts_without_data_say_so() {
    for points in [vec![], vec![Point::new(f64::NAN, 1.0)], vec![Point::new(1.0, -1.0)]] {
        let chart = chart_of(points, Scale::Log);
        assert!(says(&chart.drawing(), "no data"));
        assert_legible(&chart.drawing());
        chart.svg().unwrap();
    }
    let none = LineChart::new("t", Axis::linear("x"), Axis::linear("y"), vec![]);
    assert!(says(&none.drawing(), "no data"));
    let mut one_empty = speedups(2);
    one_empty.series[1].points.clear();
    assert!(says(&one_empty.drawing(), "strategy-number-1 (no data)"));
}

#[test]
fn both_files_are_written() {
    let dir = tempfile::tempdir().unwrap();
    let below = dir.path().join("figures");
    speedups(1).save(&below, "speedup").unwrap();
    let png = ::image::open(below.join("speedup.png")).unwrap();
    assert_eq!(png.width(), 1920);
    assert!(std::fs::read_to_string(below.join("speedup.svg")).unwrap().contains("<svg"));
    let file = below.join("speedup.svg");
    assert_eq!(speedups(1).save(&file, "x").unwrap_err().exit_code(), 3);
}

fn image(width: u32, height: u32) -> Cell {
    let rgb = (0..width * height * 3).map(|i| (i % 251) as u8).collect();
    Cell { caption: vec![format!("{width} by {height}"), "RMSE 0.0123, 1.5 s".into()], width, height, rgb }
}

fn sheet(rows: Vec<Vec<Option<Cell>>>) -> ContactSheet {
    let bars = vec![ColourBar { label: "|error|, linear radiance".into(), full: 0.25, is_largest: false }];
    ContactSheet {
        title: "Five sample counts".into(),
        subtitle: "cornell".into(),
        rows,
        bars,
        comparison: super::Comparison::Steps,
    }
}

#[test]
fn sheets_enlarge_small_images_and_thin_out_large_ones() {
    let pixels = sheet(vec![vec![Some(image(96, 64)), Some(image(1024, 768))], vec![Some(image(96, 64)), None]])
        .pixels()
        .unwrap()
        .0;
    // 96 pixels are shown as 288, and 1024 as 256: two columns of the wider, a gap and two margins.
    assert_eq!(pixels.width(), 2 * 288 + 16 + 48);
    let source = image(96, 64).rgb;
    let first = pixels.enumerate_pixels().filter(|(x, _, _)| (24..27).contains(x));
    let last_row_of_three = first.filter(|(_, _, pixel)| pixel.0 == source[..3]).count();
    assert!(last_row_of_three >= 9, "{last_row_of_three}");
}

/// A sheet shows one of four columns and rows of 1024x768 pixels; the crop has all pixels of the middle quarter.
#[test]
fn a_crop_has_all_pixels_of_the_middle() {
    let whole = image(1024, 768);
    let step = whole.step();
    let crop = whole.crop().unwrap();
    assert_eq!((crop.width, crop.height), (1024 / step, 768 / step));
    let (left, top) = ((1024 - crop.width) / 2, (768 - crop.height) / 2);
    let pixel = |cell: &Cell, x: u32, y: u32| {
        let at = 3 * (y * cell.width + x) as usize;
        cell.rgb[at..at + 3].to_vec()
    };
    for (x, y) in [(0, 0), (1, 0), (crop.width - 1, crop.height - 1)] {
        assert_eq!(pixel(&crop, x, y), pixel(&whole, left + x, top + y));
    }
    assert!(image(96, 64).crop().is_none());
}

#[test]
fn sheets_are_the_same_each_time_and_survive_gaps() {
    let full = || sheet(vec![vec![Some(image(8, 4)); 6], vec![Some(image(8, 4)), None, None, None, None, None]]);
    assert_eq!(full().png().unwrap(), full().png().unwrap());
    for rows in
        [vec![], vec![vec![]], vec![vec![None]], vec![vec![Some(image(1, 1))]], vec![vec![Some(image(3000, 2))]]]
    {
        sheet(rows).png().unwrap();
    }
}

#[test]
fn images_of_the_wrong_size_are_refused() {
    let mut wrong = image(4, 4);
    wrong.rgb.pop();
    assert!(sheet(vec![vec![Some(wrong)]]).png().unwrap_err().to_string().contains("47 bytes for 4 x 4"));
    assert!(sheet(vec![vec![Some(image(0, 0))]]).png().is_err());
}
