//! Axes: positions of values, and ticks that readers expect.

use super::number;

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences take equal distances.
    Linear,
    /// Equal ratios take equal distances. Values that are not positive have no position.
    Log,
}

/// The quantity, scale and labels of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    pub scale: Scale,
    /// The labelled values, such as the thread counts or spp of an experiment, in ascending order; `None` for round
    /// numbers.
    pub ticks: Option<Vec<f64>>,
    /// Values that the axis must reach even if no point does, such as 0 or 1.
    pub include: Vec<f64>,
}

impl Axis {
    /// A linear axis with automatic ticks.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, ticks: None, include: Vec::new() }
    }

    pub fn log(label: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }

    /// Labels exactly these values, which may be unsorted and repeated.
    #[must_use]
    pub fn ticks_at(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        self.ticks = Some(values);
        self
    }

    /// Extends the axis to these values, whatever the data.
    #[must_use]
    pub fn including(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.include.extend(values);
        self
    }
}

/// Larger values have no position: their differences would overflow.
const LARGEST: f64 = 1e300;
/// Free space at either end of the data, as a share of its extent.
const PADDING: f64 = 0.05;

/// An axis whose ends are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    scale: Scale,
    low: f64,
    high: f64,
}

/// A mark on an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Its position: 0 is the low end, 1 the high end.
    pub place: f64,
    /// Its text; empty for a minor tick.
    pub label: String,
}

impl Range {
    /// The range of all `values` that have a position, and of the values to include. `None` if none of `values` has
    /// one.
    pub fn of(axis: &Axis, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let scale = axis.scale;
        let mut data = values.into_iter().filter_map(|value| scaled(scale, value)).peekable();
        data.peek()?;
        let included = axis.include.iter().filter_map(|&value| scaled(scale, value));
        let (low, high) = data.chain(included).fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        let size = low.abs().max(high.abs());
        let extent = high - low;
        let pad = match scale {
            _ if extent > size * 1e-9 && extent > 1.0 / LARGEST => PADDING * extent,
            // One value, or values that differ only by rounding: pad by a quarter of a decade, or by a tenth.
            Scale::Log => 0.25,
            Scale::Linear if size > 1.0 / LARGEST => 0.1 * size,
            Scale::Linear => 1.0,
        };
        // Padding must not suggest that a time could be negative.
        let from_zero = scale == Scale::Linear && low >= 0.0 && low < pad;
        Some(Self { scale, low: if from_zero { 0.0 } else { low - pad }, high: high + pad })
    }

    /// The position of `value`: 0 is the low end, 1 the high end. `None` if it has no position on such an axis.
    pub fn place(&self, value: f64) -> Option<f64> {
        Some((scaled(self.scale, value)? - self.low) / (self.high - self.low))
    }

    /// The value at a position.
    pub fn value(&self, place: f64) -> f64 {
        let at = self.low + place * (self.high - self.low);
        if self.scale == Scale::Log { libm::pow(10.0, at) } else { at }
    }

    /// Ticks in ascending order; of automatic ones, about `most` at most have labels.
    pub fn ticks(&self, labelled: Option<&[f64]>, most: usize) -> Vec<Tick> {
        match (labelled, self.scale) {
            (Some(values), _) => values.iter().filter_map(|&value| self.tick(value, number::short(value, 6))).collect(),
            (None, Scale::Linear) => self.linear_ticks(self.low, self.high, most),
            (None, Scale::Log) => self.log_ticks(most),
        }
    }

    /// A tick at `value`, if that is on the axis.
    fn tick(&self, value: f64, label: String) -> Option<Tick> {
        let place = self.place(value)?;
        (-1e-9..=1.0 + 1e-9).contains(&place).then_some(Tick { place, label })
    }

    /// Multiples of 1, 2 or 5 times a power of ten between two values.
    fn linear_ticks(&self, low: f64, high: f64, most: usize) -> Vec<Tick> {
        let raw = (high - low) / most.max(2) as f64;
        let exponent = libm::floor(libm::log10(raw)) as i32;
        let unit = power_of_ten(exponent);
        let step = [1.0, 2.0, 5.0].into_iter().map(|m| m * unit).find(|&step| step >= raw * (1.0 - 1e-9));
        let (step, exponent) = step.map_or((10.0 * unit, exponent + 1), |step| (step, exponent));
        let largest = low.abs().max(high.abs());
        let plain = number::is_plain(largest) && exponent > -5;
        let leading = libm::floor(libm::log10(largest)) as i32;
        let label = |value: f64| {
            if plain {
                number::fixed(value, (-exponent).max(0) as usize)
            } else {
                number::scientific(value, (leading - exponent).clamp(0, 9) as usize)
            }
        };
        let (first, last) = (libm::ceil(low / step - 1e-9), libm::floor(high / step + 1e-9));
        let count = (last - first).clamp(0.0, 50.0) as usize;
        (0..=count).filter_map(|i| Some((first + i as f64) * step).and_then(|v| self.tick(v, label(v)))).collect()
    }

