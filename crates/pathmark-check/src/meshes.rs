//! Closed meshes.

use crate::math::{Vec3, dot};
use crate::scene::Triangle;

/// A closed mesh around the origin, `rows` by `columns`. Each vertex lies at distance `radius()` from the origin,
/// called once per vertex. Triangles that share a corner have bitwise equal coordinates for it.
pub(super) fn star(rows: usize, columns: usize, mut radius: impl FnMut() -> f64) -> Vec<Triangle> {
    let south = Vec3::new(0.0, 0.0, -radius());
    let north = Vec3::new(0.0, 0.0, radius());
    let rings: Vec<Vec<Vec3>> = (1..rows)
        .map(|row| {
            let polar = std::f64::consts::PI * row as f64 / rows as f64;
            let around = |column: usize| std::f64::consts::TAU * column as f64 / columns as f64;
            let (z, ring) = (-libm::cos(polar), libm::sin(polar));
            let at = |column| Vec3::new(ring * libm::cos(around(column)), ring * libm::sin(around(column)), z);
            (0..columns).map(|column| at(column) * radius()).collect()
        })
        .collect();
    let mut triangles = Vec::new();
    for column in 0..columns {
        let next = (column + 1) % columns;
        let (first, last) = (&rings[0], &rings[rows - 2]);
        triangles.push(Triangle { corners: [south, first[next], first[column]] });
        triangles.push(Triangle { corners: [north, last[column], last[next]] });
        for pair in rings.windows(2) {
            let [a, b, c, d] = [pair[0][column], pair[0][next], pair[1][next], pair[1][column]];
            triangles.push(Triangle { corners: [a, b, c] });
            triangles.push(Triangle { corners: [a, c, d] });
        }
    }
    triangles
}

/// The surface of the cube from 0 to `n`. Each face has n x n squares with integer corners.
pub(super) fn grid_cube(n: i32) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0, n] {
            for (u, v) in (0..n).flat_map(|u| (0..n).map(move |v| (u, v))) {
                let corner = |du: i32, dv: i32| {
                    let mut at = [f64::from(side); 3];
                    at[(axis + 1) % 3] = f64::from(u + du);
                    at[(axis + 2) % 3] = f64::from(v + dv);
                    Vec3::from(at)
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                triangles.push(Triangle { corners: [a, b, c] });
                triangles.push(Triangle { corners: [a, c, d] });
            }
        }
    }
    triangles
}

/// An icosahedron on the unit sphere, each triangle divided into four `cuts` times.
pub(super) fn icosphere(cuts: u32) -> Vec<Triangle> {
    let golden = 0.5 + 1.25_f64.sqrt();
    // Corners by axis and signs: 0, +-1 and +-golden in cyclic order.
    let corner = |axis: usize, one: f64, other: f64| {
        let mut at = [0.0; 3];
        at[(axis + 1) % 3] = one;
        at[(axis + 2) % 3] = other * golden;
        Vec3::from(at).normalized()
    };
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corners: Vec<Vec3> = (0..3).flat_map(|axis| signs.map(|(one, other)| corner(axis, one, other))).collect();
    // Neighbours are 2 / sqrt(1 + golden²) apart, 1.05; the next nearest corners 1.7.
    let are_near = |a: Vec3, b: Vec3| dot(a - b, a - b) < 1.5;
    let mut triangles = Vec::new();
    for (k, a) in corners.iter().enumerate() {
        for (l, b) in corners.iter().enumerate().skip(k + 1).filter(|(_, b)| are_near(*a, **b)) {
            for c in corners.iter().skip(l + 1).filter(|c| are_near(*a, **c) && are_near(*b, **c)) {
                let outside = dot((*b - *a).cross(*c - *a), *a) > 0.0;
                triangles.push(Triangle { corners: if outside { [*a, *b, *c] } else { [*a, *c, *b] } });
            }
        }
    }
    for _ in 0..cuts {
        let middle = |a: Vec3, b: Vec3| (a + b).normalized();
        let cut = |Triangle { corners: [a, b, c] }: &Triangle| {
            let [ab, bc, ca] = [middle(*a, *b), middle(*b, *c), middle(*c, *a)];
            [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]].map(|corners| Triangle { corners })
        };
        triangles = triangles.iter().flat_map(cut).collect();
    }
    triangles
}
