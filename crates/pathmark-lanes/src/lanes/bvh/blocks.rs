//! Blocks of primitives of one kind: as many spheres as a register holds numbers of single precision, or as many
//! triangles as it holds numbers of the lanes' precision.

use super::best::Best;
use super::coarse::Scale;
use super::linear::Linear;
use super::ray_packet::{ShearedRay, Single};
use crate::lanes::rays::LanesOf;
use crate::lanes::spheres_f32::SpheresF32;
use crate::simd::{Aligned, Float, Mask, Number, Numbers, Table, prefetch};
use pathmark_tracer::math::{Crossing, Precision, Real, Vec3, first_root, sheared};
use pathmark_tracer::scene::{Bounds, Primitive, Primitives};

/// Numbers of a sphere: its centre, a padded radius and its number.
const OF_SPHERE: usize = 5;
/// Exact numbers of a sphere: its centre and its radius.
const OF_EXACT: usize = 4;
/// Numbers of a triangle: its three corners and its number.
const OF_TRIANGLE: usize = 10;
/// The number in a place without a primitive; all others are at least -1.
const NO_NUMBER: f64 = -2.0;
/// Values in a place without a sphere: with this radius every ray starts behind it.
const NO_SPHERE: ([f64; 4], [f64; 4]) = ([0.0, 0.0, 0.0, f64::NEG_INFINITY], [f64::NAN; 4]);

/// Blocks. Each stores the first number of all its primitives, then the second, and so on.
pub(super) struct Blocks {
    /// Scaled and padded as in [`super::coarse`].
    spheres: Aligned<f32>,
    /// The same spheres in the same order, with exact centres and radii: block by block, first all x, then y, z and the
    /// radii. Only in single precision. Double precision reads single spheres from the table of surfaces.
    exact: Aligned<f32>,
    triangles: Numbers,
    /// Spheres in a block, and triangles in one.
    widths: [usize; 2],
    pub(super) has_triangles: bool,
    pub(super) scale: Scale,
}

/// The blocks of a leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    /// The first block of spheres and the block behind the last; likewise of triangles.
    pub(super) spheres: [u32; 2],
    triangles: [u32; 2],
    /// Number of primitives in them.
    pub(super) primitives: u32,
}

/// Blocks under construction.
pub(super) struct BlocksBuilder<'a> {
    primitives: &'a Primitives,
    scale: Scale,
    /// Spheres that are tested elsewhere.
    large: Option<&'a SpheresF32>,
    /// Spheres in a block, and triangles in one.
    widths: [usize; 2],
    spheres: Aligned<f32>,
    exact: Aligned<f32>,
    triangles: Numbers,
}

impl<'a> BlocksBuilder<'a> {
    pub(super) fn new(
        primitives: &'a Primitives,
        scale: Scale,
        large: Option<&'a SpheresF32>,
        widths: [usize; 2],
        precision: Precision,
    ) -> Self {
        let none = || Aligned::with_capacity(0);
        let triangles = Numbers::with_capacity(0, precision);
        Self { primitives, scale, large, widths, spheres: none(), exact: none(), triangles }
    }

    /// Reserves room for leaves with these numbers of primitives. Gradual growth would take half as much memory again.
    pub(super) fn make_room(&mut self, leaves: impl Iterator<Item = usize>) {
        let precision = self.triangles.precision();
        let [of_spheres, of_triangles] = self.widths;
        let (mut spheres, mut triangles) = (0, 0);
        for primitives in leaves {
            spheres += primitives.next_multiple_of(of_spheres);
            triangles += primitives.next_multiple_of(of_triangles);
        }
        // If there are both kinds, each leaf counts for both, and memory that is not used is never touched.
        if !self.primitives.spheres.is_empty() {
            self.spheres = Aligned::with_capacity(OF_SPHERE * spheres);
            self.exact = Aligned::with_capacity(if precision == Precision::F32 { OF_EXACT * spheres } else { 0 });
        }
        if !self.primitives.triangles.is_empty() {
            self.triangles = Numbers::with_capacity(OF_TRIANGLE * triangles, precision);
        }
    }

    /// Puts the primitives with these numbers into new blocks, without planes and spheres that are tested elsewhere.
    pub(super) fn add(&mut self, numbers: impl IntoIterator<Item = u32>) -> Leaf {
        let first_flat = self.primitives.spheres.len();
        let first_triangle = first_flat + self.primitives.planes.len();
        let (mut spheres, mut triangles) = (Vec::new(), Vec::new());
        for number in numbers {
            let index = number as usize;
            if index < first_flat {
                if !self.large.is_some_and(|large| large.contains(number)) {
                    spheres.push(number);
                }
            } else if let Some(index) = index.checked_sub(first_triangle) {
                let [a, b, c] = self.primitives.triangles[index].corners;
                triangles.push([a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, number.into()]);
            }
        }
        Leaf {
            primitives: (spheres.len() + triangles.len()) as u32,
            spheres: self.add_spheres(&spheres),
            triangles: self.add_triangles(&triangles),
        }
    }

