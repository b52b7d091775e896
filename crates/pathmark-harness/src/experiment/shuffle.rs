//! The order in which cells are run: each repetition visits all cells once, in its own random order, so that machine
//! drift affects all cells equally.

use rand::Rng;
use rand_pcg::Pcg32;

/// A permutation of `0..n` that depends on the name and the round alone (Fisher and Yates, 1938; Durstenfeld's form, 1964).
pub(super) fn shuffled(n: usize, name: &str, round: u32) -> Vec<usize> {
    let key = name
        .bytes()
        .fold(0xCBF2_9CE4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3));
    let mut pcg = Pcg32::new(key, u64::from(round));
    let mut order: Vec<usize> = (0..n).collect();
    for last in (1..n).rev() {
        // The product's high half is below `last + 1`; its bias of n/2^32 does not matter here.
        let pick = (u64::from(pcg.next_u32()) * (last as u64 + 1)) >> 32;
        order.swap(last, pick as usize);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::shuffled;

    #[test]
    fn permutes_and_repeats_itself() {
        for n in [0, 1, 2, 17, 100] {
            let mut order = shuffled(n, "x", 3);
            assert_eq!(order, shuffled(n, "x", 3));
            order.sort_unstable();
            assert_eq!(order, (0..n).collect::<Vec<_>>());
        }
        assert_ne!(shuffled(50, "x", 0), shuffled(50, "x", 1));
    }

    /// Each of the 6 orders of three cells occurs about equally often in 6000 rounds: chi-square with 5 degrees of
    /// freedom lies between its 0.05 % and 99.95 % quantiles (0.16 and 22.1), so counts that are too even fail as well.
    #[test]
    fn orders_are_uniform() {
        let mut counts = std::collections::HashMap::new();
        for round in 0..6000 {
            *counts.entry(shuffled(3, "orders", round)).or_insert(0_u32) += 1;
        }
        let chi2: f64 =
            counts.values().map(|count| (f64::from(*count) - 1000.0) * (f64::from(*count) - 1000.0) / 1000.0).sum();
        assert!(counts.len() == 6 && (0.16..22.1).contains(&chi2), "{chi2}");
    }
}
