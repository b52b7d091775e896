//! Cases about triangles, boxes and hierarchies.

mod areas;
mod arrangements;
mod contact;
mod edges;
mod hierarchies;
mod plane_distance;
#[cfg(test)]
mod plane_distance_tests;
mod planes;
mod seams;
pub(super) mod single;
mod slabs;
mod slivers;

use super::{Section, case};

pub(super) const SECTION: Section = Section {
    title: "Triangles, boxes and hierarchies",
    cases: &[
        case("T01", "the diagonal of a quad, which both halves own: the first is hit", edges::diagonal),
        case("T02", "edges and corners of closed meshes, from inside: no ray passes between", edges::closed_meshes),
        case("T03", "integer corners, rays along axes: all edge functions are exactly 0", edges::integer_corners),
        case("T04", "three corners on a line, from pbrt's bad cases", areas::bad_case),
        case("T05", "no area, the smallest and largest areas, corners that are no numbers", areas::areas),
        case("T06", "rays in the plane of a triangle, both windings", areas::edge_on),
        case("T08", "both sides, and mirror images: the outside is where corners run counterclockwise", areas::sides),
        case("T07", "triangles of 1e-6 a million away: distances within 7 roundings", plane_distance::seven_roundings),
        case("T10", "all 35 000 rays along axes and diagonals, with both zeros, at flat boxes too", slabs::exhaustive),
        case("T11", "a flat box of subnormal size", slabs::subnormal),
        case("T12", "rays along a face, exactly on it and just outside", slabs::along_a_face),
        case("T13", "rays through hierarchies of spheres, meshes, flat and nested things", hierarchies::every_kind),
        case("T14", "one, two, 2^16 + 1, identical, collinear, huge among tiny, NaN", arrangements::hard_to_build),
        case("T15", "built by many threads and in another order: the same tree and hits", arrangements::one_tree),
        case("T16", "planes met at cosines down to 1e-90, from both sides", planes::flat_angles),
        case("T17", "rays in the plane and from it; normals that are zero or of any length", planes::in_the_plane),
        case("T18", "light and shadow 0.1 from where a ball touches the floor: none is lost", contact::contact),
        case("T19", "rays that leave a seam of two triangles do not meet the neighbour", seams::rays_from_seams),
        case("T20", "matte surfaces, seen at a seam, in f64 and f32: two rays a path", seams::two_rays_a_path),
        case("T21", "a slab of glass, seen through both diagonals, in f64 and f32", seams::slab_through_diagonals),
        case("T22", "slivers and far triangles: the same hits in every search", slivers::same_hits),
        case("T23", "images of slivers: one checksum for all accelerators and kernels", slivers::same_images),
    ],
};
