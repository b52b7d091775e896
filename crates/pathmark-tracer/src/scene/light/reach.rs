//! Reachable parts of spherical lights. No path crosses an opaque sphere or plane: it stays on the side where it
//! starts. For smallpt's light, a sphere of radius 600, the reachable part is a cap of height 0.268 below the ceiling.

use super::sphere::Cap;
use crate::math::{Vec3, dot};
use crate::scene::{Plane, Scene, Sphere};

/// An opaque surface without a hole, and the side of it on which all paths are.
#[derive(Debug, Clone, Copy)]
enum Wall {
    Sphere {
        primitive: u32,
        sphere: Sphere,
        inside: bool,
    },
    /// Paths are on the side that the normal points to.
    Plane(Plane),
}

/// The surfaces that keep paths on one side.
#[derive(Default)]
pub(super) struct Walls(Vec<Wall>);

/// The reachable part of a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    All,
    Nothing,
    /// The reachable part is in this cap.
    Cap(Cap),
}

impl Part {
    /// Returns the part of a sphere of that radius that extends by `height` from its end on the axis.
    fn of(axis: Vec3, height: f64, radius: f64) -> Self {
        if height >= 2.0 * radius {
            Self::All
        } else if height > 0.0 {
            Self::Cap(Cap { axis, height })
        } else {
            Self::Nothing
        }
    }
}

impl Wall {
    fn keeps(&self, light: &Sphere) -> Part {
        let r = light.radius;
        match self {
            Self::Plane(plane) => Part::of(plane.normal, r + dot(light.center - plane.point, plane.normal), r),
            Self::Sphere { sphere, inside, .. } => {
                let offset = sphere.center - light.center;
                let (d, wall) = (dot(offset, offset).sqrt(), sphere.radius);
                if d + r <= wall {
                    return if *inside { Part::All } else { Part::Nothing };
                }
                if d >= wall + r || d + wall <= r {
                    return if *inside { Part::Nothing } else { Part::All };
                }
                // The height up to the circle of intersection, by differences of lengths instead of squares.
                let axis = offset * (1.0 / d);
                if *inside {
                    let height = (wall - d + r) * (wall + d - r) / (2.0 * d);
                    Part::of(axis, height, r)
                } else {
                    let height = (d + r - wall) * (d + r + wall) / (2.0 * d);
                    Part::of(-axis, height, r)
                }
            }
        }
    }
}

impl Walls {
    /// Returns the walls of a scene whose camera rays start at `origins`. A ray that starts elsewhere can find the
    /// omitted lights by BSDF sampling.
    pub(super) fn of(scene: &Scene, origins: &[Vec3]) -> Self {
        let is_opaque = |primitive: u32| {
            let owner = scene.owners[primitive as usize] as usize;
            !scene.objects[owner].material.transmits()
        };
        // `height` is positive on one side and negative on the other. Returns whether all origins are on the negative
        // side; `None` if they are not all on one side.
        let side = |height: &dyn Fn(Vec3) -> f64| {
            let is_above = origins.iter().all(|origin| height(*origin) > 0.0);
            let is_below = origins.iter().all(|origin| height(*origin) < 0.0);
            (is_above || is_below).then_some(is_below)
        };
        let spheres = (0_u32..).zip(&scene.primitives.spheres).filter_map(|(primitive, sphere)| {
            let height = |origin: Vec3| {
                let offset = origin - sphere.center;
                dot(offset, offset).sqrt() - sphere.radius
            };
            let inside = side(&height)?;
            Some((primitive, Wall::Sphere { primitive, sphere: *sphere, inside }))
        });
        let first = scene.primitives.spheres.len() as u32;
        let planes = (first..).zip(&scene.primitives.planes).filter_map(|(primitive, plane)| {
            let is_below = side(&|origin| dot(origin - plane.point, plane.normal))?;
            let normal = if is_below { -plane.normal } else { plane.normal };
            Some((primitive, Wall::Plane(Plane { normal, ..*plane })))
        });
        let opaque = spheres.chain(planes).filter(|(primitive, _)| is_opaque(*primitive));
        Self(opaque.map(|(_, wall)| wall).collect())
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the reachable part of a sphere, which is the primitive of that number: the smallest cap that a single
    /// wall leaves.
    pub(super) fn reachable(&self, primitive: u32, light: &Sphere) -> Part {
        let mut reachable = Part::All;
        for wall in &self.0 {
            if matches!(wall, Wall::Sphere { primitive: own, .. } if *own == primitive) {
                continue;
            }
            reachable = match (reachable, wall.keeps(light)) {
                (_, Part::Nothing) => return Part::Nothing,
                (Part::Cap(known), Part::Cap(cap)) if cap.height >= known.height => Part::Cap(known),
                (_, Part::Cap(cap)) => Part::Cap(cap),
                (known, Part::All) => known,
            };
        }
        reachable
    }
}
