//! Self-test of a device: whether it computes as IEEE 754 demands. A table of operations on chosen and on random
//! operands is compared with the host processor's bits.

use super::{Device, DeviceError, Result};
use std::collections::HashSet;
use std::ops::Mul;
use std::sync::{LazyLock, Mutex, PoisonError};

/// An operation, with a function that computes its result for two numbers and a word.
struct Operation {
    name: &'static str,
    kind: Kind,
    of: fn(f64, f64, u64) -> u64,
}

/// The type of an operation's operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Double,
    Integer,
    /// Single precision: the operands are rounded to it, and the result is converted to double.
    Single,
}

/// The bits of a result in single precision, converted to double.
fn single(result: f32) -> u64 {
    f64::from(result).to_bits()
}

/// The operations in the order in which `self_test.cl` numbers them.
const OPERATIONS: &[Operation] = &[
    Operation { name: "a + b", kind: Kind::Double, of: |a, b, _| (a + b).to_bits() },
    Operation { name: "a - b", kind: Kind::Double, of: |a, b, _| (a - b).to_bits() },
    Operation { name: "a * b", kind: Kind::Double, of: |a, b, _| (a * b).to_bits() },
    Operation { name: "a / b", kind: Kind::Double, of: |a, b, _| (a / b).to_bits() },
    Operation { name: "sqrt(a)", kind: Kind::Double, of: |a, _, _| a.sqrt().to_bits() },
    Operation { name: "a * b + a, rounded twice", kind: Kind::Double, of: |a, b, _| (a * b + a).to_bits() },
    Operation {
        name: "a * b - b * a, rounded three times",
        kind: Kind::Double,
        of: |a, b, _| (Mul::mul(a, b) - b * a).to_bits(),
    },
    Operation { name: "a with the sign of b", kind: Kind::Double, of: |a, b, _| a.copysign(b).to_bits() },
    Operation { name: "|a| < b", kind: Kind::Double, of: |a, b, _| if a.abs() < b { a } else { b }.to_bits() },
    Operation { name: "an integer as a number", kind: Kind::Double, of: |_, _, bits| ((bits >> 11) as f64).to_bits() },
    Operation {
        name: "200 times x * b + a",
        kind: Kind::Double,
        of: |a, b, _| (0..200).fold(a, |x, _| x * b + a).to_bits(),
    },
    Operation {
        name: "an integer product",
        kind: Kind::Integer,
        of: |_, _, bits| bits.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(bits >> 31),
    },
    Operation {
        name: "ones and shifts of an integer",
        kind: Kind::Integer,
        of: |_, _, bits| u64::from((bits as u32).count_ones()) | ((bits << 13) ^ (bits >> 51)) << 6,
    },
    Operation { name: "a + b in single precision", kind: Kind::Single, of: |a, b, _| single(a as f32 + b as f32) },
    Operation { name: "a * b in single precision", kind: Kind::Single, of: |a, b, _| single(a as f32 * b as f32) },
    Operation { name: "a / b in single precision", kind: Kind::Single, of: |a, b, _| single(a as f32 / b as f32) },
    Operation { name: "sqrt(a) in single precision", kind: Kind::Single, of: |a, _, _| single((a as f32).sqrt()) },
    Operation {
        name: "a * b + a in single precision, rounded twice",
        kind: Kind::Single,
        of: |a, b, _| single(a as f32 * b as f32 + a as f32),
    },
    // The product of two numbers of 24 digits has 48, so double precision holds it exactly.
    Operation {
        name: "what rounding a * b in single precision loses, by a fused operation",
        kind: Kind::Single,
        of: |a, b, _| {
            let (a, b) = (a as f32, b as f32);
            single((f64::from(a) * f64::from(b) - f64::from(a * b)) as f32)
        },
    },
];

/// Operands whose results are rounded or out of range: halfway cases, ends of the range, subnormal numbers, zeros,
/// infinities.
const EDGES: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0 / 3.0,
    1.0 + f64::EPSILON,
    1.0 - f64::EPSILON / 2.0,
    f64::MIN_POSITIVE,
    -5e-324,
    3e-310,
    f64::MAX,
    1e154,
    -1e-160,
    f64::INFINITY,
    9_007_199_254_740_993.0,
    1e-40,
    -3e-23,
];

/// Number of random operand pairs besides the edges.
const RANDOM: usize = 4096;

/// The next word of Marsaglia's xorshift (2003).
fn next(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}

