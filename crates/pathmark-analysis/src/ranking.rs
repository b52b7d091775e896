//! Rankings of several candidates by pairwise orders, with one error probability for all orders together.
//!
//! Two candidates are compared by the sign test over the blocks in which both were measured. If neither is faster in
//! more than half of the blocks, the number of blocks in which one of them is faster is binomial (n, 1/2). The two
//! one-sided hypotheses of every pair are tested together by S. Holm, "A simple sequentially rejective multiple test
//! procedure", Scandinavian Journal of Statistics 6 (1979). The probability that any reported order is wrong is then at
//! most the requested one, for all distributions and any dependence between the comparisons.

use super::confidence_sequence::{FEWEST, Stopping, median_sequence};
use super::interval::is_level;
use statrs::distribution::{Binomial, DiscreteCDF};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Returns the pairs (less, more) of candidates whose order is established by their values in blocks; `miss`, in (0,
/// 1), bounds the probability that any of these orders is wrong. For a pair, blocks with a missing value or two equal
/// values are ignored.
///
/// ```
/// use pathmark_analysis::ranking::told_apart;
/// use std::collections::{BTreeMap, BTreeSet};
/// let (fast, slow) = ((0..8).map(|block| (block, 1.0)), (0..8).map(|block| (block, 1.5)));
/// let things: [BTreeMap<u32, f64>; 2] = [slow.collect(), fast.collect()];
/// assert_eq!(told_apart(&things, 0.05), BTreeSet::from([(1, 0)]));
/// ```
pub fn told_apart<K: Ord>(things: &[BTreeMap<K, f64>], miss: f64) -> BTreeSet<(usize, usize)> {
    let mut tests = Vec::new();
    for (a, of_a) in things.iter().enumerate() {
        for (b, of_b) in things.iter().enumerate().take(a) {
            tests.push((sign_test(of_a, of_b), (a, b)));
            tests.push((sign_test(of_b, of_a), (b, a)));
        }
    }
    tests.sort_by(|x, y| x.0.total_cmp(&y.0));
    let count = tests.len();
    let rejected =
        tests.into_iter().enumerate().take_while(|(at, (p, _))| is_level(miss) && *p <= miss / (count - at) as f64);
    rejected.map(|(_, (_, pair))| pair).collect()
}

/// Returns for each candidate whether it may be the least: none of the others is established to be less. Each
/// comparison is wrong with probability `miss` at most, so only wrong comparisons with the others can exclude the least
/// candidate.
///
/// ```
/// use pathmark_analysis::confidence_sequence::Stopping;
/// use pathmark_analysis::ranking::may_be_least;
/// use std::collections::BTreeMap;
/// let (fast, slow) = ((0..8).map(|block| (block, 1.0)).collect(), (0..8).map(|block| (block, 1.5)).collect());
/// let things: [&BTreeMap<u32, f64>; 2] = [&slow, &fast];
/// assert_eq!(may_be_least(&things, 0.05, Stopping::Fixed), [false, true]);
/// ```
pub fn may_be_least<K: Ord>(things: &[&BTreeMap<K, f64>], miss: f64, stopping: Stopping) -> Vec<bool> {
    let is_less = |first, second| match stopping {
        Stopping::Fixed => is_level(miss) && sign_test(first, second) <= miss,
        // An interval misses on two sides, of which only one counts here.
        Stopping::Sequential => order_so_far(first, second, 2.0 * miss) == Some(Ordering::Less),
    };
    things.iter().map(|own| !things.iter().any(|other| is_less(*other, *own))).collect()
}

/// One-sided p-value: the probability that the first is less in at least this many blocks if it is less in half of
/// them.
fn sign_test<K: Ord>(first: &BTreeMap<K, f64>, second: &BTreeMap<K, f64>) -> f64 {
    let pairs = || first.iter().filter_map(|(block, value)| Some((*value, *second.get(block)?)));
    let wins = pairs().filter(|(a, b)| a < b).count() as u64;
    let losses = pairs().filter(|(a, b)| a > b).count() as u64;
    Binomial::new(0.5, wins + losses).map_or(1.0, |chance| chance.cdf(losses))
}

/// Returns the order of two candidates by the median of their ratios, if this look establishes it. All looks together
/// are wrong with probability `miss` at most. `None` also below the number of blocks that an interval of 95 % needs.
pub fn order_so_far<K: Ord>(first: &BTreeMap<K, f64>, second: &BTreeMap<K, f64>, miss: f64) -> Option<Ordering> {
    let ratios: Vec<f64> = first.iter().filter_map(|(block, value)| Some(value / second.get(block)?)).collect();
    let interval = median_sequence(&ratios, 1.0 - miss).filter(|_| ratios.len() >= FEWEST)?;
    let is_known = !interval.contains(1.0);
    is_known.then(|| interval.low.total_cmp(&1.0))
}

/// Returns the fewest blocks in which the order of any two of `things` candidates can be established.
pub fn least_blocks(things: usize, miss: f64) -> u32 {
    let tests = (things * things.saturating_sub(1)).max(1) as f64;
    (0..64).find(|blocks| libm::ldexp(1.0, -blocks) <= miss / tests).map_or(64, i32::unsigned_abs)
}

/// Returns the largest sets without an established order between two members. Every candidate is in at least one set,
/// and two candidates share a set unless their order is in `told`. Sets are ordered by their first members (H.-P.
/// Piepho, "An algorithm for a letter-based representation of all-pairwise comparisons", Journal of Computational and
/// Graphical Statistics 13, 2004).
pub fn groups(things: usize, told: &BTreeSet<(usize, usize)>) -> Vec<BTreeSet<usize>> {
    let mut sets: Vec<BTreeSet<usize>> = vec![(0..things).collect()];
    for (a, b) in told {
        let (both, mut kept): (Vec<_>, Vec<_>) = sets.into_iter().partition(|set| set.contains(a) && set.contains(b));
        for set in both {
            for without in [a, b] {
                let mut smaller = set.clone();
                smaller.remove(without);
                if !kept.iter().any(|larger| smaller.is_subset(larger)) {
                    kept.retain(|other| !other.is_subset(&smaller));
                    kept.push(smaller);
                }
            }
        }
        sets = kept;
    }
    sets.sort();
    sets
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    fn things(values: &[&[f64]]) -> Vec<BTreeMap<usize, f64>> {
        values.iter().map(|own| own.iter().copied().enumerate().collect()).collect()
    }

    /// With two candidates and n blocks of one order, p = 2^-n is compared with .05 / 2: five blocks are too few, six
    /// are enough.
    #[test]
    fn it_takes_enough_blocks_to_tell_an_order() {
        assert_eq!(least_blocks(2, 0.05), 6);
        let told = |blocks: usize| told_apart(&things(&[&vec![2.0; blocks], &vec![1.0; blocks]]), 0.05);
        assert_eq!((told(5), told(6)), (BTreeSet::new(), BTreeSet::from([(1, 0)])));
        // 30 candidates have 870 hypotheses: 2^14 = 16 384 < 870 / .05 = 17 400 <= 2^15.
        assert_eq!(least_blocks(30, 0.05), 15);
        assert_eq!((least_blocks(1, 0.05), least_blocks(0, 0.05)), (5, 5));
        assert!(told_apart(&things(&[&[1.0; 9]]), 0.05).is_empty());
        assert!(told_apart(&things(&[&[1.0; 9], &[2.0; 9]]), 0.0).is_empty());
    }

    /// With one comparison, seven blocks would be enough for the bet alone: 2^8 / 8 = 32 >= 20.
    #[test]
    fn fewer_than_eight_blocks_tell_nothing_before_their_number_is_known() {
        for (blocks, expected) in [(7, [true, true]), (8, [false, true])] {
            let [slow, fast] = [2.0, 1.0].map(|value| (0..blocks).map(|block| (block, value)).collect());
            assert_eq!(may_be_least(&[&slow, &fast], 0.05, Stopping::Sequential), expected, "{blocks}");
        }
    }

    /// Ties and missing values are no evidence.
    #[test]
    fn blocks_without_an_order_say_nothing() {
        let (mut a, b) = (vec![1.0; 6], vec![2.0; 6]);
        assert_eq!(told_apart(&things(&[&a, &b]), 0.05).len(), 1);
        a[3] = 2.0;
        assert!(told_apart(&things(&[&a, &b]), 0.05).is_empty());
        assert!(told_apart(&things(&[&a[..5], &b]), 0.05).is_empty());
    }

    /// Three candidates in 7 blocks; the first two change their order in one: p = 8/128 for them and 1/128 for the
    /// others. Six hypotheses: Holm compares the two least with .05 / 6 = .00833 and .05 / 5 = .01, and the third,
    /// .0625, with .05 / 4.
    #[test]
    fn holms_limits_grow() {
        let (a, b, c) = ([1.0; 7], [2.0, 2.0, 2.0, 0.5, 2.0, 2.0, 2.0], [3.0; 7]);
        assert_eq!(told_apart(&things(&[&a, &b, &c]), 0.05), BTreeSet::from([(0, 2), (1, 2)]));
    }

    #[test]
    fn groups_are_the_largest_sets_without_an_order() {
        let sets = |things: usize, told: &[(usize, usize)]| -> Vec<Vec<usize>> {
            groups(things, &told.iter().copied().collect()).into_iter().map(|set| set.into_iter().collect()).collect()
        };
        assert_eq!(sets(3, &[]), [vec![0, 1, 2]]);
        assert_eq!(sets(3, &[(0, 1), (0, 2), (1, 2)]), [[0], [1], [2]]);
        assert_eq!(sets(4, &[(0, 2), (0, 3), (1, 3)]), [[0, 1], [1, 2], [2, 3]]);
        // The four pairs without an established order form a cycle.
        assert_eq!(sets(4, &[(0, 3), (1, 2)]), [[0, 1], [0, 2], [1, 3], [2, 3]]);
    }

    /// Two candidates share a group unless their order is established, and no group is a subset of another.
    #[test]
    fn groups_agree_with_pairs() {
        let mut generator = Pcg64Dxsm::new(3, 1);
        for _ in 0..200 {
            let mut told = BTreeSet::new();
            for a in 0..7 {
                for b in a + 1..7 {
                    if generator.next_u64().is_multiple_of(3) {
                        told.insert((a, b));
                    }
                }
            }
            let sets = groups(7, &told);
            for a in 0..7 {
                for b in a + 1..7 {
                    let is_shared = sets.iter().any(|set| set.contains(&a) && set.contains(&b));
                    assert_eq!(is_shared, !told.contains(&(a, b)), "{a} {b} {told:?} {sets:?}");
                }
            }
            for (at, set) in sets.iter().enumerate() {
                assert!(sets.iter().enumerate().all(|(other, larger)| other == at || !set.is_subset(larger)));
            }
        }
    }

    /// Simulates tables of six candidates and 20 blocks, with heavy-tailed noise and a drift that all candidates of a
    /// block share. Returns how many tables have a wrong order, and how many orders are established. Candidate i takes
    /// `step`^i times as long.
    fn tables(count: u32, step: f64) -> (u32, usize) {
        let mut generator = Pcg64Dxsm::new(11, 4);
        let mut uniform = || ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0;
        let (mut wrong, mut told) = (0, 0);
        for _ in 0..count {
            let mut things = vec![BTreeMap::new(); 6];
            for block in 0..20 {
                let drift = 1.0 + uniform();
                for (at, thing) in (0..).zip(&mut things) {
                    let (u, disturbed) = (uniform(), if uniform() < 0.1 { 1.5 } else { 1.0 });
                    let noise = libm::exp(0.03 * libm::log(u / (1.0 - u)));
                    thing.insert(block, drift * disturbed * noise * libm::pow(step, f64::from(at)));
                }
            }
            let found = told_apart(&things, 0.05);
            wrong += u32::from(found.iter().any(|(less, more)| step == 1.0 || less > more));
            told += found.len();
        }
        (wrong, told)
    }

    /// Equal candidates: at most 5 % of 400 tables, 20, establish an order, and three standard deviations are 13. For
    /// candidates 10 % apart, most orders are established, and few are wrong.
    #[test]
    fn orders_are_seldom_wrong_and_found() {
        let ((wrong, _), (wrong_way, told)) = (tables(400, 1.0), tables(40, 1.1));
        println!(
            "equal things: {wrong} of 400 tables tell an order; 10 % apart: {told} of 600 orders, {wrong_way} wrong"
        );
        assert!(wrong <= 33, "{wrong}");
        assert!(told > 450 && wrong_way <= 8, "{told} {wrong_way}");
    }
}
