//! Imports that figures share: operations on rows, numbers as text, and charts.

pub(super) use super::options::{Positive, options, yardstick};
pub(super) use crate::analysis::confidence_sequence::Stopping;
pub(super) use crate::analysis::quantile::median;
pub(super) use crate::analysis::{Estimate, Interval};
pub(super) use crate::block::Block;
pub(super) use crate::error::Result;
pub(super) use crate::estimated::{Estimated, LEVEL};
pub(super) use crate::measure::{ImageKey, ScheduleKey};
pub(super) use crate::naming::joined;
pub(super) use crate::paired::{
    Forget, Partners, Ratio, Repeats, along, any_schedule, estimates, in_common, medians, ratios, time_ratio,
    time_ratios, with_intervals,
};
pub(super) use crate::plot::style::Look;
pub(super) use crate::plot::{
    Axis, Cell, Comparison, ContactSheet, Curve, DotPlot, DotRow, LineChart, Overlay, Point, Series,
};
pub(super) use crate::results::Results;
pub(super) use crate::rows::{Row, gathered, group, typical, values};
pub(super) use crate::schedule::Schedule;
pub(super) use crate::table::Digits::{Decimals, Significant};
pub(super) use crate::words::{bars, counted, in_table_order, ratio_bars, with_level};
pub(super) use serde::Deserialize;
pub(super) use std::collections::{BTreeMap, BTreeSet};
