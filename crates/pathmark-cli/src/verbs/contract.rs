//! `pathmark contract STRATEGY`: does a strategy keep the contract of all strategies?

use super::prelude::*;
use crate::experiment::BrokenPromise;
use crate::strategy::contract::Contract;
use std::time::Duration;

/// The longest time that an option accepts.
const LONGEST: Duration = Duration::from_hours(24);

/// `my-program contract own-threads`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A strategy of `list strategies`, with its parameter if it needs one: dynamic:7
    strategy: String,
    /// How long jobs may take to meet before they count as too few; no progress for twice as long counts as endless
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = time)]
    patience: Duration,
    /// Print the broken promises as a JSON array
    #[arg(long)]
    json: bool,
}

/// A time above zero.
pub(super) fn time(text: &str) -> std::result::Result<Duration, String> {
    let allowed = || format!("is not a time above 0s, at most {}", humantime::format_duration(LONGEST));
    let is_allowed = |length: &Duration| !length.is_zero() && *length <= LONGEST;
    humantime::parse_duration(text).ok().filter(is_allowed).ok_or_else(allowed)
}

pub(super) fn run(arguments: &Arguments, lab: &Lab) -> Result<()> {
    let (entry, parameter) = lab.strategy_named(&arguments.strategy)?;
    let contract = Contract { patience: arguments.patience, parameter, ..Contract::default() };
    let violations = contract.verify(&entry).err().unwrap_or_default();
    let broken: Vec<BrokenPromise> = violations.iter().map(BrokenPromise::from).collect();
    if arguments.json {
        print_json(&broken)?;
    } else {
        broken.iter().try_for_each(|promise| print(&promise.to_string()))?;
    }
    if !broken.is_empty() {
        let problem = format!("{} breaks its contract in {}", arguments.strategy, counted(broken.len(), "case"));
        return Err(Error::Check(problem));
    }
    if arguments.json { Ok(()) } else { print(&format!("{} keeps its contract", arguments.strategy)) }
}
