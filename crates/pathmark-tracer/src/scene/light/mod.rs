//! Surfaces that give off light, as something to aim at: what next-event estimation chooses from. One kind of target a file.
//!
//! Planes have no end, a background has no place, and of a sphere the part may be left out that no path can reach; such light is found by the
//! directions of surfaces alone. [`Lights::density`] says which, so what is not aimed at is not lost.

mod reach;
mod sphere;
mod triangle;

use super::{Hit, Primitives, Scene, Standpoint};
use crate::math::{Ray, Rgb, Vec3};
use reach::{Part, Walls};
use sphere::SphereTarget;

pub use sphere::one_minus_cos;
pub use sphere::towards_cap;
pub use triangle::{TriangleTarget, per_steradian, point_of};

/// A direction towards a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aim {
    /// The direction, of length 1.
    pub direction: Vec3,
    /// The primitive that it is to arrive at; it need not, if something is before it.
    pub primitive: u32,
    /// How likely the light and the direction were, per steradian; positive and finite.
    pub density: f64,
}

/// What can be aimed at. Directions come with their density per steradian, seen from `point`.
trait Target {
    /// Chooses a direction; `None` if none that was chosen leads there. `own` tells which side the point is on if it is on the target itself.
    fn aim(&self, point: Vec3, own: Option<bool>, u: [f64; 2]) -> Option<(Vec3, f64)>;

    /// How likely the direction of a ray was that set out from `ray.origin` and met the target at `hit`; 0 if it is never chosen.
    fn density(&self, ray: &Ray, own: Option<bool>, hit: &Hit) -> f64;

    /// The area of what is aimed at.
    fn area(&self) -> f64;
}

/// Anything that can be aimed at.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyTarget {
    /// A sphere, or the cap of it that can be seen.
    Sphere(SphereTarget),
    /// A whole triangle.
    Triangle(TriangleTarget),
}

impl AnyTarget {
    /// What of a primitive can be aimed at.
    fn of(primitives: &Primitives, primitive: u32, walls: &Walls) -> Option<Self> {
        let mut index = primitive as usize;
        if let Some(sphere) = primitives.spheres.get(index) {
            return match walls.reachable(primitive, sphere) {
                Part::Nothing => None,
                Part::All => Some(Self::Sphere(SphereTarget::new(*sphere, None))),
                Part::Cap(cap) => Some(Self::Sphere(SphereTarget::new(*sphere, Some(cap)))),
            };
        }
        index -= primitives.spheres.len();
        let index = index.checked_sub(primitives.planes.len())?;
        primitives.triangles.get(index).and_then(TriangleTarget::new).map(Self::Triangle)
    }

    /// The area that light is sampled from.
    pub fn area(&self) -> f64 {
        match self {
            Self::Sphere(target) => target.area(),
            Self::Triangle(target) => target.area(),
        }
    }
}

/// A light, and how it is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    pub target: AnyTarget,
    pub primitive: u32,
    /// How often it is chosen.
    pub chance: f64,
    /// How often it or one before it is.
    pub up_to: f64,
}

/// Pairs of a light and a wall that are looked at; with more of them spheres are aimed at as wholes.
const MOST_PAIRS: usize = 1 << 24;

/// The lights of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Lights {
    /// Every light that estimators aim at.
    pub lights: Vec<Light>,
    /// The light of each primitive, or [`NO_LIGHT`].
    pub of_primitive: Vec<u32>,
}

/// Of a primitive that is none.
pub const NO_LIGHT: u32 = u32::MAX;