    /// Labels the first of the usual sets of mantissas that gives at least four and at most `most` labels; the others
    /// become minor ticks. Less than about half a decade has round numbers, as on a linear axis.
    fn log_ticks(&self, most: usize) -> Vec<Tick> {
        const SETS: [&[u32]; 5] = [&[1], &[1, 2, 5], &[1, 3], &[1, 2, 3, 5], &[1, 2, 3, 4, 5, 6, 7, 8, 9]];
        let (first, last) = (libm::floor(self.low) as i32, libm::ceil(self.high) as i32);
        let inside = |exponent: i32, mantissa: u32| {
            let at = f64::from(exponent) + libm::log10(f64::from(mantissa));
            (self.low..=self.high).contains(&at)
        };
        let count = |set: &[u32]| (first..=last).map(|e| set.iter().filter(|&&m| inside(e, m)).count()).sum::<usize>();
        let powers = count(&[1]);
        if powers > most {
            // Too many decades to label each power of ten: label every second, fifth, tenth ...
            let fits = |stride: &i32| powers <= most * stride.unsigned_abs() as usize;
            let stride = [2, 5, 10, 20, 50, 100, 200].into_iter().find(fits).unwrap_or(500);
            let shown = (first..=last).filter(|e| e.rem_euclid(stride) == 0);
            return shown.filter_map(|e| self.power_tick(e, 1, true, true)).collect();
        }
        let fitting = SETS.into_iter().find(|set| (4..=most).contains(&count(set)));
        if fitting.is_none() && self.high - self.low < 0.9 {
            return self.linear_ticks(self.value(0.0), self.value(1.0), most.min(6));
        }
        let set = fitting.unwrap_or(&[1]);
        let plain = number::is_plain(power_of_ten(first)) && number::is_plain(power_of_ten(last));
        let each = (first..=last).flat_map(|e| (1..=9).map(move |m| (e, m)));
        each.filter_map(|(e, m)| self.power_tick(e, m, set.contains(&m), !plain)).collect()
    }

    fn power_tick(&self, exponent: i32, mantissa: u32, labelled: bool, scientific: bool) -> Option<Tick> {
        let value = f64::from(mantissa) * power_of_ten(exponent);
        let label = match (labelled, scientific) {
            (false, _) => String::new(),
            (true, true) => number::scientific(value, 0),
            (true, false) => number::short(value, 6),
        };
        self.tick(value, label)
    }
}

/// `value`, or its logarithm on a logarithmic axis; `None` if it has no position.
fn scaled(scale: Scale, value: f64) -> Option<f64> {
    match scale {
        Scale::Linear => (value.abs() <= LARGEST).then_some(value),
        Scale::Log => (value > 0.0 && value <= LARGEST).then(|| libm::log10(value)),
    }
}

/// The number nearest to a power of ten, so that ticks print with few digits.
fn power_of_ten(exponent: i32) -> f64 {
    libm::exp10(f64::from(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64], most: usize) -> Vec<String> {
        let range = Range::of(axis, values.iter().copied()).unwrap();
        let ticks = range.ticks(axis.ticks.as_deref(), most);
        assert!(ticks.windows(2).all(|pair| pair[0].place < pair[1].place));
        ticks.into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn linear_labels_are_round() {
        assert_eq!(labels(&Axis::linear("t"), &[0.0, 10.0], 6), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(&Axis::linear("t"), &[0.0, 0.9], 5), ["0.0", "0.2", "0.4", "0.6", "0.8"]);
        assert_eq!(labels(&Axis::linear("t"), &[-1.0, 1.0], 5), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&Axis::linear("t"), &[0.0, 3e7], 4), ["0", "10⁷", "2×10⁷", "3×10⁷"]);
    }

    #[test]
    fn log_labels_are_one_two_five_or_powers() {
        assert_eq!(labels(&Axis::log("e"), &[0.01, 0.1], 8), ["0.01", "0.02", "0.05", "0.1"]);
        assert_eq!(labels(&Axis::log("e"), &[0.002, 0.3], 8), ["0.002", "0.005", "0.01", "0.02", "0.05", "0.1", "0.2"]);
        assert_eq!(labels(&Axis::log("e"), &[1e-5, 1e2], 8).first().unwrap(), "10⁻⁵");
        assert_eq!(labels(&Axis::log("e"), &[1.02, 1.3], 6), ["1.1", "1.2", "1.3"]);
        let many = labels(&Axis::log("e"), &[1e-200, 1e200], 8);
        assert!((3..=9).contains(&many.len()), "{many:?}");
    }

    #[test]
    fn given_values_are_labelled_and_no_others() {
        let axis = Axis::log("samples").ticks_at([8.0, 20.0, 40.0, 80.0, 200.0]);
        assert_eq!(labels(&axis, &[8.0, 200.0], 3), ["8", "20", "40", "80", "200"]);
        assert_eq!(labels(&axis, &[8.0, 40.0], 3), ["8", "20", "40"]);
    }

    #[test]
    fn ranges_include_their_required_values() {
        let range = Range::of(&Axis::linear("e").including([0.0, 1.0]), [0.8, 0.9]).unwrap();
        assert_eq!(range.place(0.0), Some(0.0));
        assert!(range.place(1.0).unwrap() < 1.0);
        let log = Range::of(&Axis::log("e"), [0.0, -1.0, f64::NAN, 1.0, 100.0]).unwrap();
        assert!((log.place(10.0).unwrap() - 0.5).abs() < 1e-12);
        assert!((log.value(0.5) - 10.0).abs() < 1e-9);
        assert_eq!(log.place(0.0), None);
    }

    #[test]
    fn hard_ranges_have_places_and_ticks() {
        for axis in [Axis::linear("x"), Axis::log("x")] {
            for values in [[3.0; 2], [1e-310; 2], [1e299, 1e300], [1e15, 1e15 + 1.0], [1e-300, 1e300], [5e-324, 1.0]] {
                let range = Range::of(&axis, values).unwrap();
                for value in values {
                    let place = range.place(value).unwrap();
                    assert!((0.0..=1.0).contains(&place), "{values:?} {place}");
                }
                assert!(range.ticks(None, 6).len() < 200, "{values:?}");
            }
        }
        assert_eq!(Range::of(&Axis::linear("x"), [f64::NAN, f64::INFINITY]), None);
        assert_eq!(Range::of(&Axis::log("x").including([1.0]), [0.0]), None);
    }
}
