//! Statements of somebody's rows: ratios of times, orders of schedules, slopes of errors, and images. All that have an error are
//! judged together, so that their verdicts share one level. Seconds are never stated: they are the machine's.

use super::diff::Times;
use super::ranking::{least_repetitions, told_orders};
use super::together::Schedules;
use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::equivalence::{Equivalence, Measured, equivalence, more_units};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Confidence that no verdict on a ratio, an order or a slope is wrong, over all statements together.
pub const JOINT_LEVEL: f64 = 0.95;

/// The subject of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The time of a cell over the time of another one.
    Ratio,
    /// The schedules of an image by speed.
    Order,
    /// The exponent of RMSE against samples per pixel.
    Slope,
    /// The bits of an image.
    Image,
    /// Cells that cannot be measured here at all.
    Cells,
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Ratio => "ratio",
            Self::Order => "order",
            Self::Slope => "slope",
            Self::Image => "image",
            Self::Cells => "cells",
        }
    }

    /// The independent values behind it, in the singular.
    pub fn unit(self) -> &'static str {
        if self == Self::Slope { "seed" } else { "repetition" }
    }
}

/// A statement of somebody's rows, and the verdict of the rows here.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    pub experiment: String,
    pub kind: Kind,
    pub says: String,
    /// Their ratio or exponent, or the number of orders that they tell; `None` for images and cells.
    pub theirs: Option<f64>,
    pub theirs_interval: Option<[f64; 2]>,
    /// The same here; of their orders those that are told here, too.
    pub here: Option<f64>,
    pub here_interval: Option<[f64; 2]>,
    /// The ratio here over theirs, or the exponent here less theirs, with the ends of its interval.
    pub difference: Option<[f64; 3]>,
    pub verdict: Reproduction,
    /// Orders that are reversed here, or both checksums; empty if there is nothing to add.
    pub note: String,
}

impl Statement {
    /// Whether it is about times, which a machine may disturb.
    pub(super) fn is_timed(&self) -> bool {
        matches!(self.kind, Kind::Ratio | Kind::Order)
    }

    pub(super) fn here_over_theirs(&self) -> Option<f64> {
        Some(self.here? / self.theirs?)
    }
}

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "is", content = "why")]
pub enum Reproduction {
    Reproduced,
    NotReproduced,
    /// How many more values here would tell; `None` if theirs are too few, or the difference lies at the limit.
    CannotTell(Option<usize>),
    /// Why there are no rows here, although this machine has the hardware: an error, or a program that is not there.
    NotMeasured(String),
    /// The part that this machine lacks.
    OtherHardware(String),
}

impl Reproduction {
    /// All verdicts, those first of which a reader wants to know first.
    pub const NAMES: [&str; 5] = ["not reproduced", "cannot tell", "not measured", "other hardware", "reproduced"];

    pub fn name(&self) -> &'static str {
        let [not, untold, unmeasured, hardware, reproduced] = Self::NAMES;
        match self {
            Self::NotReproduced => not,
            Self::CannotTell(_) => untold,
            Self::NotMeasured(_) => unmeasured,
            Self::OtherHardware(_) => hardware,
            Self::Reproduced => reproduced,
        }
    }

    /// Why there are no rows here; empty if there are some.
    pub fn lacks(&self) -> &str {
        match self {
            Self::NotMeasured(why) | Self::OtherHardware(why) => why,
            Self::Reproduced | Self::NotReproduced | Self::CannotTell(_) => "",
        }
    }

    /// Whether the rows tell.
    pub fn is_judged(&self) -> bool {
        matches!(self, Self::Reproduced | Self::NotReproduced)
    }
}

/// A statement before all are judged together.
#[derive(Debug)]
pub(super) struct Unjudged {
    pub(super) experiment: String,
    pub(super) kind: Kind,
    pub(super) says: String,
    pub(super) evidence: Evidence,
}

#[derive(Debug)]
pub(super) enum Evidence {
    /// Two values: logarithms of ratios, or exponents. Differences up to `limit` count as equal.
    Values { theirs: Measured, here: Measured, limit: f64 },
    /// The orders (faster, slower) that they tell, and the times of these schedules here.
    Orders { theirs: BTreeSet<(String, String)>, here: Schedules, stopping: Stopping },
    /// A verdict without any error, with their value if they have one.
    Known { theirs: Option<f64>, verdict: Reproduction, note: String },
}

impl Evidence {
    /// There are no rows here, and why.
    pub(super) fn lacking(theirs: Option<f64>, verdict: Reproduction) -> Self {
        Self::Known { theirs, verdict, note: String::new() }
    }

    /// Their rows give no error: they have too few units, or their values do not vary.
    pub(super) fn of_theirs(units: usize, fewest: usize, noun: &str) -> Self {
        let plural = if units == 1 { "" } else { "s" };
        let note = if units < fewest {
            format!("their rows have {units} {noun}{plural}, and an interval needs at least {fewest}")
        } else {
            format!("the values of their {units} {noun}{plural} give no interval")
        };
        Self::Known { theirs: None, verdict: Reproduction::CannotTell(None), note }
    }

