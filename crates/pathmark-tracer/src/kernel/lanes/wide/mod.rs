//! One ray against many boxes or primitives at a time: for scenes with triangles, and for large ones. Rays of a packet go anywhere, so one that looks
//! into a hierarchy by itself tests fewer boxes than all of them together (Wald, Benthin and Boulos, "Getting Rid of Packets", 2008).
//!
//! What it finds does not depend on how many are tested at a time: what is tested in single precision first has a padding that covers all rounding,
//! and among equally near primitives the lowest number wins. In double precision it is what the scalar search finds, to the bit; in single precision
//! each primitive is tested by one formula, in a tree and without one: spheres by those of [`Singles`].

mod all;
mod blocks;
mod bundle;
mod coarse;
mod doubt;
mod sure;
mod tree;

use super::nearest::Found;
use super::packet::{LanesOf, Rays};
use super::singles::Singles;
use super::tables::Tables;
use crate::kernel::Counts;
use crate::math::{Vec3, plane_root};
use crate::scene::{Bounds, Gathered, Hierarchy, Plane, Scene, Tests};
use crate::simd::{Apart, Float, Level, Mask, Precision, Sizes, Table, sizes_of};
use all::All;
use blocks::{Blocks, Making};
use bundle::Bundle;
use coarse::Scale;
use doubt::are_doubtful;
use tree::{Descent, Tree, is_shallow};
pub(in crate::kernel::lanes) use tree::{Stack, Stacks};

/// The primitives of a scene.
pub(in crate::kernel::lanes) struct Wide {
    /// Spheres that single precision has by their curvature: all rays at a time.
    large: Option<Singles>,
    /// Likewise, with the numbers of their primitives.
    planes: Vec<(f64, Plane)>,
    blocks: Blocks,
    search: Search,
}

/// How primitives are searched that are no planes and are not large.
enum Search {
    All(All),
    Tree(Tree),
}

impl Search {
    /// A search of so many primitives by a tree of these nodes. One so deep that a ray may leave more for later than there is place for is not used:
    /// to ask for place at each node costs every search a tenth of its time, and such trees are of scenes made for it.
    fn of(gathered: Option<&Gathered>, width: usize, scale: Scale, making: &mut Making<'_>) -> Self {
        match gathered.filter(|gathered| is_shallow(gathered)) {
            Some(gathered) => Self::Tree(Tree::of(gathered, width, scale, making)),
            None => Self::All(making.all()),
        }
    }
}

/// A search, which takes so long that it need not be part of the loop over vertices.
pub(in crate::kernel::lanes) struct Nearest<'a, 's, V: Float> {
    pub(in crate::kernel::lanes) scene: &'a Scene,
    pub(in crate::kernel::lanes) wide: &'a Wide,
    pub(in crate::kernel::lanes) tables: &'a Tables,
    pub(in crate::kernel::lanes) rays: &'a Rays<V>,
    pub(in crate::kernel::lanes) wanted: u32,
    pub(in crate::kernel::lanes) scratch: &'a mut Scratch<'s, V>,
    pub(in crate::kernel::lanes) counts: &'a mut Counts,
}

impl<V: Float> Apart for Nearest<'_, '_, V> {
    /// And the lanes that are to be searched again, because they may not surely meet what was found.
    type Output = (Found<V>, u32);

    #[inline(always)]
    fn run(self) -> (Found<V>, u32) {
        let Self { scene, wide, tables, rays, wanted, scratch, counts } = self;
        let found = wide.nearest(rays, wanted, &tables.surfaces, scratch, counts);
        let has_triangles = wide.blocks.has_triangles;
        let left = if has_triangles { are_doubtful(scene, tables, &rays.ray, &found, wanted) } else { 0 };
        (found, left)
    }
}

impl Wide {
    /// The primitives of a scene, in a tree that is made of the hierarchy, if there is one.
    pub(in crate::kernel::lanes) fn of(
        scene: &Scene,
        hierarchy: Option<Hierarchy>,
        level: Level,
        precision: Precision,
        enclosing: &[u32],
    ) -> Self {
        let Sizes { register, single: width, .. } = sizes_of(level, precision);
        let large = (precision == Precision::F32).then(|| Singles::large(scene, enclosing));
        let bounds = scene.primitives.bounds().flatten();
        let scale = Scale::of(&bounds.fold(Bounds::EMPTY, |all, own| all.and(&own)));
        let mut making = Making::new(&scene.primitives, scale, large.as_ref(), [width, register], precision);
        let gathered = hierarchy.map(|hierarchy| hierarchy.gathered(width));
        let search = Search::of(gathered.as_ref(), width, scale, &mut making);
        let blocks = making.made();
        let first_plane = scene.primitives.spheres.len() as u32;
        let planes = (first_plane..).map(f64::from).zip(scene.primitives.planes.iter().copied()).collect();
        Self { large, planes, blocks, search }
    }

