//! Cases about ray-sphere intersection and the starts of rays.

pub(super) mod bulk;
mod chains;
pub(super) mod exact;
#[cfg(test)]
mod exact_tests;
pub(super) mod formulas;
mod known_rays;
mod leaks;
mod refused;
mod scale;
mod short_ways;
mod smallpt_box;
mod starts;
mod tangents;

use super::{Section, U, case};
use known_rays::known;
use refused::radii;
use tangents::{BESIDE, FORWARD, same};

pub(super) const SECTION: Section = Section {
    title: "Ray against sphere, and where rays start",
    cases: &[
        case("S01", "the left wall of smallpt's box from its middle: |f|² - r² loses 10 digits", |trials| {
            known(trials, "wall-left-centre", None);
        }),
        case("S02", "the floor of smallpt's box at a grazing angle of 1e-3", |trials| {
            known(trials, "wall-floor-grazing 1e-3", None);
        }),
        case("S03", "the floor of smallpt's box at a grazing angle of 1e-2", |trials| {
            known(trials, "wall-floor-grazing 1e-2", None);
        }),
        case("S04", "the back wall of smallpt's box from its camera", |trials| {
            known(trials, "wall-back-from-camera", None);
        }),
        case("S05", "a unit sphere 1e3 away", |trials| known(trials, "haines fig: unit sphere at 1000", None)),
        case("S06", "a unit sphere 1e5 away", |trials| known(trials, "unit sphere at 1e5", None)),
        case("S07", "a unit sphere 1e8 away: b² - |f|² + r² loses r²", |trials| {
            known(trials, "unit sphere at 1e8", Some(0.13));
        }),
        case("S08", "a sphere of 1e-6 at 1", |trials| known(trials, "r=1e-6 at 1", Some(1e-11))),
        case("S09", "a sphere of 1e-6 at 100", |trials| known(trials, "r=1e-6 at 100", Some(1e-7))),
        case("S10", "from within a sphere of 1e8, 1 from its surface", |trials| {
            known(trials, "r=1e8 from inside near surf", None);
        }),
        case("S19", "a direction of length 3, where smallpt takes |d|² for 1", |trials| {
            known(trials, "non-unit d x3", Some(0.5));
        }),
        case("S20", "a direction of length 1e-20", |trials| known(trials, "non-unit d 1e-20", None)),
        case("S11", "a tangent: the sphere is closed", |trials| same(trials, [-2.0, 1.0, 0.0], FORWARD, Some(2.0))),
        case("S12", "one ulp outside of the tangent, which smallpt hits", tangents::beside_the_tangent),
        case("S13", "one ulp inside of the tangent: the roots do not merge", |trials| {
            same(trials, [-2.0, 1.0 - U, 0.0], FORWARD, Some(1.999_999_985_098_838_8));
        }),
        case("S14", "from the surface outwards", |trials| same(trials, [1.0, 0.0, 0.0], FORWARD, None)),
        case("S15", "from the surface inwards", |trials| same(trials, [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], Some(2.0))),
        case("S16", "from the surface along it", |trials| same(trials, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], None)),
        case("S17", "from the centre, in directions along axes and any", tangents::from_the_centre),
        case("S18", "a sphere behind", |trials| same(trials, [2.0, 0.0, 0.0], FORWARD, None)),
        case("S21", "a direction of length 1e-200: no hit", |trials| same(trials, BESIDE, [1e-200, 0.0, 0.0], None)),
        case("S22", "a direction of length 1e200: no hit; smallpt hits at infinity", tangents::too_long),
        case("S23", "directions and origins that are zero, NaN or infinite", tangents::no_numbers),
        case("S28", "a sphere 1e21 away, beyond the reports' infinity of 1e20", tangents::beyond_the_sentinel),
        case("S31", "from within, where one root is behind", |trials| {
            same(trials, [0.5, 0.0, 0.0], FORWARD, Some(0.5));
        }),
        case("S24", "radius 0, whose normal is 0/0", |trials| radii(trials, &["0.0", "-0.0"])),
        case("S25", "a negative radius, which its square hides", |trials| radii(trials, &["-1.0"])),
        case("S26", "radii whose square is 0 or no number; the smallest that is read", refused::small_radii),
        case("S27", "radii and coordinates whose squares overflow; the largest that are read", refused::large),
        case("S29", "rays at spheres of 1e-6 to 1e8, 1e-3 to 1e8 radii away", bulk::any_rays),
        case("S30", "rays one ulp apart across the silhouette: after the first miss no hit", bulk::silhouette),
        case("S40", "glass balls smaller than an epsilon: the same walk as in a big one", short_ways::tiny_glass),
        case("S43", "chords inside glass, however flat and short", short_ways::chords_in_glass),
        case("S44", "chords of smallpt's walls that are shorter than its epsilon", short_ways::chords_of_walls),
        case("S41", "scenes times 2^k, k from -40 to 40: not a bit of the image changes", scale::powers_of_two),
        case("S42", "smallpt's closed box: no ray meets nothing, none passes behind an edge", leaks::closed_box),
        case("S45", "rays at lights of radius 600 and 0.005: none is stopped by the light itself", leaks::lights),
        case("S46", "rays that leave spheres of 1e-6 to 1e8 and convex meshes meet nothing of them", starts::leaving),
        case("S47", "points at which an offset of the origin would change sign or size", starts::awkward_points),
        case("S48", "near and identical spheres: the nearest, then the lowest number", starts::nearest_then_lowest),
        case("S60", "the light's sphere ends where it cuts the ceiling's", smallpt_box::light_cap),
        case("S61", "the balls sink into the curved floor: glass ends there, not in air", smallpt_box::sunken_balls),
        case("S62", "camera rays start inside the box, at the rims of the filter too", smallpt_box::camera_rays),
        case("S64", "1e4 mirror bounces in a sphere of 1e5: the direction keeps its length", chains::mirror_chain),
    ],
};