/// Pairs of operands, and a word for each.
fn operands() -> (Vec<f64>, Vec<u64>) {
    let edges = EDGES.into_iter().flat_map(|a| EDGES.into_iter().flat_map(move |b| [a, b]));
    let mut numbers: Vec<f64> = edges.collect();
    let mut state = 0x2545_F491_4F6C_DD1D;
    // From 1/16 to 16, of either sign.
    let mut random = || {
        let bits = next(&mut state);
        let exponent = 1019 + (bits >> 52) % 8;
        f64::from_bits(bits & 0x800F_FFFF_FFFF_FFFF | exponent << 52)
    };
    numbers.extend((0..2 * RANDOM).map(|_| random()));
    let words = (0..numbers.len() / 2).map(|_| next(&mut state)).collect();
    (numbers, words)
}

/// Whether two results have the same bits or are both NaN.
fn is_same(found: u64, expected: u64, kind: Kind) -> bool {
    let is_nan = |bits: u64| f64::from_bits(bits).is_nan();
    found == expected || kind != Kind::Integer && is_nan(found) && is_nan(expected)
}

/// Runs the single-precision part of the table, or the rest, on a device, even if it passed before.
fn check(device: &dyn Device, in_single: bool) -> Result<()> {
    let (numbers, words) = operands();
    let halves: Vec<u32> = words.iter().flat_map(|word| [*word as u32, (*word >> 32) as u32]).collect();
    let loaded = device.bind(include_str!("self_test.cl"), &numbers, &halves)?;
    let mut out = vec![0; words.len()];
    let table = (0_u32..).zip(OPERATIONS);
    for (number, operation) in table.filter(|(_, operation)| (operation.kind == Kind::Single) == in_single) {
        loaded.run(&[number], words.len() as u32, &mut out)?;
        for ((pair, word), found) in numbers.chunks_exact(2).zip(&words).zip(&out) {
            let (a, b) = (pair[0], pair[1]);
            let expected = (operation.of)(a, b, *word);
            if !is_same(*found, expected, operation.kind) {
                let operation = format!(
                    "{} of {a:e}, {b:e} and {word:#018x} is {found:#018x} instead of {expected:#018x}",
                    operation.name
                );
                return Err(DeviceError::Inexact { operation });
            }
        }
    }
    Ok(())
}

/// Returns an error for a device that computes differently. Each device is tested once, and once in single precision if
/// that is used.
pub(crate) fn passed(device: &dyn Device, uses_single: bool) -> Result<()> {
    static PASSED: LazyLock<Mutex<HashSet<(String, bool)>>> = LazyLock::new(Mutex::default);
    let mut passed = PASSED.lock().unwrap_or_else(PoisonError::into_inner);
    for in_single in [false, true].into_iter().filter(|in_single| uses_single || !in_single) {
        let key = (device.id().to_string(), in_single);
        if !passed.contains(&key) {
            check(device, in_single)?;
            passed.insert(key);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Costs, Loaded, open};

    /// A device that changes one result of one operation.
    struct Wrong(u32);

    impl Device for Wrong {
        fn id(&self) -> &'static str {
            "wrong:0"
        }
        fn about(&self) -> &'static str {
            "a device that rounds otherwise"
        }
        fn width(&self) -> u32 {
            1
        }
        fn bind(&self, text: &str, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>> {
            Ok(Box::new(Wrongly(self.0, open("host")?.bind(text, numbers, words)?)))
        }
    }

    struct Wrongly(u32, Box<dyn Loaded>);

    impl Loaded for Wrongly {
        fn costs(&self) -> Costs {
            self.1.costs()
        }
        fn run(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<()> {
            self.1.run(task, items, out)?;
            if task[0] == self.0 {
                out[300] ^= 1;
            }
            Ok(())
        }
    }

    /// Tests every available device; the host is always there, others if a driver is installed.
    #[test]
    fn devices_compute_as_they_should() {
        let there: Vec<String> =
            crate::list().into_iter().filter(|listed| listed.is_there).map(|listed| listed.id).collect();
        assert!(there.contains(&"host".to_string()), "{:?}", crate::list());
        for id in there {
            let device = open(&id).unwrap();
            check(&*device, false).unwrap();
            check(&*device, true).unwrap();
        }
    }

    /// One wrong bit in any operation fails the test, and the message names the operation.
    #[test]
    fn a_device_that_rounds_otherwise_is_refused() {
        for (number, operation) in (0..).zip(OPERATIONS) {
            let error = check(&Wrong(number), operation.kind == Kind::Single).unwrap_err().to_string();
            assert!(error.contains(operation.name), "{error}");
        }
    }
}
