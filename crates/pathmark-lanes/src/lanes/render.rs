//! Rendering of a piece: packets of paths, refilled from the window of samples.

use super::bvh::{Stack, Stacks};
use super::kernel::{Lanes, Version};
use super::others::Others;
use super::packet::{NO_PARTS, NextPart, Packet, Parts};
use super::rays::LanesOf;
use super::supply::Supply;
use super::vertex::Materials;
use super::window::Window;
use crate::simd::{Float, MOST_LANES, Work, on_level, sizes_of};
use pathmark_tracer::effect::EffectSet;
use pathmark_tracer::film::{Piece, TileBuffer};
use pathmark_tracer::kernel::{Counts, Kernel};
use pathmark_tracer::math::Rgb;
#[cfg(feature = "lane-profiles")]
use pathmark_tracer::scene::SmallptEffects;
use pathmark_tracer::scene::{AllEffects, DiffuseOnly};
use std::marker::PhantomData;

impl Lanes {
    /// Gives back the samples whose paths have ended. A path with a waiting part continues with that part.
    #[inline(always)]
    fn retire<V: Float, X: EffectSet>(&self, packet: &mut Packet<'_, V>, ended: u32, window: &mut Window<'_>) {
        let [mut r, mut g, mut b] = [[V::One::default(); MOST_LANES]; 3];
        packet.collected.r.store(&mut r);
        packet.collected.g.store(&mut g);
        packet.collected.b.store(&mut b);
        for lane in LanesOf(ended) {
            if Materials::<X>::HAVE_GLASS && self.rules.splits > 0 && V::apart(NextPart { packet, lane }) {
                packet.alive |= 1 << lane;
            } else {
                window.give_back(packet.slots[lane], Rgb { r: r[lane].into(), g: g[lane].into(), b: b[lane].into() });
            }
        }
    }

    #[inline(always)]
    fn follow<V: Float, X: EffectSet, const AIMS: bool>(
        &self,
        piece: &Piece,
        waiting: &mut [Parts],
        stacks: &mut [Stack],
        out: &mut TileBuffer,
    ) -> Counts {
        let mut counts = Counts::default();
        let mut window = Window::over(piece, out, self.rules.camera_rays > 1);
        let mut others = Others::new();
        let mut packet = Packet::<V>::new(waiting, stacks, &mut others);
        let mut supply = Supply::<V>::new();
        // Lanes whose part of a path has ended and has not been retired yet.
        let mut ended = 0_u32;
        loop {
            let idle = V::LANES as u32 - packet.alive.count_ones();
            if ended != 0 && idle >= held::<V>() || packet.alive == 0 {
                self.retire::<V, X>(&mut packet, ended, &mut window);
                ended = 0;
                self.refill(&mut packet, &mut supply, &mut window, &mut counts);
                if packet.alive == 0 {
                    return counts;
                }
            }
            let now = self.advance::<V, X, AIMS>(&mut packet, &mut counts) & packet.alive;
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

/// A piece to render. `AIMS`: paths use next-event estimation. `X`: the materials of the scene.
struct Render<'a, X: EffectSet, const AIMS: bool> {
    kernel: &'a Lanes,
    piece: &'a Piece,
    waiting: &'a mut [Parts],
    stacks: &'a mut [Stack],
    out: &'a mut TileBuffer,
    materials: PhantomData<X>,
}

impl<X: EffectSet, const AIMS: bool> Work for Render<'_, X, AIMS> {
    const IS_SHORTCUT: bool = !X::EFFECTS.is(AllEffects::EFFECTS);
    type Output = Counts;

    #[inline(always)]
    fn run<V: Float>(self) -> Counts {
        self.kernel.follow::<V, X, AIMS>(self.piece, self.waiting, self.stacks, self.out)
    }
}

impl Lanes {
    fn render_by<X: EffectSet, const AIMS: bool>(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        // The whole kernels take most of this crate's build, and integration tests have them all.
        if cfg!(test) {
            unreachable!("no unit test renders");
        }
        let splitting = if self.rules.splits > 0 { sizes_of(self.level, self.precision).lanes } else { 0 };
        let mut waiting = vec![NO_PARTS; splitting];
        let mut stacks = self.stacks();
        let work = Render::<X, AIMS> {
            kernel: self,
            piece,
            waiting: &mut waiting,
            stacks: Stacks::of_lanes(&mut stacks),
            out,
            materials: PhantomData,
        };
        on_level(self.level, self.precision, work)
    }
}

impl Kernel for Lanes {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        match self.version {
            _ if self.rules.nee.is_some() => self.render_by::<AllEffects, true>(piece, out),
            Version::Diffuse => self.render_by::<DiffuseOnly, false>(piece, out),
            #[cfg(feature = "lane-profiles")]
            Version::Smallpt => self.render_by::<SmallptEffects, false>(piece, out),
            Version::All => self.render_by::<AllEffects, false>(piece, out),
        }
    }
}
