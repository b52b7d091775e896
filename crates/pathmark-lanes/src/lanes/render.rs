//! Rendering of a piece: packets of paths, refilled from the window of samples.

use super::bvh::{Stack, Stacks};
use super::kernel::Lanes;
use super::packet::{NO_PARTS, NextPart, Packet, Parts};
use super::rays::LanesOf;
use super::supply::Supply;
use super::window::Window;
use crate::simd::{Float, MOST_LANES, Work, on_level, sizes_of};
use pathmark_tracer::film::{Piece, TileBuffer};
use pathmark_tracer::kernel::{Counts, Kernel};
use pathmark_tracer::math::Rgb;

impl Lanes {
    /// Gives back the samples whose paths have ended. A path with a waiting part continues with that part.
    #[inline(always)]
    fn retire<V: Float, const DIFFUSE_ONLY: bool>(
        &self,
        packet: &mut Packet<'_, V>,
        ended: u32,
        window: &mut Window<'_>,
    ) {
        let [mut r, mut g, mut b] = [[V::One::default(); MOST_LANES]; 3];
        packet.collected.r.store(&mut r);
        packet.collected.g.store(&mut g);
        packet.collected.b.store(&mut b);
        for lane in LanesOf(ended) {
            if !DIFFUSE_ONLY && self.rules.splits > 0 && V::apart(NextPart { packet, lane }) {
                packet.alive |= 1 << lane;
            } else {
                window.give_back(packet.slots[lane], Rgb { r: r[lane].into(), g: g[lane].into(), b: b[lane].into() });
            }
        }
    }

    #[inline(always)]
    fn follow<V: Float, const AIMS: bool, const DIFFUSE_ONLY: bool>(
        &self,
        piece: &Piece,
        waiting: &mut [Parts],
        stacks: &mut [Stack],
        out: &mut TileBuffer,
    ) -> Counts {
        let mut counts = Counts::default();
        let mut window = Window::over(piece, out, self.rules.camera_rays > 1);
        let mut packet = Packet::<V>::new(waiting, stacks);
        let mut supply = Supply::<V>::new();
        // Lanes whose part of a path has ended and has not been retired yet.
        let mut ended = 0_u32;
        loop {
            let idle = V::LANES as u32 - packet.alive.count_ones();
            if ended != 0 && idle >= held::<V>() || packet.alive == 0 {
                self.retire::<V, DIFFUSE_ONLY>(&mut packet, ended, &mut window);
                ended = 0;
                self.refill(&mut packet, &mut supply, &mut window, &mut counts);
                if packet.alive == 0 {
                    return counts;
                }
            }
            let now = self.advance::<V, AIMS, DIFFUSE_ONLY>(&mut packet, &mut counts) & packet.alive;
            packet.alive &= !now;
            ended |= now;
        }
    }
}

/// Idle lanes required before a refill: refilling two costs little more than refilling one, and more than letting one
/// lane wait.
const fn held<V: Float>() -> u32 {
    if V::LANES < 8 { 1 } else { 2 }
}

/// A piece to render. `AIMS`: paths use next-event estimation. `DIFFUSE_ONLY`: every surface of the scene is diffuse.
struct Render<'a, const AIMS: bool, const DIFFUSE_ONLY: bool> {
    kernel: &'a Lanes,
    piece: &'a Piece,
    waiting: &'a mut [Parts],
    stacks: &'a mut [Stack],
    out: &'a mut TileBuffer,
}

impl<const AIMS: bool, const DIFFUSE_ONLY: bool> Work for Render<'_, AIMS, DIFFUSE_ONLY> {
    const IS_SHORTCUT: bool = DIFFUSE_ONLY;
    type Output = Counts;

    #[inline(always)]
    fn run<V: Float>(self) -> Counts {
        self.kernel.follow::<V, AIMS, DIFFUSE_ONLY>(self.piece, self.waiting, self.stacks, self.out)
    }
}

impl Lanes {
    fn render_by<const AIMS: bool, const DIFFUSE_ONLY: bool>(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let splitting = if self.rules.splits > 0 { sizes_of(self.level, self.precision).lanes } else { 0 };
        let mut waiting = vec![NO_PARTS; splitting];
        let mut stacks = self.stacks();
        let work = Render::<AIMS, DIFFUSE_ONLY> {
            kernel: self,
            piece,
            waiting: &mut waiting,
            stacks: Stacks::of_lanes(&mut stacks),
            out,
        };
        on_level(self.level, self.precision, work)
    }
}

impl Kernel for Lanes {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        match (self.rules.nee.is_some(), self.is_diffuse_only) {
            (true, _) => self.render_by::<true, false>(piece, out),
            (false, true) => self.render_by::<false, true>(piece, out),
            (false, false) => self.render_by::<false, false>(piece, out),
        }
    }
}
