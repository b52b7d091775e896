//! Coincident surfaces: where two primitives are in one place, rays meet the one with the lower number.
//!
//! A search cannot keep this rule: rounding decides which of two equal distances is smaller, and whether a ray that
//! starts on one of the surfaces starts in front of the other. So the hidden surface is removed when the scene is read.
//! A sphere, a plane, or a triangle in a plane is removed as a whole. A triangle that overlaps others in its plane
//! keeps the rest of its area, unless there are very many of these: then a remark says that rounding decides. So it
//! says of a surface that light passes, such as glass: what lies behind that must stay.
//!
//! Two places are the same if they differ by no more than rounding moves a surface. Single precision moves surfaces
//! farther, so that two of them may be one to it and not to this search; `near.rs` finds these.

mod near;
mod overlap;

use super::{Plane, Primitives, Scene, Sphere, Triangle};
use crate::math::{Vec3, dot};
use overlap::Flat;
use std::collections::BTreeMap;

/// How far rounding moves surfaces.
#[derive(Debug, Clone, Copy)]
struct Slack {
    /// In units of the largest coordinate.
    flat: f64,
    /// The same for spheres, whose hits have the rounding of a square root.
    sphere: f64,
    /// The least distance, whatever the coordinates.
    least: f64,
}

impl Slack {
    const DOUBLE: Self = Self { flat: 1.0 / (1_u64 << 48) as f64, sphere: 1.0 / (1_u64 << 40) as f64, least: 0.0 };

    /// The largest height of a point above another one in its plane. Coordinates along the plane do not round heights.
    fn across(&self, normal: Vec3, point: Vec3, other: Vec3) -> f64 {
        let part = |normal: f64, point: f64, other: f64| normal.abs() * (point.abs() + other.abs());
        let parts =
            [part(normal.x, point.x, other.x), part(normal.y, point.y, other.y), part(normal.z, point.z, other.z)];
        self.flat * parts.iter().sum::<f64>() + self.least
    }

    fn of(&self, sphere: &Sphere) -> f64 {
        self.sphere * (sphere.center.largest() + sphere.radius) + self.least
    }
}

/// The most triangles that are cut out of another one. The number of its parts may grow with the square of this.
const MOST_COVERS: usize = 64;

/// The most remarks on pairs of objects.
const MOST_REMARKS: usize = 8;

impl Sphere {
    fn is_where(&self, other: &Self, slack: &Slack) -> bool {
        (self.center - other.center).largest().max((self.radius - other.radius).abs()) <= slack.of(self)
    }

    /// A number that is nearly the same for spheres in one place, and hardly ever for others.
    fn key(&self) -> f64 {
        self.center.x + 0.618 * self.center.y + 0.414 * self.center.z + 0.732 * self.radius
    }
}

impl Plane {
    fn is_where(&self, other: &Self, slack: &Slack) -> bool {
        self.normal.cross(other.normal).largest() <= slack.flat && self.contains(other.point, slack)
    }

    fn contains(&self, point: Vec3, slack: &Slack) -> bool {
        dot(point - self.point, self.normal).abs() <= slack.across(self.normal, point, self.point)
    }

    fn holds(&self, triangle: &Triangle, slack: &Slack) -> bool {
        triangle.corners.iter().all(|corner| self.contains(*corner, slack))
    }
}

/// Pairs of spheres in one place, the lower number first.
fn spheres_in_one_place<'a>(spheres: &'a [Sphere], slack: &'a Slack) -> impl Iterator<Item = (usize, usize)> + 'a {
    let mut order: Vec<(f64, u32)> = spheres.iter().map(Sphere::key).zip(0..).collect();
    order.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    (0..order.len()).flat_map(move |place| {
        let (key, one) = (order[place].0, order[place].1 as usize);
        let reach = 8.0 * slack.of(&spheres[one]);
        let near = order[place + 1..].iter().take_while(|(other, _)| other - key <= reach);
        let others = near.map(|(_, other)| *other as usize);
        let pairs = others.filter(|other| spheres[one].is_where(&spheres[*other], slack));
        pairs.map(|other| (one.min(other), one.max(other))).collect::<Vec<_>>()
    })
}

/// For each hidden sphere, the one that hides it.
fn hidden_spheres(spheres: &[Sphere]) -> BTreeMap<usize, usize> {
    spheres_in_one_place(spheres, &Slack::DOUBLE).map(|(hider, hidden)| (hidden, hider)).collect()
}

/// For each hidden plane, the one that hides it.
fn hidden_planes(planes: &[Plane]) -> BTreeMap<usize, usize> {
    let hider = |plane: usize| planes[..plane].iter().position(|other| other.is_where(&planes[plane], &Slack::DOUBLE));
    (0..planes.len()).filter_map(|plane| Some((plane, hider(plane)?))).collect()
}

/// Removes items by their indices.
fn without<T>(items: &mut Vec<T>, hidden: impl Fn(usize) -> bool) {
    let mut index = 0;
    items.retain(|_| {
        index += 1;
        !hidden(index - 1)
    });
}

