//! Generators and keys from similar programs, each with its defect. They serve for timing and to show that the cases
//! detect the defects. No renderer uses them.

use crate::sampling::{mix, unit};
use rand::Rng;
use rand_pcg::Pcg32;

/// smallpt's state at the start of row `y`: `Xi = {0, 0, y*y*y}` in 16-bit words, the last of which is the highest.
/// The cube wraps, so some rows share a state. The low 32 bits are the same in all rows for ever.
pub(crate) fn smallpt_row(y: u32) -> u64 {
    u64::from(y.wrapping_mul(y).wrapping_mul(y) as u16) << 32
}

/// The next number of `erand48`, which smallpt draws from.
pub(crate) fn erand48(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(0x5_DEEC_E66D).wrapping_add(0xB) & 0xFFFF_FFFF_FFFF;
    *state as f64 / (1_u64 << 48) as f64
}

/// The first number of a 32-bit linear congruential generator ("Numerical Recipes") with the pixel as seed. Neighbours
/// differ by a constant.
pub(crate) fn lcg_of_pixel(pixel: u32) -> f64 {
    f64::from(pixel.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)) / 4_294_967_296.0
}

pub(crate) fn sequential_state(pixel: u32) -> Pcg32 {
    Pcg32::new(u64::from(pixel), 0)
}

pub(crate) fn sequential_stream(pixel: u32) -> Pcg32 {
    Pcg32::new(42, u64::from(pixel))
}

/// The next number of a PCG32, with 32 bits.
pub(crate) fn draw(pcg: &mut Pcg32) -> f64 {
    f64::from(pcg.next_u32()) / 4_294_967_296.0
}

/// A number whose key is the sum of seed and pixel. The next seed gives the same noise, shifted by one pixel.
pub(crate) fn seed_plus_pixel(seed: u64, pixel: u32) -> f64 {
    unit(mix(seed.wrapping_add(u64::from(pixel))))
}

/// A 32-bit key of a pixel: some pixels of an image share one.
pub(crate) fn key_of_32_bits(pixel: u32) -> u32 {
    mix(u64::from(pixel)) as u32
}

/// Thomas Wang's 32-bit hash: maps 61 to 0.
pub(crate) fn wang_hash(x: u32) -> u32 {
    let x = (x ^ 0x3D ^ (x >> 16)).wrapping_mul(9);
    let x = (x ^ (x >> 4)).wrapping_mul(0x27D4_EB2D);
    x ^ (x >> 15)
}

/// Marsaglia's 32-bit generator: a zero state stays zero for ever.
pub(crate) fn xorshift32(state: &mut u32) -> u32 {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    *state
}

/// The finaliser of `MurmurHash3`, a bijection that maps zero to zero.
pub(crate) fn fmix64(x: u64) -> u64 {
    let x = (x ^ (x >> 33)).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
    let x = (x ^ (x >> 33)).wrapping_mul(0xC4CE_B9FE_1A85_EC53);
    x ^ (x >> 33)
}

/// 32 bits times 2^-32 in single precision: the largest 128 give 1.
pub(crate) fn unit_in_f32(bits: u32) -> f32 {
    bits as f32 * (1.0 / 4_294_967_296.0)
}

/// 64 bits times 2^-64 without truncation to 53 bits: the largest 1024 give 1.
pub(crate) fn unit_of_all_bits(bits: u64) -> f64 {
    bits as f64 * (1.0 / 1.844_674_407_370_955_2e19)
}
