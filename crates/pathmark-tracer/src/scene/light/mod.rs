//! Lights: emitting surfaces as targets of next-event estimation. Each kind of target has its own file.
//!
//! Planes are infinite and a background has no position, so neither is a target; a sphere's target may leave out the
//! part that no path can reach. Only BSDF sampling finds such light. It is not lost, because [`Lights::density`] is 0
//! there.

mod reach;
mod sphere;
mod triangle;

use super::{Hit, Primitives, Scene, SurfaceOrigin};
use crate::math::{Ray, Rgb, Vec3};
use reach::{Part, Walls};
use sphere::SphereTarget;

pub use sphere::one_minus_cos;
pub use sphere::towards_cap;
pub use triangle::{TriangleTarget, per_steradian, point_of};

/// A sampled direction towards a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aim {
    /// The direction, of length 1.
    pub direction: Vec3,
    /// The primitive that it aims at; another one may block the way.
    pub primitive: u32,
    /// The density of the light and the direction, per steradian; positive and finite.
    pub density: f64,
}

/// A target of next-event estimation. Directions come with their density per steradian, seen from `point`. If a point is
/// on the target itself, `own` says whether it is on the inner side.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyTarget {
    /// A sphere, or its cap that paths can reach.
    Sphere(SphereTarget),
    /// A whole triangle.
    Triangle(TriangleTarget),
}

impl AnyTarget {
    /// Returns the target for a primitive: its part that paths can reach; `None` if there is none.
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

/// A light with its selection probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    pub target: AnyTarget,
    pub primitive: u32,
    pub chance: f64,
    /// The probability of choosing it or one before it.
    pub up_to: f64,
}

/// The most pairs of a light and a wall that are tested; with more, whole spheres are targets.
const MOST_PAIRS: usize = 1 << 24;

#[derive(Debug, Clone, PartialEq)]
pub struct Lights {
    /// Every light that estimators aim at.
    pub lights: Vec<Light>,
    /// The light's index for each primitive, or [`NO_LIGHT`].
    pub of_primitive: Vec<u32>,
}

/// Marks a primitive that is no light.
pub const NO_LIGHT: u32 = u32::MAX;

impl Lights {
    /// Collects the lights of a scene whose camera rays start at `origins`. Half of the choices are in proportion to
    /// power and half are uniform, so that a bright light does not starve the others.
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
        // From sums of powers instead of probabilities, so that the last of very many is 1.
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

    /// Samples a direction from a point towards a light; `None` if there is no light or the direction misses it. A
    /// single light is chosen without calling `choice`.
    #[inline(always)]
    pub fn aim(
        &self,
        point: Vec3,
        from: Option<SurfaceOrigin>,
        choice: impl FnOnce() -> f64,
        place: [f64; 2],
    ) -> Option<Aim> {
        let light = match self.lights.as_slice() {
            [only] => only,
            lights => {
                let number = choice();
                // Rounding may leave the last sum below 1.
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

    /// Returns the probability of choosing each light.
    pub fn chances(&self) -> impl Iterator<Item = f64> {
        self.lights.iter().map(|light| light.chance)
    }

    /// Returns the density per steradian with which [`Lights::aim`] samples the direction of a ray that met `hit`; 0 if
    /// `hit` is on no target.
    #[inline(always)]
    pub fn density(&self, ray: &Ray, from: Option<SurfaceOrigin>, hit: &Hit) -> f64 {
        let Some(light) = self.lights.get(self.of_primitive[hit.primitive as usize] as usize) else { return 0.0 };
        let own = own(from, light.primitive);
        let density = match &light.target {
            AnyTarget::Sphere(target) => target.density(ray, own, hit),
            AnyTarget::Triangle(target) => target.density(ray, own, hit),
        };
        light.chance * density
    }
}

/// Returns whether a ray that starts on this light leaves to its inside; `None` if it starts elsewhere.
#[inline(always)]
fn own(from: Option<SurfaceOrigin>, light: u32) -> Option<bool> {
    from.filter(|from| from.primitive == light).map(|from| from.inside)
}

fn mean(radiance: Rgb) -> f64 {
    radiance.channels().iter().sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use crate::scene::load;

    /// H37: with very many lights, each is chosen, none occurs twice, and the probabilities sum to 1.
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

    /// A light outside a closed room is no target: here the room's ceiling is between.
    #[test]
    fn unreachable_lights_are_no_targets() {
        let mut scene = load("cornell").unwrap();
        let light = scene.objects.iter().position(|object| object.name == "light").unwrap();
        scene.primitives.spheres[light].center.y += 1.0;
        let lights = scene.lit(&scene.camera.view(64, 48)).lights.unwrap();
        assert!(lights.lights.is_empty());
    }
}