impl Lights {
    /// The lights of a scene whose camera rays start at `origins`. Half of the time a light is chosen by its power, half of the time evenly, so
    /// that none is starved where a large one outshines it.
    pub(super) fn of(scene: &Scene, origins: &[Vec3]) -> Self {
        let is_light = |owner: &u32| {
            let object = &scene.objects[*owner as usize];
            !object.emission.is_black() || object.angular_emission.is_some()
        };
        let primitives = (0_u32..).zip(&scene.owners).filter(|(_, owner)| is_light(owner));
        let mut walls = Walls::of(scene, origins);
        if walls.len().saturating_mul(primitives.clone().count()) > MOST_PAIRS {
            walls = Walls::default();
        }
        let mut found: Vec<(u32, AnyTarget, f64)> = Vec::new();
        for (primitive, owner) in primitives {
            if let Some(target) = AnyTarget::of(&scene.primitives, primitive, &walls) {
                let power = target.area() * mean(scene.objects[*owner as usize].emission);
                found.push((primitive, target, power));
            }
        }
        let all: f64 = found.iter().map(|(_, _, power)| power).sum();
        let even = 1.0 / found.len() as f64;
        // By sums of powers instead of chances, so that the last of very many is 1.
        let chance = |power: f64, count: f64| if all > 0.0 { 0.5 * (power / all + count * even) } else { count * even };
        let mut of_primitive = vec![NO_LIGHT; scene.owners.len()];
        let mut so_far = 0.0;
        let mut lights = Vec::with_capacity(found.len());
        for (index, (primitive, target, power)) in (0_u32..).zip(found) {
            so_far += power;
            of_primitive[primitive as usize] = index;
            let up_to = chance(so_far, f64::from(index + 1));
            lights.push(Light { target, primitive, chance: chance(power, 1.0), up_to });
        }
        Self { lights, of_primitive }
    }

    /// A direction from a point towards a light; `None` if there is none or the direction that was chosen leads past it. `choice` is asked only
    /// where there are several lights.
    #[inline(always)]
    pub fn aim(
        &self,
        point: Vec3,
        from: Option<Standpoint>,
        choice: impl FnOnce() -> f64,
        place: [f64; 2],
    ) -> Option<Aim> {
        let light = match self.lights.as_slice() {
            [only] => only,
            lights => {
                let number = choice();
                // The last sum may fall short of 1 by rounding.
                let index = lights.partition_point(|light| light.up_to <= number).min(lights.len().checked_sub(1)?);
                &lights[index]
            }
        };
        let own = own(from, light.primitive);
        let (direction, density) = match &light.target {
            AnyTarget::Sphere(target) => target.aim(point, own, place),
            AnyTarget::Triangle(target) => target.aim(point, own, place),
        }?;
        let density = light.chance * density;
        (density > 0.0 && density < f64::INFINITY).then_some(Aim { direction, primitive: light.primitive, density })
    }

    /// How often each light is chosen.
    pub fn chances(&self) -> impl Iterator<Item = f64> {
        self.lights.iter().map(|light| light.chance)
    }

    /// How likely [`Lights::aim`] was to choose the direction of a ray that met `hit`, per steradian; 0 if nothing is aimed at there.
    #[inline(always)]
    pub fn density(&self, ray: &Ray, from: Option<Standpoint>, hit: &Hit) -> f64 {
        let Some(light) = self.lights.get(self.of_primitive[hit.primitive as usize] as usize) else { return 0.0 };
        let own = own(from, light.primitive);
        let density = match &light.target {
            AnyTarget::Sphere(target) => target.density(ray, own, hit),
            AnyTarget::Triangle(target) => target.density(ray, own, hit),
        };
        light.chance * density
    }
}

/// The side of the light that a point of its own is on.
#[inline(always)]
fn own(from: Option<Standpoint>, light: u32) -> Option<bool> {
    from.filter(|from| from.primitive == light).map(|from| from.inside)
}

fn mean(radiance: Rgb) -> f64 {
    radiance.channels().iter().sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use crate::scene::load;

    /// H37: of very many lights every one is chosen, none twice, and the chances make 1.
    #[test]
    fn chances_of_many_lights_make_one() {
        let scene = load("spheres:100000").unwrap().in_equilibrium();
        let lights = scene.lit(&scene.camera.view(8, 6)).lights.unwrap();
        assert_eq!(lights.lights.len(), 100_000);
        let last = lights.lights.last().unwrap();
        assert!((last.up_to - 1.0).abs() < 1e-12, "{}", last.up_to);
        let sum: f64 = lights.lights.iter().map(|light| light.chance).sum();
        assert!((sum - 1.0).abs() < 1e-11, "{sum}");
        assert!(lights.lights.iter().all(|light| light.chance >= 0.5e-5));
        assert!(lights.of_primitive.iter().enumerate().all(|(light, of)| light == *of as usize));
    }

    /// Light outside of a closed room is not aimed at: here the room's own sphere is between.
    #[test]
    fn what_cannot_be_reached_is_no_target() {
        let mut scene = load("cornell").unwrap();
        let light = scene.objects.iter().position(|object| object.name == "light").unwrap();
        scene.primitives.spheres[light].center.y += 1.0;
        let lights = scene.lit(&scene.camera.view(64, 48)).lights.unwrap();
        assert!(lights.lights.is_empty());
    }
}