    /// Appends spheres in blocks and fills up the last block. Returns the first block and the block behind the last.
    fn add_spheres(&mut self, numbers: &[u32]) -> [u32; 2] {
        let width = self.widths[0];
        let count = |spheres: &[f32]| (spheres.len() / (OF_SPHERE * width)) as u32;
        let first = count(&self.spheres);
        for block in numbers.chunks(width) {
            let of_lane = |lane: usize| block.get(lane).map_or(NO_SPHERE, |number| self.sphere(*number));
            let spheres: Vec<([f64; 4], [f64; 4])> = (0..width).map(of_lane).collect();
            for k in 0..4 {
                self.spheres.extend(spheres.iter().map(|(outline, _)| outline[k] as f32));
            }
            let number = |lane: usize| block.get(lane).map_or(NO_NUMBER, |number| f64::from(*number)) as f32;
            self.spheres.extend((0..width).map(number));
            if self.triangles.precision() == Precision::F32 {
                for k in 0..OF_EXACT {
                    self.exact.extend(spheres.iter().map(|(_, exact)| exact[k] as f32));
                }
            }
        }
        [first, count(&self.spheres)]
    }

    /// A sphere for the coarse test, and its exact numbers.
    fn sphere(&self, number: u32) -> ([f64; 4], [f64; 4]) {
        let sphere = &self.primitives.spheres[number as usize];
        let Vec3 { x, y, z } = sphere.center;
        let bounds = sphere.bounds().unwrap_or(Bounds::EMPTY);
        (self.scale.sphere(&bounds, sphere.center, sphere.radius), [x, y, z, sphere.radius])
    }

    /// Appends triangles likewise.
    fn add_triangles(&mut self, triangles: &[[f64; OF_TRIANGLE]]) -> [u32; 2] {
        let width = self.widths[1];
        let count = |blocks: &Numbers| (blocks.len() / (OF_TRIANGLE * width)) as u32;
        let first = count(&self.triangles);
        for block in triangles.chunks(width) {
            for k in 0..OF_TRIANGLE {
                let nothing = if k == OF_TRIANGLE - 1 { NO_NUMBER } else { f64::NAN };
                self.triangles.extend((0..width).map(|lane| block.get(lane).map_or(nothing, |numbers| numbers[k])));
            }
        }
        [first, count(&self.triangles)]
    }

    /// All primitives, for tests without blocks.
    pub(super) fn all(&self) -> Linear {
        Linear::of(self.primitives, self.large)
    }

    pub(super) fn made(self) -> Blocks {
        Blocks {
            has_triangles: !self.primitives.triangles.is_empty(),
            widths: self.widths,
            spheres: self.spheres,
            exact: self.exact,
            triangles: self.triangles,
            scale: self.scale,
        }
    }
}

/// The numbers of all triangles of a block in one place.
#[inline(always)]
fn column<V: Float>(block: &[V::One], place: usize) -> &[V::One] {
    &block[place * V::LANES..][..V::LANES]
}

/// Corners in the ray's axes. Their first coordinate is in the place `first`.
#[inline(always)]
fn corner<V: Float>(block: &[V::One], first: usize, ray: &ShearedRay<V>) -> [V; 3] {
    // No axis is above 2; with this explicit bound, places in a block need no check.
    let [x, y, z] = ray.shear.axes.map(|axis| axis.min(2));
    let [ox, oy, oz] = ray.origin;
    let x = V::load(column::<V>(block, first + x)) - ox;
    let y = V::load(column::<V>(block, first + y)) - oy;
    let z = V::load(column::<V>(block, first + z)) - oz;
    sheared([x, y, z], ray.shear.by)
}

impl Leaf {
    /// Whether it holds more than one block of spheres.
    #[inline(always)]
    pub(super) fn has_more_spheres(&self) -> bool {
        self.spheres[0] + 1 < self.spheres[1]
    }

    #[inline(always)]
    pub(super) fn has_triangles(&self) -> bool {
        self.triangles[0] < self.triangles[1]
    }
}

impl Blocks {
    /// Distances to the spheres of a block, by the formula of [`SpheresF32`] and with the same bits.
    #[inline(always)]
    fn roots_in_block<W: Float<One = f32>>(&self, block: usize, origin: Vec3, direction: Vec3) -> W {
        let exact = &self.exact[block * OF_EXACT * W::LANES..];
        let (x, y) = (W::load(exact), W::load(&exact[W::LANES..]));
        let (z, radius) = (W::load(&exact[2 * W::LANES..]), W::load(&exact[3 * W::LANES..]));
        first_root(Vec3::splat(origin) - Vec3 { x, y, z }, Vec3::splat(direction), W::splat(1.0), radius)
    }

