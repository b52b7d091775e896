//! Many paths at a time, in the lanes of SIMD registers: `--kernel lanes`. Each lane follows its own path from vertex
//! to vertex and takes the next sample when the path has ended. Sums are taken in the order of the samples (`window`).
//! So in f64 an image equals the scalar kernel's image, bit for bit, with every instruction set.

mod filter;
mod light;
mod nearest;
mod packet;
mod search;
mod singles;
mod supply;
mod tables;
mod targets;
mod vertex;
#[cfg(test)]
mod walks;
mod wide;
mod window;

use super::{Choice, Counts, Kernel};
use crate::error::Result;
use crate::estimator::PathRules;
use crate::film::{Piece, TileBuffer};
use crate::kernel::in_lanes::InLanes;
use crate::math::Rgb;
use crate::sampling::InLanes as Sampler;
use crate::scene::{Scene, View};
use crate::simd::{Float, Level, MOST_LANES, Precision, Work, on_level, sizes_of};
use filter::Filter;
use packet::{LanesOf, NO_PARTS, NextPart, Packet, Parts};
pub(super) use singles::Singles;
use std::sync::Arc;
use supply::Supply;
use tables::Tables;
pub(super) use tables::surfaces;
use targets::Targets;
use wide::{Stack, Stacks, Wide};
use window::Window;

/// The kernel.
pub(super) struct Lanes {
    scene: Arc<Scene>,
    view: View,
    width: u32,
    seed: u64,
    rules: PathRules,
    sampler: Sampler,
    tables: Tables,
    targets: Option<Box<Targets>>,
    level: Level,
    precision: Precision,
    is_diffuse_only: bool,
    search: Search,
}

/// Method to find the nearest primitive along each ray.
enum Search {
    /// Few primitives, all of them spheres: a quick formula tests every sphere, and an exact one confirms the nearest.
    Filter(Filter),
    /// The same primitives by the formulas of single precision.
    Singles(Singles),
    /// Any primitives: one ray at a time.
    Wide(Box<Wide>),
}

impl Lanes {
    pub(super) fn new(
        scene: &Arc<Scene>,
        choice: &Choice,
        InLanes { level, precision, rules, sampler, is_diffuse_only }: InLanes,
    ) -> Result<Self> {
        let view = choice.view(scene);
        let is_round = scene.is_round();
        let hierarchy = choice.hierarchy(scene)?.or_else(|| scene.hierarchy.clone());
        let search = match precision {
            _ if !is_round || hierarchy.is_some() => {
                Search::Wide(Box::new(Wide::of(scene, hierarchy, level, precision, &scene.enclosing(&view))))
            }
            Precision::F64 => Search::Filter(Filter::of(scene)),
            Precision::F32 => Search::Singles(Singles::of(scene, &scene.enclosing(&view))),
        };
        let lights = choice.estimator.aims.then(|| scene.lights_for(&view));
        Ok(Self {
            targets: lights.as_ref().and_then(|lights| Targets::of(lights, precision)).map(Box::new),
            tables: Tables::of(scene, precision),
            search,
            view,
            precision,
            scene: Arc::clone(scene),
            width: choice.width,
            seed: choice.seed,
            rules,
            sampler,
            level,
            is_diffuse_only,
        })
    }

    /// Stacks for searches, if there is a tree.
    fn stacks(&self) -> Option<Box<Stacks>> {
        matches!(&self.search, Search::Wide(wide) if wide.has_tree()).then(Stacks::new)
    }

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
        match (self.rules.aims.is_some(), self.is_diffuse_only) {
            (true, _) => self.render_by::<true, false>(piece, out),
            (false, true) => self.render_by::<false, true>(piece, out),
            (false, false) => self.render_by::<false, false>(piece, out),
        }
    }
}