impl Scene {
    /// Removes surfaces that others hide, and tells which objects they belong to.
    pub(super) fn resolve_coincident(&mut self) {
        let Primitives { spheres, planes, triangles, .. } = &self.primitives;
        let [first_plane, first_triangle] = [spheres.len(), spheres.len() + planes.len()];
        // A surface that light passes hides nothing: behind it the other one must stay.
        let is_through = |one: usize, other: usize| {
            let transmits = |number: usize| self.objects[self.owners[number] as usize].material.transmits();
            transmits(one) || transmits(other)
        };
        let mut undecided: Vec<(u32, u32)> = Vec::new();
        let mut opaque = |first: usize, hidden: BTreeMap<usize, usize>| {
            let (through, opaque): (BTreeMap<_, _>, BTreeMap<_, _>) =
                hidden.into_iter().partition(|(hidden, hider)| is_through(first + hidden, first + hider));
            undecided.extend(
                through.iter().map(|(hidden, hider)| (self.owners[first + hider], self.owners[first + hidden])),
            );
            opaque
        };
        let hidden_spheres = opaque(0, hidden_spheres(spheres));
        let hidden_planes = opaque(first_plane, hidden_planes(planes));
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let mut hides = |hidden: usize, hider: usize| pairs.push((self.owners[hider], self.owners[hidden]));
        for (hidden, hider) in &hidden_spheres {
            hides(*hidden, *hider);
        }
        for (hidden, hider) in &hidden_planes {
            hides(first_plane + hidden, first_plane + hider);
        }
        // The rest of each triangle that is hidden in part or as a whole.
        let mut rests: BTreeMap<usize, Vec<Triangle>> = BTreeMap::new();
        for (index, triangle) in triangles.iter().enumerate() {
            if let Some(plane) = planes.iter().position(|plane| plane.holds(triangle, &Slack::DOUBLE)) {
                if is_through(first_triangle + index, first_plane + plane) {
                    undecided.push((self.owners[first_plane + plane], self.owners[first_triangle + index]));
                    continue;
                }
                hides(first_triangle + index, first_plane + plane);
                rests.insert(index, Vec::new());
            }
        }
        let owners = &self.owners[first_triangle..];
        let is_light = |owner: u32| !self.objects[owner as usize].emission.is_black();
        let mut covers: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (hider, hidden) in Flat::overlaps(triangles, owners, &Slack::DOUBLE, is_light) {
            if is_through(first_triangle + hidden, first_triangle + hider) {
                undecided.push((owners[hider], owners[hidden]));
            } else {
                covers.entry(hidden).or_default().push(hider);
            }
        }
        for (hidden, hiders) in covers {
            if hiders.len() > MOST_COVERS {
                undecided.extend(hiders.iter().map(|hider| (owners[*hider], owners[hidden])));
                continue;
            }
            let mut rest = rests.remove(&hidden).unwrap_or_else(|| vec![triangles[hidden]]);
            for hider in hiders {
                rest = rest.iter().flat_map(|part| overlap::rest(part, &triangles[hider])).collect();
                hides(first_triangle + hidden, first_triangle + hider);
            }
            rests.insert(hidden, rest);
        }
        self.tell(undecided, |_, _| "rounding decides which of them rays meet".to_string());
        if pairs.is_empty() {
            return;
        }
        self.tell(pairs, |hider, is_first| {
            let why = if is_first { "which comes first" } else { "because planes precede triangles" };
            format!("rays meet {hider}, {why}")
        });
        let is_hidden = |number: usize| {
            hidden_spheres.contains_key(&number)
                || number.checked_sub(first_plane).is_some_and(|plane| hidden_planes.contains_key(&plane))
        };
        let parts = |index: usize| rests.get(&index).map_or(1, Vec::len);
        let owners = self.owners.iter().enumerate().flat_map(|(number, owner)| {
            let count = number.checked_sub(first_triangle).map_or(usize::from(!is_hidden(number)), parts);
            std::iter::repeat_n(*owner, count)
        });
        self.owners = owners.collect();
        let Primitives { spheres, planes, triangles, .. } = &mut self.primitives;
        without(spheres, |index| hidden_spheres.contains_key(&index));
        without(planes, |index| hidden_planes.contains_key(&index));
        let whole = std::mem::take(triangles);
        triangles.extend(
            whole
                .into_iter()
                .enumerate()
                .flat_map(|(index, triangle)| rests.remove(&index).unwrap_or_else(|| vec![triangle])),
        );
    }

    /// Adds a remark for each pair of objects. `end` gets the name of the first one, and whether it comes first in the
    /// scene.
    fn tell(&mut self, mut pairs: Vec<(u32, u32)>, end: impl Fn(&str, bool) -> String) {
        pairs.retain(|(hider, hidden)| hider != hidden);
        pairs.sort_unstable();
        pairs.dedup();
        for (hider, hidden) in pairs.iter().take(MOST_REMARKS) {
            let is_first = hider < hidden;
            let [hider, hidden] = [hider, hidden].map(|owner| &self.objects[*owner as usize].name);
            let remark = format!("where {hider} and {hidden} coincide, {}", end(hider, is_first));
            self.remarks.push(remark);
        }
        if let Some(more) = pairs.len().checked_sub(MOST_REMARKS + 1) {
            self.remarks.push(format!("{} more pairs of objects coincide", more + 1));
        }
    }
}