    /// Whether searches need [`Stack`]s.
    pub(in crate::kernel::lanes) fn has_tree(&self) -> bool {
        matches!(self.search, Search::Tree(_))
    }

    /// The first thing along each of the `wanted` rays.
    #[inline(always)]
    fn nearest<V: Float>(
        &self,
        rays: &Rays<V>,
        wanted: u32,
        surfaces: &Table,
        scratch: &mut Scratch<'_, V>,
        counts: &mut Counts,
    ) -> Found<V> {
        let mut found = match &self.large {
            Some(large) => large.scan(rays),
            None => Found::nothing(),
        };
        // What a ray starts on is not tested: where it will be met again is known. A ray that starts on nothing has any `own_root`.
        let nowhere = V::splat(f64::NAN);
        found.take_in_any_order(rays.from, V::select(V::splat(0.0).le(rays.from), rays.own_root, nowhere));
        for (number, plane) in &self.planes {
            let (point, normal) = (Vec3::splat(plane.point), Vec3::splat(plane.normal));
            found.take(rays, V::splat(*number), plane_root(point - rays.ray.origin, rays.ray.direction, normal));
        }
        let tree = match &self.search {
            Search::All(all) => {
                all.nearest(rays, &mut found);
                return found;
            }
            Search::Tree(tree) => tree,
        };
        let Scratch { stacks, bundle } = scratch;
        let stacks = stacks.first_chunk_mut().expect("who has a tree has stacks");
        bundle.fill(rays, &found, self.blocks.scale, self.blocks.has_triangles);
        let mut tests = Tests::default();
        V::apart(Descent { tree, blocks: &self.blocks, surfaces, rays: bundle, wanted, stacks, tests: &mut tests });
        counts.box_tests += tests.boxes;
        counts.primitive_tests += tests.primitives;
        Found { nearest: V::load(&bundle.nearest), primitive: V::load(&bundle.primitive) }
    }
}

/// What searches write to and leave behind.
pub(in crate::kernel::lanes) struct Scratch<'a, V: Float> {
    /// As many as there are lanes, where there is a tree.
    stacks: &'a mut [Stack],
    bundle: Bundle<V>,
}

impl<'a, V: Float> Scratch<'a, V> {
    #[inline(always)]
    pub(in crate::kernel::lanes) fn new(stacks: &'a mut [Stack]) -> Self {
        Self { stacks, bundle: Bundle::empty() }
    }
}

/// What a ray met so far: a distance and a number, -1 for nothing.
struct Best {
    nearest: f64,
    primitive: f64,
}

impl Best {
    /// A distance to the primitive with this number.
    #[inline(always)]
    fn take_one(&mut self, distance: f64, primitive: f64) {
        let is_lower = distance == self.nearest && primitive < self.primitive;
        let is_first = distance > 0.0 && (distance < self.nearest || is_lower);
        self.nearest = if is_first { distance } else { self.nearest };
        self.primitive = if is_first { primitive } else { self.primitive };
    }

    /// Distances to the primitives with these numbers, in the order of the lanes, where most rays meet one of them or none.
    #[inline(always)]
    fn take_few<V: Float>(&mut self, numbers: &[V::One], distance: V) {
        let ahead = V::splat(0.0).lt(distance) & distance.le(V::splat(self.nearest));
        for lane in LanesOf(ahead.bits()) {
            self.take_one(distance.lane(lane), numbers[lane].into());
        }
    }

