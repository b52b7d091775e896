//! Everything that one path does, in order.

use crate::estimator::Probe;
use crate::math::{Ray, Rgb, Vec3};
use crate::scene::Hit;

/// Something that a path did. `bounces` are those before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A ray arrived at a surface.
    Surface {
        /// Bounces before.
        bounces: u16,
        /// Where the ray began.
        origin: Vec3,
        /// Where it arrived.
        hit: Hit,
        /// What light from here counts for.
        throughput: Rgb,
    },
    /// Fog scattered a ray.
    Fog {
        /// Bounces before.
        bounces: u16,
        /// Where the ray began.
        origin: Vec3,
        /// Where it was scattered.
        point: Vec3,
        /// How far that is.
        distance: f64,
        /// What light from here counts for.
        throughput: Rgb,
    },
    /// Light was added to the sample.
    Light {
        /// Bounces that it makes on its way to the camera.
        bounces: u16,
        /// How much, throughput included.
        radiance: Rgb,
    },
    /// The path split.
    Split {
        /// Bounces before.
        bounces: u16,
    },
    /// A ray met nothing.
    Escaped,
    /// The path was cut at the bounce limit.
    Truncated,
    /// Roulette ended a part.
    Roulette,
    /// A part ended. What comes next belongs to the part that was split off last.
    Ended {
        /// Bounces that it made.
        bounces: u16,
    },
}

/// A probe that writes down what a path does.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathLog {
    /// What it did, in order.
    pub events: Vec<Event>,
    /// Rays traced.
    pub rays: u64,
}

impl PathLog {
    /// The light that was added, in the order in which it was: the sample's radiance bit for bit.
    pub fn light(&self) -> Rgb {
        let mut sum = Rgb::BLACK;
        for event in &self.events {
            if let Event::Light { radiance, .. } = event {
                sum += *radiance;
            }
        }
        sum
    }
}

impl Probe for PathLog {
    fn ray(&mut self, _tests: crate::scene::Tests) {
        self.rays += 1;
    }
    fn escaped(&mut self) {
        self.events.push(Event::Escaped);
    }
    fn truncated(&mut self) {
        self.events.push(Event::Truncated);
    }
    fn vertex(&mut self, bounces: u16, ray: &Ray, hit: &Hit, throughput: Rgb) {
        self.events.push(Event::Surface { bounces, origin: ray.origin, hit: *hit, throughput });
    }
    fn light(&mut self, bounces: u16, radiance: Rgb) {
        self.events.push(Event::Light { bounces, radiance });
    }
    fn scattered(&mut self, bounces: u16, ray: &Ray, distance: f64, throughput: Rgb) {
        let (origin, point) = (ray.origin, ray.at(distance));
        self.events.push(Event::Fog { bounces, origin, point, distance, throughput });
    }
    fn split(&mut self, bounces: u16) {
        self.events.push(Event::Split { bounces });
    }
    fn roulette(&mut self) {
        self.events.push(Event::Roulette);
    }
    fn ended(&mut self, bounces: u16) {
        self.events.push(Event::Ended { bounces });
    }
}