    /// The rows here give no error, as those of [`Evidence::of_theirs`].
    pub(super) fn of_few_here(theirs: f64, units: usize, fewest: usize) -> Self {
        let more = fewest.checked_sub(units).filter(|more| *more > 0);
        let note = if more.is_some() { "" } else { "the values here give no interval" };
        Self::Known { theirs: Some(theirs), verdict: Reproduction::CannotTell(more), note: note.to_string() }
    }
}

/// Judges the statements of all experiments together. Bonferroni's inequality gives each that has an error the same share of
/// the probability that any verdict is wrong. Returns also the confidence of each.
pub(super) fn judge_together(all: Vec<Unjudged>) -> (Vec<Statement>, f64) {
    let count = all.iter().filter(|own| !matches!(own.evidence, Evidence::Known { .. })).count();
    let miss = (1.0 - JOINT_LEVEL) / count.max(1) as f64;
    (all.into_iter().map(|own| own.judged(miss)).collect(), 1.0 - miss)
}

impl Unjudged {
    fn judged(self, miss: f64) -> Statement {
        let Self { experiment, kind, says, evidence } = self;
        let statement = Statement {
            experiment,
            kind,
            says,
            theirs: None,
            theirs_interval: None,
            here: None,
            here_interval: None,
            difference: None,
            verdict: Reproduction::CannotTell(None),
            note: String::new(),
        };
        match evidence {
            Evidence::Values { theirs, here, limit } => of_values(statement, [theirs, here], limit, 1.0 - miss),
            Evidence::Orders { theirs, here, stopping } => of_orders(statement, &theirs, &here, miss, stopping),
            Evidence::Known { theirs, verdict, note } => Statement { theirs, verdict, note, ..statement },
        }
    }
}

fn of_values(statement: Statement, [theirs, here]: [Measured; 2], limit: f64, level: f64) -> Statement {
    let is_ratio = statement.kind == Kind::Ratio;
    let shown = |value: f64| if is_ratio { libm::exp(value) } else { value };
    let interval = |own: &Measured| {
        let half = own.half_width(level)?;
        finite([own.value - half, own.value + half].map(shown))
    };
    let compared = equivalence(theirs, here, limit, level);
    let verdict = match compared {
        // The same seeds give the same images, and so the same slope without any error.
        _ if theirs.value == here.value => Reproduction::Reproduced,
        Some((_, Equivalence::Equivalent)) => Reproduction::Reproduced,
        Some((_, Equivalence::Different)) => Reproduction::NotReproduced,
        Some((_, Equivalence::Open)) => Reproduction::CannotTell(more_units(theirs, here, limit, level)),
        None => Reproduction::CannotTell(None),
    };
    Statement {
        theirs: Some(shown(theirs.value)),
        theirs_interval: interval(&theirs),
        here: Some(shown(here.value)),
        here_interval: interval(&here),
        difference: compared.and_then(|(difference, _)| finite(difference.map(shown))),
        verdict,
        ..statement
    }
}

/// Numbers that JSON can keep.
fn finite<const N: usize>(values: [f64; N]) -> Option<[f64; N]> {
    values.iter().all(|value| value.is_finite()).then_some(values)
}

/// Where both rows are sure of an order, it is the same or reversed. Theirs are stated as they tell them, so `miss` bounds the
/// probability that one told here is wrong.
fn of_orders(
    statement: Statement,
    theirs: &BTreeSet<(String, String)>,
    here: &Schedules,
    miss: f64,
    stopping: Stopping,
) -> Statement {
    let told = told_orders(here, miss, stopping);
    let is_reversed = |(faster, slower): &&(String, String)| told.contains(&(slower.clone(), faster.clone()));
    let reversed: Vec<&(String, String)> = theirs.iter().filter(is_reversed).collect();
    let same = theirs.intersection(&told).count();
    let repetitions = here.values().map(|own| processes(&own.times)).max().unwrap_or(0);
    let least = least_repetitions(here.len(), miss, stopping) as usize;
    let verdict = match (reversed.len(), same) {
        (0, 0) => Reproduction::CannotTell(least.checked_sub(repetitions).filter(|more| *more > 0)),
        (0, _) => Reproduction::Reproduced,
        _ => Reproduction::NotReproduced,
    };
    let words = reversed.iter().map(|(slower, faster)| format!("{faster} is faster than {slower} here"));
    Statement {
        theirs: Some(theirs.len() as f64),
        here: Some(same as f64),
        verdict,
        note: words.collect::<Vec<String>>().join("; "),
        ..statement
    }
}

fn processes(times: &Times) -> usize {
    times.keys().map(|(process, _)| process).collect::<BTreeSet<_>>().len()
}
