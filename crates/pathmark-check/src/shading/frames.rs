//! Frames around normals: H01, H02.

use super::unguarded::{frisvad_f32, frisvad_frame, smallpt_frame};
use crate::Trials;
use crate::math::{Frame, Vec3, dot};
use crate::sampling::{mix, uniform_sphere, unit};

/// The largest deviation of the tangents from right angles to each other and to the normal, from length 1, and from
/// right-handedness.
fn deviation(frame: &Frame) -> f64 {
    let Frame { s, t, n } = *frame;
    let handed = s.cross(t) - n;
    let lengths = [dot(s, s), dot(t, t)].map(|square| square.sqrt() - 1.0);
    let [a, b] = lengths;
    // The last is the length of an error vector rather than a single error, so half of it counts.
    let all = [dot(s, t), dot(s, n), dot(t, n), a, b, 0.5 * dot(handed, handed).sqrt()];
    // `max` would ignore NaN.
    all.into_iter().map(f64::abs).fold(0.0, |worst, this| if this <= worst { worst } else { this })
}

/// The largest deviation over some normals, in roundings of f64.
fn worst(normals: &[Vec3], frame: impl Fn(Vec3) -> Frame) -> f64 {
    let deviations = normals.iter().map(|n| deviation(&frame(*n)));
    deviations.fold(0.0, |worst, this| if this <= worst { worst } else { this }) / (0.5 * f64::EPSILON)
}

/// Normals at which frame constructions fail.
fn hard_normals() -> Vec<Vec3> {
    let mut normals: Vec<Vec3> = [1.0, -1.0].map(|z| Vec3::new(0.0, 0.0, z)).to_vec();
    for one in [1.0, -1.0] {
        for zero in [0.0, -0.0] {
            normals.extend([Vec3::new(one, zero, zero), Vec3::new(zero, one, zero), Vec3::new(0.0, zero, one)]);
        }
    }
    for k in 0..=1000_u32 {
        let z = -1.0 + f64::from(k) * 0.5 * f64::EPSILON;
        normals.push(Vec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z));
        normals.push(Vec3::new(0.1 * f64::from(k) - 50.0, 13.0, -f64::from(k)).normalized());
        // From 1e-9 to 1 away from the pole, so that some are next to it in single precision, too.
        let off = libm::exp2(f64::from(k) * 0.03 - 30.0);
        normals.push(Vec3::new(0.6 * off, -0.8 * off, -1.0).normalized());
    }
    normals
}

/// Tolerance of the catalogue for each of u.v, u.n, v.n, |u| - 1, |v| - 1: 6 roundings. Frisvad's frame shows that the
/// inputs are hard: it is off by 0.919 in single precision and by 3.9e-4 in double.
pub(super) fn poles(trials: &mut Trials) {
    let normals = hard_normals();
    trials.at_most("Duff et al., roundings", 6.0, worst(&normals, Frame::around));
    // smallpt's cross product has a slightly larger rounding error, and no other.
    trials.at_most("smallpt, roundings", 12.0, worst(&normals, smallpt_frame));
    trials.at_least("Frisvad, without a guard: roundings", 1e9, worst(&normals, frisvad_frame));
    let in_single = normals.iter().map(|n| deviation(&frisvad_f32([n.x as f32, n.y as f32, n.z as f32])));
    trials.at_least("Frisvad in f32", 0.1, in_single.fold(0.0, f64::max));
    let random: Vec<Vec3> = (0..trials.times(100_000, 1_000_000))
        .map(|k| uniform_sphere([unit(mix(2 * k)), unit(mix(2 * k + 1))]).normalized())
        .collect();
    trials.at_most("Duff et al., random normals, roundings", 6.0, worst(&random, Frame::around));
}

/// smallpt changes its axis at |n.x| = 0.1, where the cross product still has length 0.995. Duff's frame changes sides
/// at z = 0, by the sign of z.
pub(super) fn seams(trials: &mut Trials) {
    let (mut at_x, mut at_z) = (Vec::new(), Vec::new());
    for k in -1000..=1000_i32 {
        let step = f64::from(k) * f64::EPSILON;
        for sign in [1.0, -1.0] {
            let x = sign * (0.1 + 0.0625 * step);
            at_x.push(Vec3::new(x, (0.5 - x * x).sqrt(), 0.5_f64.sqrt()).normalized());
            let z = sign * f64::from(k.abs()) * f64::from_bits(1);
            at_z.extend([Vec3::new(0.6, 0.8, z), Vec3::new(-0.8, 0.6, z), Vec3::new(0.0, 1.0, z)]);
            at_z.push(Vec3::new(0.6, -0.8, sign * step).normalized());
        }
    }
    for (seam, normals) in [("|x| = 0.1", at_x), ("z = 0", at_z)] {
        trials.at_most(format!("Duff et al. at {seam}, roundings"), 6.0, worst(&normals, Frame::around));
        trials.at_most(format!("smallpt at {seam}, roundings"), 12.0, worst(&normals, smallpt_frame));
    }
}
