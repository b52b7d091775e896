//! Cases about frames, Fresnel, microfacets and lights.

mod agreement;
pub(crate) mod balance;
mod cones;
mod degenerate;
mod directions;
mod facets;
mod frames;
pub(super) mod fresnel;
mod glass;
mod lights;
mod report_b;
mod shares;
mod smooth;
pub(crate) mod unguarded;
mod warps;

use super::{Section, case};

pub(super) const SECTION: Section = Section {
    title: "Frames, Fresnel, microfacets, lights",
    cases: &[
        case("H01", "frames around the poles, the axes with signed zeros and 1000 neighbours of -z", frames::poles),
        case("H02", "frames next to where a construction changes sides", frames::seams),
        case("H03", "the cosine warp at 0, 2^-53, 1/2, 1 - 2^-53 and 1", warps::cosine),
        case("H04", "the tent filter at its ends and its seam", warps::tents),
        case("H05", "sphere, cone, disk, cosine, tent and triangle: the square's corners, and chi-square", warps::all),
        case("H10", "reflectance at every hundredth of a cosine and next to the critical angle", fresnel::values),
        case("H11", "indices that are equal, nearly equal, large, or no indices", fresnel::indices),
        case("H12", "cosines along the surface and beyond 1, and there and back", fresnel::cosines),
        case("H13", "weights of lobes that are chosen by chance, for every angle", glass::weights),
        case("H14", "a furnace seen from inside the glass", glass::inside_the_glass),
        case("H20", "the weak white furnace: G1 D/(4 cos) over the sphere, every roughness", facets::weak_furnace),
        case("H21", "weights of visible normals, along the surface and at extreme numbers", facets::weights),
        case("H22", "the density of normals against double-double arithmetic", facets::densities),
        case("H23", "roughness 0 against 1e-4, the smallest that is rough", smooth::roughness_zero),
        case("H29", "mirrors down to grazing angles: F alone and no cosine", smooth::grazing),
        case("H24", "the second report's guards, put back: the furnace must reject them", report_b::guards),
        case("H28", "the second report's body under facets never makes light", report_b::no_light_is_made),
        case("H25", "directions longer than 1 by a rounding, along the surface and below it", degenerate::beyond),
        case("H27", "opposite directions and grazing ones: half vectors of length 0", degenerate::opposite),
        case("H26", "reciprocity of pairs of directions, and albedos against a table", balance::balance),
        case("H30", "cones of spheres from next to them to 1e12 radii away", cones::digits),
        case("H31", "aiming from inside a light", cones::inside),
        case("H32", "aiming from one rounding outside of a light", cones::touching),
        case("H33", "densities where there is light: above 0, finite, and delta by type", shares::densities),
        case("H34", "shares of two ways of finding light: they sum to 1", shares::shares),
        case("H35", "estimators with a light of area 1e-6 and with one that fills the hemisphere", agreement::lights),
        case("H36", "an emitter seen directly, in a mirror and through glass: counted once", agreement::counted_once),
        case("H37", "lights below the horizon, edge on, enclosed, dark, and 100 000 of them", lights::hardly_there),
        case("G7", "directions of every material: chi-square, and the density's integral", directions::every_sampler),
    ],
};
