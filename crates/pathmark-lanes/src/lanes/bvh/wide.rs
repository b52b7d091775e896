//! The primitives of a scene for searches by one ray at a time.

use super::blocks::{Blocks, BlocksBuilder};
use super::coarse::Scale;
use super::collapse::CollapsedBvh;
use super::linear::Linear;
use super::ray_packet::RayPacket;
use super::tree::{Stack, Traversal, Tree, is_shallow};
use super::uncertain::are_uncertain;
use crate::lanes::rays::{Found, Rays};
use crate::lanes::spheres_f32::SpheresF32;
use crate::lanes::tables::Tables;
use crate::simd::{Apart, Float, Level, Sizes, Table, sizes_of};
use pathmark_tracer::kernel::Counts;
use pathmark_tracer::math::{Precision, Vec3, plane_root};
use pathmark_tracer::scene::{Bounds, Hierarchy, Plane, Scene, Tests};

/// The primitives of a scene.
pub(in crate::lanes) struct Wide {
    /// Spheres that single precision stores by curvature: each is tested against all rays at a time.
    pub(super) large: Option<SpheresF32>,
    /// Planes and the numbers of their primitives, tested likewise.
    pub(super) planes: Vec<(f64, Plane)>,
    pub(super) blocks: Blocks,
    pub(super) search: Search,
}

/// Search among the primitives that are neither planes nor large spheres.
pub(super) enum Search {
    Linear(Linear),
    Tree(Tree),
}

impl Search {
    /// Searches by a tree of these nodes, or without one if it is so deep that more children of a ray may wait than
    /// there is room for. A check for room at each node would cost every search a tenth of its time, and only scenes
    /// made for the purpose have such trees.
    pub(super) fn of(
        collapsed: Option<&CollapsedBvh>,
        width: usize,
        scale: Scale,
        builder: &mut BlocksBuilder<'_>,
    ) -> Self {
        match collapsed.filter(|collapsed| is_shallow(collapsed)) {
            Some(collapsed) => Self::Tree(Tree::of(collapsed, width, scale, builder)),
            None => Self::Linear(builder.all()),
        }
    }
}

/// A search. It takes so long that it need not be part of the loop over vertices.
pub(in crate::lanes) struct Nearest<'a, 's, V: Float> {
    pub(in crate::lanes) scene: &'a Scene,
    pub(in crate::lanes) wide: &'a Wide,
    pub(in crate::lanes) tables: &'a Tables,
    pub(in crate::lanes) rays: &'a Rays<V>,
    pub(in crate::lanes) wanted: u32,
    pub(in crate::lanes) scratch: &'a mut Scratch<'s, V>,
    pub(in crate::lanes) counts: &'a mut Counts,
}

impl<V: Float> Apart for Nearest<'_, '_, V> {
    /// The hits, and the lanes to be searched again, because their hits may not be sure.
    type Output = (Found<V>, u32);

    #[inline(always)]
    fn run(self) -> (Found<V>, u32) {
        let Self { scene, wide, tables, rays, wanted, scratch, counts } = self;
        let (found, out_of_range) = wide.nearest(rays, wanted, &tables.surfaces, scratch, counts);
        let has_triangles = wide.blocks.has_triangles;
        let left = if has_triangles { are_uncertain(scene, tables, &rays.ray, &found, wanted) } else { 0 };
        (found, left | out_of_range)
    }
}

impl Wide {
    /// The primitives of a scene, in a tree made from the hierarchy, if there is one.
    pub(in crate::lanes) fn of(
        scene: &Scene,
        hierarchy: Option<Hierarchy>,
        level: Level,
        precision: Precision,
        enclosing: &[u32],
    ) -> Self {
        let Sizes { register, single: width, .. } = sizes_of(level, precision);
        let large = (precision == Precision::F32).then(|| SpheresF32::large(scene, enclosing));
        let bounds = scene.primitives.bounds().flatten();
        let scale = Scale::of(&bounds.fold(Bounds::EMPTY, |all, own| all.and(&own)));
        let mut builder = BlocksBuilder::new(&scene.primitives, scale, large.as_ref(), [width, register], precision);
        let collapsed = hierarchy.map(|hierarchy| CollapsedBvh::of(hierarchy, width));
        let search = Search::of(collapsed.as_ref(), width, scale, &mut builder);
        let blocks = builder.made();
        let first_plane = scene.primitives.spheres.len() as u32;
        let planes = (first_plane..).map(f64::from).zip(scene.primitives.planes.iter().copied()).collect();
        Self { large, planes, blocks, search }
    }

    /// Whether searches need [`Stack`]s.
    pub(in crate::lanes) fn has_tree(&self) -> bool {
        matches!(self.search, Search::Tree(_))
    }

