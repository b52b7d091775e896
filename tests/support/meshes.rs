//! Closed meshes.

use pathmark::math::Vec3;
use pathmark::scene::Triangle;

/// A closed mesh around the origin, `rows` by `columns` on a sphere whose radius at each vertex is `radius` (drawn once for each). The
/// corners of neighbours are the same bits.
pub(crate) fn star(rows: usize, columns: usize, mut radius: impl FnMut() -> f64) -> Vec<Triangle> {
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

/// The surface of the cube from 0 to `n`, each face of n x n squares with corners on the integers.
pub(crate) fn grid_cube(n: i32) -> Vec<Triangle> {
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
