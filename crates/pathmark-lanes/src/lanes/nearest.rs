//! The nearest primitive along each ray.

use super::bvh::{Nearest, Scratch};
use super::kernel::{Lanes, Search};
use super::rays::{Found, LanesOf, Rays};
use crate::simd::{Apart, Float, MOST_LANES, Mask};
use pathmark_tracer::kernel::Counts;
use pathmark_tracer::math::{Ray, Vec3};
use pathmark_tracer::scene::{SurfaceOrigin, Tests};

impl Lanes {
    /// Distance and number of the nearest primitive along each ray; the number is -1 if there is none. Lanes that are
    /// not `wanted` have meaningless results. Ties go to the lowest number, as in the scalar search.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(
        &self,
        rays: &Rays<V>,
        wanted: u32,
        scratch: &mut Scratch<'_, V>,
        counts: &mut Counts,
    ) -> (V, V) {
        let (mut found, left) = match &self.search {
            Search::Filter(filter) if V::IS_DOUBLE => {
                let (found, is_sure) = filter.nearest(&self.tables, rays);
                (found, wanted & !is_sure.bits())
            }
            Search::SpheresF32(singles) if !V::IS_DOUBLE => (singles.scan(rays), 0),
            Search::Wide(wide) => {
                Nearest { scene: &self.scene, wide, tables: &self.tables, rays, wanted, scratch, counts }.run()
            }
            // A search for the other precision is never run.
            _ => (Found::nothing(), wanted),
        };
        if left != 0 {
            self.one_by_one(rays, left, &mut found, counts);
        }
        (found.nearest, found.primitive)
    }

    /// Searches along each ray separately.
    #[inline(always)]
    fn one_by_one<V: Float>(&self, rays: &Rays<V>, wanted: u32, found: &mut Found<V>, counts: &mut Counts) {
        let Ray { origin, direction } = rays.ray;
        let mut all = AllRays { numbers: [[V::One::default(); MOST_LANES]; 8] };
        let vectors = [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, rays.from, rays.own_root];
        for (numbers, vector) in all.numbers.iter_mut().zip(&vectors) {
            vector.store(numbers);
        }
        let [mut nearest, mut primitive] = [[V::One::default(); MOST_LANES]; 2];
        found.nearest.store(&mut nearest);
        found.primitive.store(&mut primitive);
        all.ask(self, wanted, [&mut nearest, &mut primitive], (V::one, V::SIGNIFICAND), counts);
        found.nearest = V::load(&nearest);
        found.primitive = V::load(&primitive);
    }
}

/// Rays in memory instead of registers: origins, directions, the primitives that they start on, and the distances at
/// which they meet these again.
struct AllRays<T> {
    numbers: [[T; MOST_LANES]; 8],
}

impl<T: Copy + Into<f64>> AllRays<T> {
    /// Finds the nearest primitives: distances and numbers. It needs no SIMD instructions and is compiled apart from
    /// code with them.
    #[inline(never)]
    fn ask(
        &self,
        lanes: &Lanes,
        wanted: u32,
        [nearest, primitive]: [&mut [T; MOST_LANES]; 2],
        (one, digits): (fn(f64) -> T, u32),
        counts: &mut Counts,
    ) {
        let mut tests = Tests::default();
        for lane in LanesOf(wanted) {
            let [ox, oy, oz, dx, dy, dz, from, own_root] = self.numbers.each_ref().map(|numbers| numbers[lane].into());
            let ray = Ray { origin: Vec3::new(ox, oy, oz), direction: Vec3::new(dx, dy, dz) };
            // Only a ray into a sphere has another root; a flat primitive has none on either side.
            let inside = !own_root.is_nan();
            let from = (from >= 0.0).then_some(SurfaceOrigin { primitive: from as u32, inside });
            let found = match &lanes.search {
                Search::Wide(wide) => wide.surely_nearest(&lanes.scene, &ray, from, digits, &mut tests),
                _ => lanes.scene.nearest(&ray, from, digits, &mut tests),
            };
            nearest[lane] = one(found.t);
            primitive[lane] = one(if found.primitive == u32::MAX { -1.0 } else { found.primitive.into() });
        }
        counts.box_tests += tests.boxes;
        counts.primitive_tests += tests.primitives;
    }
}