    /// Likewise, where many rays meet several.
    #[inline(always)]
    fn take<V: Float>(&mut self, numbers: &[V::One], distance: V) {
        let ahead = V::splat(0.0).lt(distance) & distance.le(V::splat(self.nearest));
        if ahead.any() {
            let nearest = V::select(ahead, distance, V::splat(f64::INFINITY)).least();
            for lane in LanesOf((ahead & distance.equal(V::splat(nearest))).bits()) {
                let primitive = numbers[lane].into();
                if nearest < self.nearest || primitive < self.primitive {
                    *self = Self { nearest, primitive };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::lanes::walks::{nearest, side_by_side, walks};
    use crate::kernel::rays::Start;
    use crate::math::{Frame, Ray, line_meets};
    use crate::sampling::uniform_sphere;
    use crate::scene::Standpoint;
    use crate::scene::{SCENES, load};
    use crate::simd::{MOST_LANES, Work, levels, on_level};

    /// Compares with the scalar search, and returns how many rays are left to it.
    struct Compare<'a>(&'a Scene, &'a Wide, &'a [Start]);

    impl Work for Compare<'_> {
        type Output = usize;

        #[inline(always)]
        fn run<V: Float>(self) -> usize {
            let Self(scene, wide, starts) = self;
            let tables = Tables::of(scene, Precision::F64);
            let mut all_left = 0;
            let mut stacks = Stacks::new();
            for starts in starts.chunks_exact(V::LANES) {
                let wanted = u32::MAX >> (MOST_LANES - V::LANES);
                let rays = side_by_side::<V>(scene, starts);
                let counts = &mut Counts::default();
                let scratch = &mut Scratch::new(&mut stacks.0);
                let (found, left) =
                    Nearest { scene, wide, tables: &tables, rays: &rays, wanted, scratch, counts }.run();
                all_left += left.count_ones() as usize;
                for (lane, start) in starts.iter().enumerate().filter(|(lane, _)| left >> lane & 1 == 0) {
                    let (t, primitive) = nearest(scene, start);
                    let found = (found.nearest.lane(lane), found.primitive.lane(lane));
                    assert_eq!((found.0.to_bits(), found.1), (t.to_bits(), primitive), "{}: {start:?}", scene.name);
                }
            }
            all_left
        }
    }

    /// The scene with everything in it twice, so that every hit is a tie.
    pub(super) fn twice(scene: &Scene) -> Scene {
        let mut twice = scene.clone();
        let primitives = &mut twice.primitives;
        let (spheres, planes) = (primitives.spheres.len(), primitives.planes.len());
        primitives.spheres.extend_from_within(..);
        primitives.planes.extend_from_within(..);
        primitives.triangles.extend_from_within(..);
        let owners = |range: std::ops::Range<usize>| scene.owners[range].repeat(2);
        let [first, second] = [spheres, spheres + planes];
        twice.owners = [owners(0..first), owners(first..second), owners(second..scene.owners.len())].concat();
        twice
    }

    /// In double precision it is the scalar search to the bit, for rays of walks and rays down to the edges between things, in a tree and without one,
    /// where all are there once and where all are there twice.
    #[test]
    fn what_is_found_is_what_the_scalar_search_finds() {
        let [mut compared, mut left] = [0, 0];
        for name in SCENES.iter().map(|(name, _)| *name).chain(["spheres:30000", "imbalance:40"]) {
            let scene = load(name).unwrap();
            for scene in
                [scene.accelerated("sah").unwrap(), twice(&scene), twice(&scene).accelerated("median").unwrap(), scene]
            {
                // What is found without a tree takes long for many, and is no other.
                if scene.hierarchy.is_none() && scene.owners.len() > 100 {
                    continue;
                }
                let (walks, edges) = walks(&scene, 4000);
                for level in levels() {
                    let wide = Wide::of(&scene, scene.hierarchy.clone(), level, Precision::F64, &[]);
                    for starts in [&walks, &edges] {
                        left += on_level(level, Precision::F64, Compare(&scene, &wide, starts));
                        compared += starts.len();
                    }
                }
            }
        }
        // Of what is there twice every other ray seems to meet the twin of what it starts on.
        assert!(compared > 1_000_000 && left < compared / 3, "{compared} rays, {left} left");
    }

    /// Scenes so large and so small that single precision has no numbers for them.
    #[test]
    fn size_does_not_matter() {
        for name in ["spheres:300", "cornell-mesh", "imbalance:40"] {
            for exponent in [-300, -140, -40, 40, 140, 300] {
                let scene = load(name).unwrap().scaled(libm::exp2(f64::from(exponent))).accelerated("sah").unwrap();
                let (walks, edges) = walks(&scene, 1000);
                for level in levels() {
                    let wide = Wide::of(&scene, scene.hierarchy.clone(), level, Precision::F64, &[]);
                    for starts in [&walks, &edges] {
                        let left = on_level(level, Precision::F64, Compare(&scene, &wide, starts));
                        assert!(left < starts.len() / 10, "{left} left");
                    }
                }
            }
        }
    }

    /// Rays that leave spheres inwards, so flat that their lines pass them for all that rounding says.
    fn grazing(scene: &Scene) -> Vec<Start> {
        let of_sphere = |(number, sphere): (u32, &crate::scene::Sphere)| {
            let k = f64::from(number);
            let normal = uniform_sphere([(0.618 * k).fract(), (0.414 * k).fract()]);
            let direction = Frame::around(normal).to_world(Vec3::new(1.0, 0.0, -1e-9)).normalized();
            let origin = sphere.center + normal * sphere.radius;
            (Ray { origin, direction }, Some(Standpoint { primitive: number, inside: true }))
        };
        (0..).zip(&scene.primitives.spheres).map(of_sphere).collect()
    }

    /// Where a ray leaves a sphere inwards it meets it again, whether its line does or not.
    #[test]
    fn what_leaves_inwards_meets_its_own_sphere() {
        let scene = load("spheres:2048").unwrap().accelerated("sah").unwrap();
        let starts = grazing(&scene);
        let line_passes = |(ray, from): &&Start| {
            let sphere = &scene.primitives.spheres[from.unwrap().primitive as usize];
            !line_meets(ray.origin - sphere.center, ray.direction, 1.0, sphere.radius)
        };
        assert!(starts.iter().filter(line_passes).count() > 500);
        for level in levels() {
            let wide = Wide::of(&scene, scene.hierarchy.clone(), level, Precision::F64, &[]);
            assert_eq!(on_level(level, Precision::F64, Compare(&scene, &wide, &starts)), 0);
        }
    }
}
