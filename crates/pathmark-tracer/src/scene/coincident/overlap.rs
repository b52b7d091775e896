//! Triangles that overlap in one plane.

use super::{SLACK, largest};
use crate::math::{Vec3, dot};
use crate::scene::{Bounds, Primitive, Triangle};

/// A triangle or a set of triangles with its box.
pub(super) struct Flat {
    bounds: Bounds,
    first: usize,
    end: usize,
}

/// Pairs of items of two lists whose boxes meet, found by a sweep along the x axis.
fn meeting(all: &mut [Flat], mut found: impl FnMut(&Flat, &Flat)) {
    all.sort_unstable_by(|a, b| a.bounds.low[0].total_cmp(&b.bounds.low[0]).then(a.first.cmp(&b.first)));
    for (place, one) in all.iter().enumerate() {
        for other in all[place + 1..].iter().take_while(|other| other.bounds.low[0] <= one.bounds.high[0]) {
            if meet(&one.bounds, &other.bounds) {
                let (lower, higher) = if one.first < other.first { (one, other) } else { (other, one) };
                found(lower, higher);
            }
        }
    }
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|axis| a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis])
}

impl Flat {
    fn of(triangles: &[Triangle], first: usize, end: usize) -> Self {
        let boxes = triangles[first..end].iter().filter_map(Primitive::bounds);
        let bounds = boxes.fold(Bounds::EMPTY, |all, own| all.and(&own));
        Self { bounds: bounds.grown(SLACK * bounds.largest()), first, end }
    }

    /// Returns the pairs of triangles that overlap in one plane, the lower number first, in order. Triangles of one
    /// object need no order, unless the object is a light: paths that aim at one of its triangles must meet that one.
    pub(super) fn overlaps(
        triangles: &[Triangle],
        owners: &[u32],
        is_light: impl Fn(u32) -> bool,
    ) -> Vec<(usize, usize)> {
        let mut objects: Vec<Self> = Vec::new();
        for first in (0..triangles.len()).filter(|k| *k == 0 || owners[*k] != owners[k - 1]) {
            let end = owners[first..].iter().position(|owner| *owner != owners[first]);
            objects.push(Self { bounds: Bounds::EMPTY, first, end: end.map_or(triangles.len(), |end| first + end) });
        }
        if objects.len() < 2 && objects.iter().all(|object| !is_light(owners[object.first])) {
            return Vec::new();
        }
        let mut pairs = Vec::new();
        let mut compare = |mut candidates: Vec<Self>, is_wanted: &dyn Fn(usize, usize) -> bool| {
            meeting(&mut candidates, |one, other| {
                let is_pair = is_wanted(one.first, other.first);
                if is_pair && overlap(&triangles[one.first], &triangles[other.first]) {
                    pairs.push((one.first, other.first));
                }
            });
        };
        let each =
            |object: &Self| (object.first..object.end).map(|k| Self::of(triangles, k, k + 1)).collect::<Vec<_>>();
        for object in &mut objects {
            *object = Self::of(triangles, object.first, object.end);
            if is_light(owners[object.first]) {
                compare(each(object), &|_, _| true);
            }
        }
        meeting(&mut objects, |one, other| {
            let within = |object: &Self, around: &Bounds| {
                let triangles = (object.first..object.end).map(|k| Self::of(triangles, k, k + 1));
                triangles.filter(|triangle| meet(&triangle.bounds, around)).collect::<Vec<_>>()
            };
            let mut candidates = within(one, &other.bounds);
            if !candidates.is_empty() {
                candidates.extend(within(other, &one.bounds));
                compare(candidates, &|a, b| owners[a] != owners[b]);
            }
        });
        pairs.sort_unstable();
        pairs
    }
}

/// The two axes of a plane in which an area is largest.
fn axes(normal: Vec3) -> [usize; 2] {
    let [x, y, z] = [normal.x.abs(), normal.y.abs(), normal.z.abs()];
    if x > y && x > z {
        [1, 2]
    } else if y > z {
        [2, 0]
    } else {
        [0, 1]
    }
}

