//! Triangles that overlap in one plane.

use super::{MOST_COVERS, Slack};
use crate::math::{Vec3, dot};
use crate::scene::{Bounds, Primitive, Triangle};
use std::collections::HashMap;

/// A triangle or a set of triangles with its box.
pub(super) struct Flat {
    bounds: Bounds,
    first: usize,
    end: usize,
}

/// The axis along which the fewest boxes meet, if they are spread evenly.
fn axis_of_spread(all: &[Flat]) -> usize {
    let spread = |axis: usize| {
        let low = all.iter().map(|item| item.bounds.low[axis]).fold(f64::INFINITY, f64::min);
        let high = all.iter().map(|item| item.bounds.high[axis]).fold(f64::NEG_INFINITY, f64::max);
        let lengths: f64 = all.iter().map(|item| item.bounds.high[axis] - item.bounds.low[axis]).sum();
        (high - low) / lengths
    };
    (0..3).max_by(|a, b| spread(*a).total_cmp(&spread(*b))).unwrap_or(0)
}

/// Pairs of items whose boxes meet, found by a sweep along an axis.
fn meeting(all: &mut [Flat], mut found: impl FnMut(&Flat, &Flat)) {
    let axis = axis_of_spread(all);
    let low = |item: &Flat| item.bounds.low[axis];
    all.sort_unstable_by(|a, b| low(a).total_cmp(&low(b)).then(a.first.cmp(&b.first)));
    for (place, one) in all.iter().enumerate() {
        for other in all[place + 1..].iter().take_while(|other| low(other) <= one.bounds.high[axis]) {
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
    fn of(triangles: &[Triangle], first: usize, end: usize, slack: &Slack) -> Self {
        let boxes = triangles[first..end].iter().filter_map(Primitive::bounds);
        let bounds = boxes.fold(Bounds::EMPTY, |all, own| all.and(&own));
        Self { bounds: bounds.grown(slack.flat * bounds.largest() + slack.least), first, end }
    }

    /// Returns the pairs of triangles that overlap in one plane, the lower number first, in order. Triangles of one
    /// object need no order, unless the object is a light: paths that aim at one of its triangles must meet that one.
    pub(super) fn overlaps(
        triangles: &[Triangle],
        owners: &[u32],
        slack: &Slack,
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
        // Beyond that many, the others do not matter.
        let mut covers: HashMap<usize, usize> = HashMap::new();
        let mut compare = |mut candidates: Vec<Self>, is_wanted: &dyn Fn(usize, usize) -> bool| {
            meeting(&mut candidates, |one, other| {
                let is_pair = is_wanted(one.first, other.first)
                    && covers.get(&other.first).is_none_or(|covers| *covers <= MOST_COVERS);
                if is_pair && overlap(&triangles[one.first], &triangles[other.first], slack) {
                    pairs.push((one.first, other.first));
                    *covers.entry(other.first).or_default() += 1;
                }
            });
        };
        let each = |object: &Self| {
            (object.first..object.end).map(|k| Self::of(triangles, k, k + 1, slack)).collect::<Vec<_>>()
        };
        for object in &mut objects {
            *object = Self::of(triangles, object.first, object.end, slack);
            if is_light(owners[object.first]) {
                compare(each(object), &|_, _| true);
            }
        }
        meeting(&mut objects, |one, other| {
            let within = |object: &Self, around: &Bounds| {
                let triangles = (object.first..object.end).map(|k| Self::of(triangles, k, k + 1, slack));
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

pub(super) fn longest_edge(Triangle { corners: [a, b, c] }: &Triangle) -> f64 {
    (*b - *a).largest().max((*c - *b).largest()).max((*a - *c).largest())
}

/// The largest distance of two places that are the same.
pub(super) fn largest_distance(one: &Triangle, other: &Triangle, slack: &Slack) -> f64 {
    slack.least
        + slack.flat * one.corners.iter().chain(&other.corners).map(|corner| corner.largest()).fold(0.0, f64::max)
}

/// Whether two triangles are in one plane and share an area.
fn overlap(one: &Triangle, other: &Triangle, slack: &Slack) -> bool {
    let (wide, small) = if longest_edge(one) < longest_edge(other) { (other, one) } else { (one, other) };
    let origin = wide.corners[0];
    let normal = wide.normal(origin);
    let is_in_plane = |corner: &Vec3| dot(*corner - origin, normal).abs() <= slack.across(normal, *corner, origin);
    let is_flat = small.corners.iter().all(is_in_plane);
    is_flat && cut(&small.corners, wide, largest_distance(one, other, slack)).is_some()
}

/// The parts of a triangle that another one in its plane does not cover.
pub(super) fn rest(triangle: &Triangle, cover: &Triangle) -> Vec<Triangle> {
    let slack = largest_distance(triangle, cover, &Slack::DOUBLE);
    let Some(parts) = cut(&triangle.corners, cover, slack) else { return vec![*triangle] };
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
