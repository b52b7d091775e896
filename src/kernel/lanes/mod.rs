//! Many paths at a time, in the lanes of SIMD registers: `--kernel lanes`. Each lane follows a path of its own from vertex to vertex and takes the
//! next sample when it has ended. Sums are taken in the order of the samples (`window`), so in f64 an image is that of the scalar
//! kernel, bit for bit, on every instruction set.

mod light;
mod nearest;
mod packet;
mod tables;
mod vertex;
mod window;

use super::{Counts, Kernel, Spec};
use crate::estimator::Course;
use crate::film::{Piece, TileBuffer};
use crate::math::{Bits, Rgb, Vec3};
use crate::sampling::{InLanes, PathWords, Purpose, SampleKey};
use crate::scene::{SUBPIXELS, Scene, View};
use crate::simd::{self, Float, MOST_LANES, Mask, Work, on_level};
use light::Targets;
use packet::{LanesOf, Packet, colour};
use std::sync::Arc;
use tables::Tables;
use window::Window;

/// The kernel.
pub(super) struct Lanes {
    scene: Arc<Scene>,
    view: View,
    width: u32,
    seed: u64,
    course: Course,
    sampler: InLanes,
    tables: Tables,
    targets: Option<Targets>,
    /// Whether a number is needed to choose among them.
    chooses: bool,
    level: &'static simd::Entry,
    /// Whether every sphere is tested, because there are few and nothing else.
    scans: bool,
    /// Whether paths can be cut.
    cuts: bool,
}

impl Lanes {
    pub(super) fn new(scene: Arc<Scene>, spec: &Spec, course: Course, sampler: InLanes, level: &'static simd::Entry) -> Self {
        let tables = Tables::of(&scene);
        let targets = scene.lights.as_ref().map(Targets::of);
        Self {
            view: scene.camera.view(spec.width, spec.height),
            chooses: targets.as_ref().is_some_and(Targets::are_several),
            targets,
            scans: tables.is_round && scene.hierarchy.is_none(),
            scene,
            width: spec.width,
            seed: spec.seed,
            course,
            sampler,
            tables,
            level,
            cuts: true,
        }
    }

    /// Gives free lanes their next samples.
    #[inline(always)]
    fn refill<V: Float>(&self, packet: &mut Packet<V>, window: &mut Window<'_>) {
        let mut filled = 0;
        let (mut x, mut y, mut subpixel) = (V::splat(0.0), V::splat(0.0), V::splat(0.0));
        let free = !packet.alive & (u32::MAX >> (MOST_LANES - V::LANES));
        for lane in LanesOf(free) {
            let Some((place, slot)) = window.hand_out() else { break };
            let pixel = place.y * self.width + place.x;
            let PathWords { path, sample, joined } = self.sampler.path(SampleKey { seed: self.seed, pixel, sample: place.sample });
            V::set_word(&mut packet.words.path, lane, path);
            V::set_word(&mut packet.words.sample, lane, sample);
            V::set_word(&mut packet.words.joined[0], lane, joined[0]);
            V::set_word(&mut packet.words.joined[1], lane, joined[1]);
            x.set_lane(lane, f64::from(place.x));
            y.set_lane(lane, f64::from(place.y));
            subpixel.set_lane(lane, f64::from(place.sample % SUBPIXELS));
            packet.slots[lane] = slot;
            filled |= 1 << lane;
        }
        if filled == 0 {
            return;
        }
        let none = V::Bits::splat(0);
        let film = self.sampler.pair::<V>(&packet.words, none, none, Purpose::Film);
        let ray = self.view.rays([x, y], subpixel, film);
        let mask = V::Mask::from_bits(filled);
        packet.rays.ray.origin = Vec3::select(mask, ray.origin, packet.rays.ray.origin);
        packet.rays.ray.direction = Vec3::select(mask, ray.direction, packet.rays.ray.direction);
        packet.rays.from = V::select(mask, V::splat(-1.0), packet.rays.from);
        packet.rays.own_root = V::select(mask, V::splat(f64::NAN), packet.rays.own_root);
        packet.throughput = Rgb::select(mask, Rgb::splat(Rgb::WHITE), packet.throughput);
        packet.collected = Rgb::select(mask, Rgb::splat(Rgb::BLACK), packet.collected);
        packet.vertices = V::choose(mask, none, packet.vertices);
        packet.branch = V::choose(mask, none, packet.branch);
        packet.density = V::select(mask, V::splat(-1.0), packet.density);
        packet.alive |= filled;
    }

    #[inline(always)]
    fn follow<V: Float, const AIMS: bool>(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let mut counts = Counts::default();
        let mut window = Window::over(piece, out);
        let mut packet = Packet::<V>::new();
        let full = u32::MAX >> (MOST_LANES - V::LANES);
        loop {
            let free = full & !packet.alive;
            if free.count_ones() >= REFILL * V::LANES as u32 / 16 || packet.alive == 0 {
                self.refill(&mut packet, &mut window);
                if packet.alive == 0 {
                    return counts;
                }
            }
            let ended = self.advance::<V, AIMS>(&mut packet, &mut counts) & packet.alive;
            for lane in LanesOf(ended) {
                if !packet.pop(lane) {
                    packet.alive &= !(1 << lane);
                    window.give_back(packet.slots[lane], colour(&packet.collected, lane), &mut counts);
                }
            }
        }
    }
}

/// Sixteenths of the lanes that wait for samples before some are handed out: what makes camera rays is done for all lanes at once.
const REFILL: u32 = 3;

/// A piece to render.
struct Render<'a> {
    kernel: &'a Lanes,
    piece: &'a Piece,
    out: &'a mut TileBuffer,
}

impl Work for Render<'_> {
    type Output = Counts;

    #[inline(always)]
    fn run<V: Float<One = f64>>(self) -> Counts {
        if self.kernel.course.aims.is_some() {
            self.kernel.follow::<V, true>(self.piece, self.out)
        } else {
            self.kernel.follow::<V, false>(self.piece, self.out)
        }
    }
}

impl Kernel for Lanes {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let work = Render { kernel: self, piece, out };
        // The level has been found on this processor when the kernel was made.
        on_level(self.level.name, work).unwrap_or_default()
    }
}
