//! The watertight triangle test: neighbours agree about a ray through their shared edge.

use super::{Guard, InRender, Measured, Often, variant};
use crate::math::{Ray, Vec3};
use crate::meshes::icosphere;
use crate::random::Random;
use crate::scene::{Primitive, Triangle};
use crate::triangle::single::moller_trumbore;

pub(super) const GUARD: Guard = Guard {
    name: "watertight triangles",
    error: "share of rays at shared edges that pass between the triangles of a closed mesh",
    operation: "a ray against 80 triangles",
    in_render: InRender { scene: "cornell-mesh", often: Often::Test(1.0 / 80.0) },
    with: variant!("Woop, Benthin and Wald", error, work, watertight),
    without: variant!("Möller and Trumbore", error, work, plain),
};

fn mesh() -> Vec<Triangle> {
    icosphere(1)
}

/// The nearest hit ahead; infinite if there is none.
fn watertight(mesh: &[Triangle], ray: &Ray) -> f64 {
    let prepared = Triangle::prepare(ray);
    let ahead = mesh.iter().map(|triangle| triangle.meet(ray, &prepared)).filter(|t| *t > 0.0);
    ahead.fold(f64::INFINITY, f64::min)
}

fn plain(mesh: &[Triangle], ray: &Ray) -> f64 {
    let ahead = mesh.iter().map(|triangle| moller_trumbore(triangle.corners, ray)).filter(|t| *t > 0.0);
    ahead.fold(f64::INFINITY, f64::min)
}

/// A ray from near the centre towards a point of an edge.
fn at_an_edge(mesh: &[Triangle], random: &mut Random) -> Ray {
    let [a, b, _] = mesh[random.below(mesh.len())].corners;
    let origin: Vec3 = random.direction() * (0.45 * random.unit());
    Ray { origin, direction: (a + (b - a) * random.unit() - origin).normalized() }
}

fn error(nearest: fn(&[Triangle], &Ray) -> f64) -> Measured {
    let (mesh, mut random, rays) = (mesh(), Random::new(85), 20_000);
    let missed = (0..rays).filter(|_| nearest(&mesh, &at_an_edge(&mesh, &mut random)).is_infinite()).count();
    Measured::share(missed as u64, rays)
}

fn work(count: u64, nearest: fn(&[Triangle], &Ray) -> f64) -> f64 {
    let (mesh, mut random) = (mesh(), Random::new(86));
    let rays: [Ray; 64] = std::array::from_fn(|_| at_an_edge(&mesh, &mut random));
    let mut sum = 0.0;
    for k in 0..count as usize {
        let t = nearest(&mesh, &rays[k % 64]);
        sum += if t.is_finite() { t } else { 1.0 };
    }
    sum
}