    /// The nearest primitive along each of the `wanted` rays, and the lanes whose rays are out of range of the tree, to
    /// be searched again. In single precision there are none of these: such a ray meets only planes and large spheres,
    /// because the tests of all other primitives overflow.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(
        &self,
        rays: &Rays<V>,
        wanted: u32,
        surfaces: &Table,
        scratch: &mut Scratch<'_, V>,
        counts: &mut Counts,
    ) -> (Found<V>, u32) {
        let mut found = match &self.large {
            Some(large) => large.scan(rays),
            None => Found::nothing(),
        };
        // The primitive that a ray starts on is not tested, because its other root is known. A ray that starts on none
        // may have any `own_root`.
        let nowhere = V::splat(f64::NAN);
        found.take_in_any_order(rays.from, V::select(V::splat(0.0).le(rays.from), rays.own_root, nowhere));
        for (number, plane) in &self.planes {
            let (point, normal) = (Vec3::splat(plane.point), Vec3::splat(plane.normal));
            found.take(rays, V::splat(*number), plane_root(point - rays.ray.origin, rays.ray.direction, normal));
        }
        let tree = match &self.search {
            Search::Linear(all) => {
                all.nearest(rays, &mut found);
                return (found, 0);
            }
            Search::Tree(tree) => tree,
        };
        let Scratch { stacks, ray_packet } = scratch;
        let stacks = stacks.first_chunk_mut().expect("who has a tree has stacks");
        let in_range = ray_packet.fill(rays, &found, self.blocks.scale, self.blocks.has_triangles);
        let out_of_range = if V::IS_DOUBLE { wanted & !in_range } else { 0 };
        let (wanted, mut tests) = (wanted & in_range, Tests::default());
        V::apart(Traversal {
            tree,
            blocks: &self.blocks,
            surfaces,
            rays: ray_packet,
            wanted,
            stacks,
            tests: &mut tests,
        });
        counts.box_tests += tests.boxes;
        counts.primitive_tests += tests.primitives;
        (Found { nearest: V::load(&ray_packet.nearest), primitive: V::load(&ray_packet.primitive) }, out_of_range)
    }
}

/// Working memory of searches, which also holds their results.
pub(in crate::lanes) struct Scratch<'a, V: Float> {
    /// One for each lane, if there is a tree.
    stacks: &'a mut [Stack],
    ray_packet: RayPacket<V>,
}

impl<'a, V: Float> Scratch<'a, V> {
    #[inline(always)]
    pub(in crate::lanes) fn new(stacks: &'a mut [Stack]) -> Self {
        Self { stacks, ray_packet: RayPacket::empty() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::bvh::Stacks;
    use crate::lanes::tests::{nearest, side_by_side, twice, walks};
    use crate::simd::{MOST_LANES, Work, levels, on_level};
    use pathmark_tracer::kernel::Start;
    use pathmark_tracer::math::{Frame, Ray, line_meets};
    use pathmark_tracer::sampling::uniform_sphere;
    use pathmark_tracer::scene::SurfaceOrigin;
    use pathmark_tracer::scene::{SCENES, load};

    /// Compares with the scalar search, and returns the number of rays that are left to it.
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

    /// In double precision the result equals the scalar search's, to the bit: for rays of walks and rays close to
    /// edges, with and without a tree, with every primitive once and with every primitive twice.
    #[test]
    fn the_search_agrees_with_the_scalar_search() {
        let [mut compared, mut left] = [0, 0];
        for name in SCENES.iter().map(|(name, _)| *name).chain(["spheres:30000", "imbalance:40"]) {
            let scene = load(name).unwrap();
            for scene in
                [scene.accelerated("sah").unwrap(), twice(&scene), twice(&scene).accelerated("median").unwrap(), scene]
            {
                // Without a tree a search among many primitives takes long, and its result is the same.
                if scene.hierarchy.is_none() && scene.owners.len() > 100 {
                    continue;
                }
                let (walks, edges) = walks(&scene, 1000);
                for level in levels() {
                    let wide = Wide::of(&scene, scene.hierarchy.clone(), level, Precision::F64, &[]);
                    for starts in [&walks, &edges] {
                        left += on_level(level, Precision::F64, Compare(&scene, &wide, starts));
                        compared += starts.len();
                    }
                }
            }
        }
        // With every primitive twice, about every other ray seems to meet the twin of the primitive that it starts on.
        assert!(compared > 250_000 && left < compared / 3, "{compared} rays, {left} left");
    }

    /// Scenes so large and so small that their coordinates are out of range in single precision.
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

    /// Rays that leave spheres inwards, so flat that rounding errors may let their lines miss the spheres.
    fn grazing(scene: &Scene) -> Vec<Start> {
        let of_sphere = |(number, sphere): (u32, &pathmark_tracer::scene::Sphere)| {
            let k = f64::from(number);
            let normal = uniform_sphere([(0.618 * k).fract(), (0.414 * k).fract()]);
            let direction = Frame::around(normal).to_world(Vec3::new(1.0, 0.0, -1e-9)).normalized();
            let origin = sphere.center + normal * sphere.radius;
            (Ray { origin, direction }, Some(SurfaceOrigin { primitive: number, inside: true }))
        };
        (0..).zip(&scene.primitives.spheres).map(of_sphere).collect()
    }

    /// A ray that leaves a sphere inwards meets it again, even if its computed line misses the sphere.
    #[test]
    fn rays_that_leave_inwards_meet_their_own_sphere() {
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
