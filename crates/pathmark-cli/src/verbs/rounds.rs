//! The options of `render` that render in rounds: until an accuracy, until time is up, with checkpoints.

use super::prelude::*;
use crate::measure::{CONFIDENCE, Checkpoint, Extend, Goal, Outcome, Rounds, Warning};

/// Seconds of rendering between two checkpoints. Writing one takes some tenths of a second.
pub(super) const PAUSE_S: f64 = 10.0;

/// When to stop, and what to keep in between.
#[derive(Args)]
pub(super) struct Until {
    /// Stop when the image's own RMSE in linear radiance, estimated from its samples, is below E with 95 % confidence
    #[arg(long, value_name = "E")]
    target_error: Option<f64>,
    /// Stop before rendering takes longer than this; at least one round is rendered
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<f64>,
    /// Save the render in this file at intervals, and resume from it if it exists
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
}

/// Seconds, with or without their unit.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    let length = || humantime::parse_duration(text).ok().map(|length| length.as_secs_f64());
    text.parse().ok().or_else(length).ok_or_else(|| "is no time (allowed: seconds, or a time such as 2min)".to_string())
}

impl Until {
    /// Whether the options need more than one round.
    pub(super) fn is_multi_round(&self) -> bool {
        self.has_goal() || self.checkpoint.is_some()
    }

    /// Whether an error or a time ends the render, and not a number of samples.
    fn has_goal(&self) -> bool {
        self.target_error.is_some() || self.time_limit.is_some()
    }

    /// The option that names a file to be written, and the file.
    pub(super) fn output(&self) -> (&'static str, Option<&PathBuf>) {
        ("checkpoint", self.checkpoint.as_ref())
    }

    /// Puts the goal into the record.
    pub(super) fn label(&self, record: &mut Record) {
        record.target_error = self.target_error;
        record.time_limit_s = self.time_limit.map(Into::into);
    }
}

/// Renders until the goal is reached: `spp` samples per pixel, if there is no other goal.
pub(super) fn render(
    arguments: &Until,
    setup: Setup,
    spp: u32,
    console: &Console,
    extend: Extend<'_>,
) -> Result<(Setup, Outcome)> {
    let spp = (!arguments.has_goal()).then_some(spp);
    let mut rounds = Rounds::new(setup)?;
    let (checkpoint, saved) = match &arguments.checkpoint {
        Some(path) => {
            let (checkpoint, saved) = Checkpoint::open(path, &rounds, arguments.target_error)?;
            (Some(checkpoint), saved)
        }
        None => (None, None),
    };
    let before = saved.as_ref().map(|saved| saved.position);
    if let Some(saved) = saved {
        rounds.adopt(saved.film, saved.history);
    }
    let goal = Goal {
        spp,
        target_error: arguments.target_error,
        time_limit_s: arguments.time_limit,
        pause_s: checkpoint.as_ref().map(|_| PAUSE_S),
    };
    goal.check(&rounds)?;
    console.busy(&format!("building {}", rounds.setup().name()), || rounds.setup().build())?;

    let (resumed, name) = (rounds.spp(), rounds.setup().name().to_string());
    let title = match (spp, goal.target_error, goal.time_limit_s) {
        (Some(spp), ..) => format!("{name} at {spp} spp"),
        (_, Some(error), _) => format!("{name} until its RMSE < {error} ({:.0} % confidence)", 100.0 * CONFIDENCE),
        (.., limit_s) => format!("{name} for {} s", limit_s.unwrap_or_default()),
    };
    console.begin(&title, u64::from(spp.unwrap_or(0)));
    let missed = goal.pursue(&mut rounds, before, extend, &mut |rounds, position| {
        console.note(&format!("{name}: {} spp after {:.2} s", rounds.spp(), position.rendering_s));
        console.advance(u64::from(rounds.spp()));
        checkpoint.as_ref().map_or(Ok(()), |checkpoint| checkpoint.save(rounds, position))
    })?;
    console.end();
    let mut outcome = rounds.outcome();
    outcome.warnings.extend(missed);
    if resumed > 0 {
        outcome.warnings.push(Warning::Resumed(resumed));
    }
    Ok((rounds.into_setup(), outcome))
}
