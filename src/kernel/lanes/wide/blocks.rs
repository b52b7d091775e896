//! Primitives of a kind side by side, as many as there are lanes.

use super::{Best, Single};
use crate::kernel::lanes::singles::Singles;
use crate::math::{Vec3, first_root, line_meets, sheared, triangle_root};
use crate::scene::Primitives;
use crate::simd::{Float, Mask, Number, Numbers, Precision};

/// Numbers of a sphere: its centre, its radius and its number.
const OF_SPHERE: usize = 5;
/// Numbers of a triangle: its three corners and its number.
const OF_TRIANGLE: usize = 10;
/// The number of a place without a primitive; others are not below -1.
const NO_NUMBER: f64 = -2.0;

/// Blocks: of each the first number of all its primitives, then the second, and so on.
pub(super) struct Blocks {
    spheres: Numbers,
    triangles: Numbers,
    pub(super) has_triangles: bool,
}

/// Some of the blocks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    /// From the first block of spheres to before the last, likewise of triangles.
    spheres: [u32; 2],
    triangles: [u32; 2],
    /// The primitives that are in them.
    pub(super) primitives: u32,
}

/// Blocks that are being made.
pub(super) struct Making<'a> {
    primitives: &'a Primitives,
    /// Spheres that are tested elsewhere.
    large: Option<&'a Singles>,
    width: usize,
    spheres: Vec<f64>,
    triangles: Vec<f64>,
}

impl<'a> Making<'a> {
    pub(super) fn new(primitives: &'a Primitives, large: Option<&'a Singles>, width: usize) -> Self {
        Self { primitives, large, width, spheres: Vec::new(), triangles: Vec::new() }
    }

    /// Puts the primitives with these numbers into blocks of their own, but for planes and for what is tested elsewhere.
    pub(super) fn add(&mut self, numbers: impl IntoIterator<Item = u32>) -> Leaf {
        let first_flat = self.primitives.spheres.len();
        let first_triangle = first_flat + self.primitives.planes.len();
        let (mut spheres, mut triangles) = (Vec::new(), Vec::new());
        for number in numbers {
            let index = number as usize;
            if let Some(sphere) = self.primitives.spheres.get(index) {
                if !self.large.is_some_and(|large| large.contains(number)) {
                    let Vec3 { x, y, z } = sphere.center;
                    spheres.push([x, y, z, sphere.radius, number.into()]);
                }
            } else if let Some(index) = index.checked_sub(first_triangle) {
                let [a, b, c] = self.primitives.triangles[index].corners;
                triangles.push([a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, number.into()]);
            }
        }
        Leaf {
            primitives: (spheres.len() + triangles.len()) as u32,
            spheres: append(&mut self.spheres, &spheres, self.width),
            triangles: append(&mut self.triangles, &triangles, self.width),
        }
    }

    pub(super) fn made(self, precision: Precision) -> Blocks {
        let has_triangles = !self.triangles.is_empty();
        Blocks {
            has_triangles,
            spheres: Numbers::new(self.spheres, precision),
            triangles: Numbers::new(self.triangles, precision),
        }
    }
}

/// Appends primitives in blocks, the last of which is filled up with what no ray meets. The first block, and the one behind the last.
fn append<const N: usize>(blocks: &mut Vec<f64>, primitives: &[[f64; N]], width: usize) -> [u32; 2] {
    let count = |blocks: &[f64]| (blocks.len() / (N * width)) as u32;
    let first = count(blocks);
    for block in primitives.chunks(width) {
        for k in 0..N {
            let nothing = if k == N - 1 { NO_NUMBER } else { f64::NAN };
            blocks.extend((0..width).map(|lane| block.get(lane).map_or(nothing, |primitive| primitive[k])));
        }
    }
    [first, count(blocks)]
}

/// The numbers of a block that its primitives have in one place.
#[inline(always)]
fn column<V: Float>(blocks: &[V::One], block: u32, of: usize, place: usize) -> V {
    V::load(&blocks[(block as usize * of + place) * V::LANES..])
}

/// The numbers of the primitives of a block.
#[inline(always)]
fn numbers<V: Float>(blocks: &[V::One], block: u32, of: usize) -> &[V::One] {
    &blocks[(block as usize * of + of - 1) * V::LANES..]
}

/// Corners as the ray sees them, the first of whose coordinates is in that place.
#[inline(always)]
fn corner<V: Float>(triangles: &[V::One], block: u32, first: usize, ray: &Single<V>) -> [V; 3] {
    let [x, y, z] = ray.shear.axes;
    let [ox, oy, oz] = ray.turned;
    let x = column::<V>(triangles, block, OF_TRIANGLE, first + x) - ox;
    let y = column::<V>(triangles, block, OF_TRIANGLE, first + y) - oy;
    let z = column::<V>(triangles, block, OF_TRIANGLE, first + z) - oz;
    sheared([x, y, z], ray.shear.by)
}

impl Blocks {
    /// Tests a ray against all primitives of a leaf.
    #[inline(always)]
    pub(super) fn test<V: Float>(&self, leaf: &Leaf, ray: &Single<V>, best: &mut Best) {
        let spheres = V::One::all(&self.spheres);
        for block in leaf.spheres[0]..leaf.spheres[1] {
            let x = column(spheres, block, OF_SPHERE, 0);
            let y = column(spheres, block, OF_SPHERE, 1);
            let z = column(spheres, block, OF_SPHERE, 2);
            let radius = column(spheres, block, OF_SPHERE, 3);
            let (offset, direction) = (ray.ray.origin - Vec3 { x, y, z }, ray.ray.direction);
            let numbers = numbers::<V>(spheres, block, OF_SPHERE);
            let is_own = ray.from.equal(V::load(numbers));
            // Square roots and divisions take longer than everything else, and many rays pass all spheres of a block.
            if (is_own | line_meets(offset, direction, V::splat(1.0), radius)).any() {
                let root = first_root(offset, direction, V::splat(1.0), radius);
                best.take(numbers, V::select(is_own, ray.own_root, root));
            }
        }
        let triangles = V::One::all(&self.triangles);
        for block in leaf.triangles[0]..leaf.triangles[1] {
            let a = corner(triangles, block, 0, ray);
            let b = corner(triangles, block, 3, ray);
            let c = corner(triangles, block, 6, ray);
            let numbers = numbers::<V>(triangles, block, OF_TRIANGLE);
            let is_own = ray.from.equal(V::load(numbers));
            best.take(numbers, V::select(is_own, V::splat(f64::NAN), triangle_root(a, b, c)));
        }
    }
}
