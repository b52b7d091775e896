//! Parts of titles: numbers that a reader takes in at a glance, with as much of the interval as their meaning needs.

use crate::analysis::Interval;
use crate::estimated::Estimated;
use crate::plot::number::{between, short};
use crate::rows::paired::Ratio;

/// A number whose interval reaches further from it than this share is told with the interval.
const WIDE: f64 = 0.1;

/// A count as the first word of a title.
pub(super) fn spelled(count: usize) -> String {
    const WORDS: [&str; 13] =
        ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten", "Eleven", "Twelve"];
    WORDS.get(count).map_or_else(|| count.to_string(), |word| (*word).to_string())
}

/// A value with three digits, and with its interval if that is wide; `None` without one.
pub(super) fn told(value: impl Into<Estimated>) -> Option<String> {
    let Estimated { value, interval, .. } = value.into();
    let Interval { low, high, .. } = interval?;
    let is_wide = (high - value).max(value - low) > WIDE * value.abs();
    Some(short(value, 3) + &between(Some((low, high)).filter(|_| is_wide), 3))
}

/// Percent with a decimal below ten.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.abs() < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// How much longer something takes, from a ratio of times above 1.
pub(super) fn longer(ratio: f64) -> String {
    if ratio < 2.0 { format!("{} longer", percent(ratio - 1.0)) } else { format!("{} times as long", short(ratio, 2)) }
}

/// Numbers of ratios by the side of 1 on which their intervals lie. Partial ratios are not counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sides {
    pub(super) above: usize,
    pub(super) below: usize,
    /// Those that are not told apart from 1.
    pub(super) open: usize,
}

impl Sides {
    pub(super) fn of<T: Into<Estimated>>(ratios: impl IntoIterator<Item = T>) -> Self {
        let mut sides = Self { above: 0, below: 0, open: 0 };
        let whole = ratios.into_iter().map(Into::into).filter(|told: &Estimated| !told.is_partial);
        for interval in whole.filter_map(|told| told.interval) {
            let side = match (interval.low > 1.0, interval.high < 1.0) {
                (true, _) => &mut sides.above,
                (_, true) => &mut sides.below,
                _ => &mut sides.open,
            };
            *side += 1;
        }
        sides
    }

    pub(super) fn count(self) -> usize {
        self.above + self.below + self.open
    }
}

/// The largest of some ratios that certainly exceeds 1; partial ratios are not ranked.
pub(super) fn largest_above_1<T>(ratios: impl IntoIterator<Item = (T, Ratio)>) -> Option<(T, Ratio)> {
    let beyond = ratios.into_iter().filter(|(_, ratio)| !ratio.is_partial && ratio.interval.low > 1.0);
    beyond.max_by(|a, b| a.1.value.total_cmp(&b.1.value))
}

/// The least and the largest of some values, if their intervals are disjoint.
pub(super) fn ends_apart<T: Copy>(values: impl IntoIterator<Item = (T, Estimated)>) -> Option<[(T, Estimated); 2]> {
    let whole = values.into_iter().filter(|(_, told)| !told.is_partial && told.interval.is_some());
    let whole: Vec<(T, Estimated)> = whole.collect();
    let least = *whole.iter().min_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let most = *whole.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    (least.1.interval?.high < most.1.interval?.low).then_some([least, most])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, low: f64, high: f64) -> Estimated {
        Estimated::of(value, Some(Interval { low, high, level: 0.95 }))
    }

    #[test]
    fn only_wide_intervals_are_told() {
        assert_eq!(told(of(1.974, 1.95, 1.99)).as_deref(), Some("1.97"));
        assert_eq!(told(of(1.974, 1.5, 2.2)).as_deref(), Some("1.97 (1.5 to 2.2)"));
        assert_eq!(told(Estimated::of(1.974, None)), None);
    }

    #[test]
    fn numbers_are_rounded_to_be_read_at_a_glance() {
        assert_eq!([spelled(0), spelled(9), spelled(13)], ["No", "Nine", "13"]);
        assert_eq!([percent(0.0071), percent(0.0996), percent(0.264)], ["0.7 %", "10 %", "26 %"]);
        assert_eq!([longer(1.263), longer(2.44)], ["26 % longer", "2.4 times as long"]);
    }

    #[test]
    fn an_interval_that_contains_1_takes_no_side() {
        let partial = Estimated { is_partial: true, ..of(9.0, 8.0, 10.0) };
        let all = [of(1.25, 1.1, 1.3), of(1.2, 0.9, 1.3), of(0.8, 0.7, 0.9), partial, Estimated::of(5.0, None)];
        assert_eq!(Sides::of(all), Sides { above: 1, below: 1, open: 1 });
        let ratios = || all[..3].iter().copied().chain([partial]).enumerate();
        let found = largest_above_1(ratios().filter_map(|(at, told)| Some((at, Ratio::of(told)?))));
        assert_eq!(found.map(|(at, _)| at), Some(0));
        assert_eq!(ends_apart(ratios()).map(|ends| ends.map(|(at, _)| at)), Some([2, 0]));
        assert_eq!(ends_apart(ratios().take(2)).map(|ends| ends.map(|(at, _)| at)), None);
    }
}
