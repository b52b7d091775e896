//! Rankings of several candidates by pairwise orders, with one error probability for all orders together.
//!
//! Two candidates are compared by the sign test over the blocks in which both were measured. If neither is faster in
//! more than half of the blocks, the number of blocks in which one of them is faster is binomial (n, 1/2). The two
//! one-sided hypotheses of every pair are tested together by S. Holm, "A simple sequentially rejective multiple test
//! procedure", Scandinavian Journal of Statistics 6 (1979). The probability that any reported order is wrong is then at
//! most the requested one, for all distributions and any dependence between the comparisons.

use super::adjacent_pairs::{by_process, p_of_less};
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
    holm(things, sign_test, miss)
}

/// The same for values that were measured in adjacent pairs, by process and pair: tests Student's t over processes.
pub fn told_apart_in_pairs(things: &[BTreeMap<Turn, f64>], miss: f64) -> BTreeSet<(usize, usize)> {
    holm(things, |first, second| p_of_less(&by_process(ratios_in_pairs(first, second))), miss)
}

/// A process and a pair.
pub type Turn = (u32, Option<u32>);

/// The ratios of values of the same turn, with their processes.
pub fn ratios_in_pairs(above: &BTreeMap<Turn, f64>, below: &BTreeMap<Turn, f64>) -> Vec<(u32, f64)> {
    above.iter().filter_map(|(turn, value)| Some((turn.0, value / below.get(turn)?))).collect()
}