    #[inline(always)]
    pub(super) fn has_spheres(&self) -> bool {
        !self.spheres.is_empty()
    }

    pub(super) fn numbers(&self, leaf: &Leaf) -> impl Iterator<Item = u32> {
        let [of_spheres, of_triangles] = self.widths;
        let places = |[first, end]: [u32; 2], of_one: usize, width: usize| {
            (first..end)
                .flat_map(move |block| (0..width).map(move |lane| ((block as usize + 1) * of_one - 1) * width + lane))
        };
        let spheres = places(leaf.spheres, OF_SPHERE, of_spheres).map(|place| f64::from(self.spheres[place]));
        let triangles = places(leaf.triangles, OF_TRIANGLE, of_triangles).map(|place| self.triangles.at(place));
        spheres.chain(triangles).filter(|number| *number >= 0.0).map(|number| number as u32)
    }

    /// Their size in bytes.
    #[inline(always)]
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.spheres) + size_of_val(&*self.exact) + self.triangles.bytes()
    }

    /// Prefetches the first triangles of a leaf.
    #[inline(always)]
    pub(super) fn prefetch<V: Float>(&self, leaf: &Leaf) {
        let of_block = OF_TRIANGLE * V::Register::LANES;
        prefetch::<V, _>(V::One::all(&self.triangles), leaf.triangles[0] as usize * of_block, of_block);
    }

    /// The spheres of a block that a ray comes near, no farther than `limit` in sizes of the scene, as bits.
    #[inline(always)]
    pub(super) fn near<V: Float>(&self, block: u32, ray: &Single<V>, limit: f32) -> u32 {
        let lanes = V::Single::LANES;
        let spheres = &self.spheres[block as usize * OF_SPHERE * lanes..][..OF_SPHERE * lanes];
        let numbers = V::Single::load(&spheres[(OF_SPHERE - 1) * lanes..]);
        let is_own = V::Single::splat(ray.from).equal(numbers);
        (!(ray.coarse.passes(spheres, limit) | is_own)).bits()
    }

    /// Tests a ray against the spheres `near` of a block.
    #[inline(always)]
    pub(super) fn test_near<V: Float>(
        &self,
        block: u32,
        near: u32,
        surfaces: &Table,
        ray: &Single<V>,
        best: &mut Best,
    ) {
        let lanes = V::Single::LANES;
        let block = block as usize;
        let numbers = &self.spheres[(block * OF_SPHERE + OF_SPHERE - 1) * lanes..][..lanes];
        if V::IS_DOUBLE {
            // Most rays come near one sphere of a block, or none.
            for lane in LanesOf(near) {
                let [x, y, z, radius] = *surfaces.row(numbers[lane] as i32);
                let root = first_root(ray.origin - Vec3::new(x, y, z), ray.direction, 1.0, radius);
                best.take_one(root, numbers[lane].into());
            }
        } else {
            let roots = self.roots_in_block::<V::Single>(block, ray.origin, ray.direction);
            let is_near = <V::Single as Real>::Mask::from_bits(near);
            best.take(numbers, V::Single::select(is_near, roots, V::Single::splat(f64::NAN)));
        }
    }

    /// Tests a ray against all spheres of a leaf except its first block.
    #[inline(always)]
    pub(super) fn test_more_spheres<V: Float>(&self, leaf: &Leaf, surfaces: &Table, ray: &Single<V>, best: &mut Best) {
        for block in leaf.spheres[0] + 1..leaf.spheres[1] {
            let near = self.near(block, ray, self.scale.limit(best.nearest));
            if near != 0 {
                self.test_near(block, near, surfaces, ray, best);
            }
        }
    }

    /// Tests a ray that starts on the primitive `from` against all triangles of a leaf.
    #[inline(always)]
    pub(super) fn test_triangles<V: Float>(
        &self,
        leaf: &Leaf,
        from: f64,
        ray: &ShearedRay<V::Register>,
        best: &mut Best,
    ) {
        let triangles = V::One::all(&self.triangles);
        for block in leaf.triangles[0]..leaf.triangles[1] {
            let of_block = OF_TRIANGLE * V::Register::LANES;
            let block = &triangles[block as usize * of_block..][..of_block];
            // No closure: on NEON it would stay a function that is called three times.
            let [a, b] = [corner::<V::Register>(block, 0, ray), corner::<V::Register>(block, 3, ray)];
            let crossing = Crossing::of([a, b, corner::<V::Register>(block, 6, ray)]);
            let numbers = column::<V::Register>(block, OF_TRIANGLE - 1);
            let is_own = V::Register::splat(from).equal(V::Register::load(numbers));
            let is_met = crossing.is_met & !is_own;
            if is_met.any() {
                let root = crossing.root();
                best.take_few(numbers, V::Register::select(is_met, root, V::Register::splat(f64::NAN)));
            }
        }
    }
}
