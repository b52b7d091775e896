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
        case(
            "T07",
            "triangles of 1e-6 a million away up to 1e9: distances within 7 roundings, and more for slivers",
            plane_distance::seven_roundings,
        ),
        case("T10", "all 35 000 rays along axes and diagonals, with both zeros, at flat boxes too", slabs::exhaustive),
        case("T11", "a flat box of subnormal size", slabs::subnormal),
        case("T12", "rays along a face, exactly on it and just outside", slabs::along_a_face),
        case(
            "T13",
            "rays through hierarchies of spheres, meshes, flat, nested, repeated and gridded things, from their surfaces too",
            hierarchies::every_kind,
        ),
        case(
            "T14",
            "one, two, 2^16 + 1, identical, concentric, collinear, huge among tiny, NaN",
            arrangements::hard_to_build,
        ),
        case(
            "T15",
            "built by many threads at once and in another order: the same tree, the same hits",
            arrangements::one_tree,
        ),
        case("T16", "planes met at cosines down to 1e-90, from both sides", planes::flat_angles),
        case("T17", "rays in the plane and from it; normals that are zero or of any length", planes::in_the_plane),
        case(
            "T18",
            "light and shadow of a ball 0.1 from where it touches the floor; a guard of t > 0.5 would lose them",
            contact::contact,
        ),
        case(
            "T19",
            "rays that leave a diagonal, a seam of a flat mesh or wall, the middle of a fan, an edge of a round mesh: none meets the neighbour",
            seams::rays_from_seams,
        ),
        case(
            "T20",
            "matte quads, flat meshes, fans and round meshes under a sky, seen at a seam, in f64 and f32: two rays a path",
            seams::two_rays_a_path,
        ),
        case(
            "T21",
            "a slab of glass of quads, seen through both diagonals, in f64 and f32",
            seams::slab_through_diagonals,
        ),
        case(
            "T22",
            "slivers of relative heights down to nothing, and triangles of size 1 as far as 1e15: the same hits in every search",
            slivers::same_hits,
        ),
        case(
            "T23",
            "images of slivers that glow and that do not: one checksum for every accelerator and kernel",
            slivers::same_images,
        ),
    ],
};
