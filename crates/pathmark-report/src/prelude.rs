//! Imports that figures and what they are made of share: operations on rows, numbers as text, and charts.

pub(crate) use crate::analysis::confidence_sequence::Stopping;
pub(crate) use crate::analysis::quantile::median;
pub(crate) use crate::analysis::{Estimate, Interval};
pub(crate) use crate::block::Block;
pub(crate) use crate::error::Result;
pub(crate) use crate::estimated::{Estimated, LEVEL};
pub(crate) use crate::figures::options::{options, yardstick};
pub(crate) use crate::measure::{ImageKey, ScheduleKey};
pub(crate) use crate::naming::joined;
pub(crate) use crate::paired::{
    Forget, Partners, Ratio, Repeats, along, any_schedule, in_common, medians, ratios, ratios_of_groups, time_ratio,
    time_ratios, with_intervals,
};
pub(crate) use crate::plot::style::Look;
pub(crate) use crate::plot::{
    Axis, Cell, Comparison, ContactSheet, Curve, DotPlot, DotRow, LineChart, Overlay, Point, Series, Title,
};
pub(crate) use crate::results::Results;
pub(crate) use crate::rows::{Row, gathered, group, typical, values};
pub(crate) use crate::schedule::Schedule;
pub(crate) use crate::table::Digits::{Decimals, Significant};
pub(crate) use crate::titles;
pub(crate) use crate::words::{bars, counted, in_table_order, ratio_bars, with_level};
pub(crate) use serde::Deserialize;
pub(crate) use std::collections::{BTreeMap, BTreeSet};