/// The orders that a test with one-sided p-values establishes, corrected for the number of tests.
fn holm<T>(things: &[T], p_of_less: impl Fn(&T, &T) -> f64, miss: f64) -> BTreeSet<(usize, usize)> {
    let mut tests = Vec::new();
    for (a, of_a) in things.iter().enumerate() {
        for (b, of_b) in things.iter().enumerate().take(a) {
            tests.push((p_of_less(of_a, of_b), (a, b)));
            tests.push((p_of_less(of_b, of_a), (b, a)));
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
    let is_less = |first: &BTreeMap<K, f64>, second: &BTreeMap<K, f64>| match stopping {
        Stopping::Fixed => is_level(miss) && sign_test(first, second) <= miss,
        // An interval misses on two sides, of which only one counts here.
        Stopping::Sequential => order_so_far(first, second, 2.0 * miss) == Some(Ordering::Less),
    };
    things.iter().map(|own| !things.iter().any(|other| is_less(other, own))).collect()
}

/// The same for values that were measured in adjacent pairs.
pub fn may_be_least_in_pairs(things: &[&BTreeMap<Turn, f64>], miss: f64) -> Vec<bool> {
    let is_less = |first, second| is_level(miss) && p_of_less(&by_process(ratios_in_pairs(first, second))) <= miss;
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

/// Returns sets of candidates without an established order between two members. Two candidates share a set exactly if
/// their order is not in `told`, every candidate is in at least one set, and no set contains another. Sets are ordered by
/// their first members.
///
/// The letters of H.-P. Piepho, "An algorithm for a letter-based representation of all-pairwise comparisons", Journal of
/// Computational and Graphical Statistics 13 (2004), are all of the largest such sets, whose number may grow as 3^(n/3).
/// Sets that grow from pairs that share none yet are at most as many as pairs (J. Gramm, J. Guo, F. Hüffner, R.
/// Niedermeier, H.-P. Piepho and R. Schmid, "Algorithms for compact letter displays: comparison and evaluation",
/// Computational Statistics & Data Analysis 52, 2007). If the candidates lie on a line and are told apart from some
/// distance on, both are the same.
pub fn groups(things: usize, told: &BTreeSet<(usize, usize)>) -> Vec<BTreeSet<usize>> {
    let mut is_told = vec![vec![false; things]; things];
    for (a, b) in told {
        (is_told[*a][*b], is_told[*b][*a]) = (true, true);
    }
    let mut is_open: Vec<Vec<bool>> = is_told.iter().map(|row| row.iter().map(|is_told| !is_told).collect()).collect();
    let mut sets = Vec::new();
    for a in 0..things {
        for b in a..things {
            if is_open[a][b] {
                let set = grown([a, b], &is_told, &is_open);
                for (one, other) in set.iter().flat_map(|one| set.iter().map(move |other| (*one, *other))) {
                    is_open[one][other] = false;
                }
                sets.push(set);
            }
        }
    }
    without_superfluous(things, sets)
}

/// Adds candidates to a pair as long as no order between members is established, at each step the candidate with the
/// most open pairs.
fn grown(pair: [usize; 2], is_told: &[Vec<bool>], is_open: &[Vec<bool>]) -> BTreeSet<usize> {
    let mut fits = vec![true; is_told.len()];
    let mut open_pairs = vec![0_usize; is_told.len()];
    let (mut set, mut next) = (BTreeSet::new(), Some(pair[0]));
    while let Some(member) = next {
        set.insert(member);
        fits[member] = false;
        for other in 0..fits.len() {
            fits[other] &= !is_told[member][other];
            open_pairs[other] += usize::from(is_open[member][other]);
        }
        let candidates = (0..fits.len()).rev().filter(|other| fits[*other]);
        let most_open = candidates.max_by_key(|other| open_pairs[*other]);
        next = Some(pair[1]).filter(|second| !set.contains(second)).or(most_open);
    }
    set
}

/// Drops sets whose pairs all share another set, the last ones first, and sorts the rest.
fn without_superfluous(things: usize, mut sets: Vec<BTreeSet<usize>>) -> Vec<BTreeSet<usize>> {
    let pairs = |set: &BTreeSet<usize>| -> Vec<usize> {
        set.iter().flat_map(|one| set.iter().map(move |another| one * things + another)).collect()
    };
    let mut times_shared = vec![0_usize; things * things];
    for pair in sets.iter().flat_map(pairs) {
        times_shared[pair] += 1;
    }
    for at in (0..sets.len()).rev() {
        let own = pairs(&sets[at]);
        if own.iter().all(|pair| times_shared[*pair] > 1) {
            for pair in own {
                times_shared[pair] -= 1;
            }
            sets.remove(at);
        }
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

    /// Two candidates share a group exactly if their order is not established, and no group is a subset of another.
    fn check(things: usize, told: &BTreeSet<(usize, usize)>) -> usize {
        let sets = groups(things, told);
        let mut shared = BTreeSet::new();
        for set in &sets {
            shared.extend(set.iter().flat_map(|a| set.iter().map(move |b| (*a, *b))));
        }
        for (a, b) in (0..things).flat_map(|a| (a..things).map(move |b| (a, b))) {
            let is_told = told.contains(&(a, b)) || told.contains(&(b, a));
            assert_eq!(shared.contains(&(a, b)), !is_told, "{a} {b} {told:?} {sets:?}");
        }
        for (at, set) in sets.iter().enumerate() {
            assert!(sets.iter().enumerate().all(|(other, larger)| other == at || !set.is_subset(larger)));
        }
        sets.len()
    }

    #[test]
    fn groups_agree_with_pairs() {
        let mut generator = Pcg64Dxsm::new(3, 1);
        for things in [1, 2, 7, 20] {
            for one_in in [2, 3, 10] {
                for _ in 0..50 {
                    let pairs = (0..things).flat_map(|a| (0..things).map(move |b| (a, b))).filter(|(a, b)| a != b);
                    let told = pairs.filter(|_| generator.next_u64().is_multiple_of(one_in)).collect();
                    check(things, &told);
                }
            }
        }
    }

    /// 100 triples of candidates whose orders are established: 3^100 sets are largest. Candidates in the order of a
    /// line, told apart from a distance of 30 on: 271 runs of 30 neighbours are largest.
    #[test]
    fn groups_of_many_candidates_are_few() {
        let pairs = || (0..300).flat_map(|a| (0..a).map(move |b| (a, b)));
        assert!(check(300, &pairs().filter(|(a, b)| a / 3 == b / 3).collect()) <= 100);
        assert_eq!(check(300, &pairs().filter(|(a, b)| a - b >= 30).collect()), 271);
        assert_eq!(check(300, &pairs().collect()), 300);
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
