//! A log of one path: its events, in order.

use crate::estimator::Probe;
use crate::math::{Ray, Rgb, Vec3};
use crate::scene::Hit;

/// An event of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A ray arrived at a surface.
    Surface {
        bounces: u16,
        origin: Vec3,
        hit: Hit,
        /// Throughput of the light from there.
        throughput: Rgb,
    },
    /// Fog scattered a ray.
    Fog {
        bounces: u16,
        origin: Vec3,
        /// Point where the ray was scattered.
        point: Vec3,
        /// Distance from the origin to that point.
        distance: f64,
        /// Throughput of the light from there.
        throughput: Rgb,
    },
    /// Light was added to the sample.
    Light {
        /// Bounces of the light on its way to the camera.
        bounces: u16,
        /// Its contribution, throughput included.
        radiance: Rgb,
    },
    Split {
        bounces: u16,
    },
    /// A ray met nothing.
    Escaped,
    /// The path was cut at the bounce limit.
    Truncated,
    /// Russian roulette ended a part of the path.
    Roulette,
    /// A part of the path ended. The next event belongs to the part that was split off last.
    Ended {
        bounces: u16,
    },
}

/// A probe that records the events of a path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathLog {
    pub events: Vec<Event>,
    pub rays: u64,
}

impl PathLog {
    /// The sum of the light, in the order of the events: the sample's radiance bit for bit.
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