fn component(v: Vec3, axis: usize) -> f64 {
    [v.x, v.y, v.z][axis]
}

fn longest_edge(Triangle { corners: [a, b, c] }: &Triangle) -> f64 {
    largest(*b - *a).max(largest(*c - *b)).max(largest(*a - *c))
}

/// The largest distance of two places that are the same.
fn slack(one: &Triangle, other: &Triangle) -> f64 {
    SLACK * one.corners.iter().chain(&other.corners).map(|corner| largest(*corner)).fold(0.0, f64::max)
}

/// Whether two triangles are in one plane and share an area.
fn overlap(one: &Triangle, other: &Triangle) -> bool {
    let (wide, small) = if longest_edge(one) < longest_edge(other) { (other, one) } else { (one, other) };
    let (normal, slack) = (wide.normal(wide.corners[0]), slack(one, other));
    let is_flat = small.corners.iter().all(|corner| dot(*corner - wide.corners[0], normal).abs() <= slack);
    is_flat && cut(&small.corners, wide, slack).is_some()
}

/// The parts of a triangle that another one in its plane does not cover.
pub(super) fn rest(triangle: &Triangle, cover: &Triangle) -> Vec<Triangle> {
    let Some(parts) = cut(&triangle.corners, cover, slack(triangle, cover)) else { return vec![*triangle] };
    let fans = parts.into_iter().flat_map(|part| {
        let triangles = (2..part.len()).map(|k| Triangle { corners: [part[0], part[k - 1], part[k]] });
        triangles.collect::<Vec<_>>()
    });
    fans.filter(|triangle| !triangle.is_degenerate()).collect()
}

/// The convex parts of a convex polygon outside a triangle in its plane; `None` if the two share no area.
fn cut(polygon: &[Vec3], cover: &Triangle, slack: f64) -> Option<Vec<Vec<Vec3>>> {
    let [u, v] = axes(cover.normal(cover.corners[0]));
    let place = |point: Vec3| [component(point, u), component(point, v)];
    let corners = cover.corners.map(place);
    // How far a point is to the left of an edge.
    let left = |[a, b]: [[f64; 2]; 2], point: Vec3| {
        let ([x, y], [ex, ey]) = (place(point), [b[0] - a[0], b[1] - a[1]]);
        let length = ex.abs().max(ey.abs());
        (ex / length) * (y - a[1]) - (ey / length) * (x - a[0])
    };
    let [a, b, c] = corners;
    let turn = left([a, b], cover.corners[2]).signum();
    let (mut inside, mut parts) = (polygon.to_vec(), Vec::new());
    for edge in [[a, b], [b, c], [c, a]] {
        let height = |point: &Vec3| {
            let height = turn * left(edge, *point);
            if height.abs() <= 4.0 * slack { 0.0 } else { height }
        };
        let heights: Vec<f64> = inside.iter().map(height).collect();
        if heights.iter().all(|height| *height <= 0.0) {
            return None;
        }
        if heights.iter().any(|height| *height < 0.0) {
            parts.push(side(&inside, &heights, -1.0));
            inside = side(&inside, &heights, 1.0);
        }
    }
    Some(parts)
}

/// The part of a convex polygon on one side of a line, by the heights of its corners above the line.
fn side(polygon: &[Vec3], heights: &[f64], sign: f64) -> Vec<Vec3> {
    let mut part = Vec::new();
    for (k, (point, height)) in polygon.iter().zip(heights).enumerate() {
        let next = (k + 1) % polygon.len();
        if sign * height >= 0.0 {
            part.push(*point);
        }
        if height * heights[next] < 0.0 {
            // From the same end for both sides, so that these share the point's bits.
            let (low, high) = if *height < 0.0 { (k, next) } else { (next, k) };
            let share = heights[low] / (heights[low] - heights[high]);
            part.push(polygon[low] + (polygon[high] - polygon[low]) * share);
        }
    }
    part
}
