//! The shapes of markers and error bars.

use super::drawing::{Drawing, Place};
use super::style::{Colour, HAIRLINE, LINE, Marker, PAPER};

/// Half the size of a marker in pixels.
const RADIUS: f64 = 4.5;
/// Half the width of an error bar's cap.
const CAP: f64 = 3.0;

/// Draws a marker, with a thin rim in the colour of the paper to separate it from lines below.
pub(super) fn draw(drawing: &mut Drawing, at: Place, marker: Marker, colour: Colour) {
    match marker {
        Marker::Disc => {
            drawing.disc(at, RADIUS + 1.0, PAPER);
            drawing.disc(at, RADIUS, colour);
        }
        Marker::Ring => {
            drawing.disc(at, RADIUS + 1.0, PAPER);
            drawing.disc(at, RADIUS, colour);
            drawing.disc(at, RADIUS - 2.0, PAPER);
        }
        Marker::Plus => cross(drawing, at, colour, &[((-1.0, 0.0), (1.0, 0.0)), ((0.0, -1.0), (0.0, 1.0))]),
        Marker::Cross => cross(drawing, at, colour, &[((-0.8, -0.8), (0.8, 0.8)), ((-0.8, 0.8), (0.8, -0.8))]),
        Marker::Square => filled(drawing, at, colour, &SQUARE),
        Marker::Diamond => filled(drawing, at, colour, &DIAMOND),
        Marker::Triangle => filled(drawing, at, colour, &TRIANGLE),
        Marker::Nabla => filled(drawing, at, colour, &NABLA),
    }
}

/// Corners of the filled markers, in radii.
const SQUARE: [Place; 4] = [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)];
const DIAMOND: [Place; 4] = [(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)];
const TRIANGLE: [Place; 3] = [(0.0, -1.2), (1.15, 0.85), (-1.15, 0.85)];
const NABLA: [Place; 3] = [(0.0, 1.2), (-1.15, -0.85), (1.15, -0.85)];

/// Empties the middle of a marker.
pub(super) fn hollow(drawing: &mut Drawing, at: Place, marker: Marker) {
    let mut empty = |corners: &[Place]| drawing.area(corners_at(at, corners, 0.5 * RADIUS), PAPER, 1.0);
    match marker {
        Marker::Square => empty(&SQUARE),
        Marker::Diamond => empty(&DIAMOND),
        Marker::Triangle => empty(&TRIANGLE),
        Marker::Nabla => empty(&NABLA),
        // Of a cross only the ends remain, of a ring a thin line.
        Marker::Disc | Marker::Plus | Marker::Cross | Marker::Ring => drawing.disc(at, RADIUS - 1.5, PAPER),
    }
}

fn corners_at(at: Place, corners: &[Place], radius: f64) -> Vec<Place> {
    corners.iter().map(|c| (at.0 + radius * c.0, at.1 + radius * c.1)).collect()
}

fn filled(drawing: &mut Drawing, at: Place, colour: Colour, corners: &[Place]) {
    drawing.area(corners_at(at, corners, RADIUS + 1.3), PAPER, 1.0);
    drawing.area(corners_at(at, corners, RADIUS), colour, 1.0);
}

fn cross(drawing: &mut Drawing, at: Place, colour: Colour, arms: &[(Place, Place)]) {
    for (paint, width, radius) in [(PAPER, LINE + 2.0, RADIUS + 1.5), (colour, LINE + 0.5, RADIUS + 0.5)] {
        for (from, to) in arms {
            let end = |e: &Place| (at.0 + radius * e.0, at.1 + radius * e.1);
            drawing.path(vec![end(from), end(to)], paint, width);
        }
    }
}

/// Draws a horizontal or vertical error bar from `a` to `b`, with a cap at each end.
pub(super) fn bar(drawing: &mut Drawing, a: Place, b: Place, colour: Colour) {
    let upright = (a.0 - b.0).abs() < (a.1 - b.1).abs();
    let (dx, dy) = if upright { (CAP, 0.0) } else { (0.0, CAP) };
    drawing.path(vec![a, b], colour, HAIRLINE);
    for (x, y) in [a, b] {
        drawing.path(vec![(x - dx, y - dy), (x + dx, y + dy)], colour, HAIRLINE);
    }
}
