//! `render --shard 2/4`: one part of an image, kept in a file for `pathmark merge`.

use super::prelude::*;
use super::rounds::PAUSE_S;
use crate::film::{Shard, ShardCut};
use crate::measure::{Checkpoint, Goal, Rounds};
use std::env;

/// The part of an image that a machine renders.
#[derive(Args)]
pub(super) struct Part {
    /// Render one of N parts, as in 2/4, into the file that -o names; the same command resumes an unfinished part. `auto` reads the task of a
    /// SLURM array. `pathmark merge` makes the image
    #[arg(long, value_name = "I/N", allow_hyphen_values = true, help_heading = "Part", requires = "image",
          conflicts_with_all = ["target_error", "time_limit", "checkpoint", "adaptive", "trace", "auto_exposure"])]
    shard: Option<String>,
    /// How the image is divided into parts
    #[arg(long, value_enum, default_value_t = Cut::Samples, help_heading = "Part", requires = "shard")]
    shard_by: Cut,
}

/// [`ShardCut`] as an option.
#[derive(Clone, Copy, ValueEnum)]
enum Cut {
    /// The samples of every pixel, in blocks of 16
    Samples,
    /// The pixels, in tiles of 32x32
    Tiles,
}

impl Part {
    /// The part, if one is asked for.
    pub(super) fn shard(&self) -> Result<Option<Shard>> {
        let cut = match self.shard_by {
            Cut::Samples => ShardCut::Samples,
            Cut::Tiles => ShardCut::Tiles,
        };
        self.shard
            .as_deref()
            .map(|text| if text == "auto" { of_array(cut) } else { Shard::parse(text, cut) })
            .transpose()
    }
}

/// The part of this task of a SLURM array: the task's number among those from the first to the last.
fn of_array(cut: ShardCut) -> Result<Shard> {
    let read = |name: &str| {
        let text = env::var(name).unwrap_or_default();
        text.parse::<u32>().map_err(|_| {
            let problem = format!("needs a number in {name}, which is \"{text}\"");
            Error::from(InputError::new("shard", "auto", problem).allowed("a task of a SLURM array, or I/N"))
        })
    };
    let task = |suffix: &str| read(&format!("SLURM_ARRAY_TASK_{suffix}"));
    let (id, count, first, last) = (task("ID")?, task("COUNT")?, task("MIN")?, task("MAX")?);
    // An array with gaps, such as one that repeats failed tasks, does not tell the number of parts.
    let shard = if last.checked_sub(first).and_then(|span| span.checked_add(1)) == Some(count) {
        id.checked_sub(first).and_then(|index| Shard::new(index + 1, count, cut))
    } else {
        None
    };
    shard.ok_or_else(|| {
        let problem = format!("cannot number task {id} of {count} from {first} to {last}: the array has gaps");
        InputError::new("shard", "auto", problem).allowed("I/N").into()
    })
}

/// Renders the part into its file, from where an earlier process stopped; returns the number of invalid samples.
pub(super) fn render(shard: Shard, setup: Setup, path: &Path, as_json: bool, console: &Console) -> Result<u64> {
    let samples = shard.samples(setup.settings().spp);
    let mut rounds = Rounds::of(setup, Some(shard))?;
    let (checkpoint, saved) = Checkpoint::open(path, &rounds, None)?;
    let before = saved.as_ref().map(|saved| saved.position);
    if let Some(saved) = saved {
        rounds.adopt(saved.film, saved.history);
    }
    let (name, resumed) = (rounds.setup().name().to_string(), rounds.spp() - samples.start);
    let goal = Goal { spp: Some(samples.end), target_error: None, time_limit_s: None, pause_s: Some(PAUSE_S) };
    console.begin(&format!("part {shard} of {name}"), samples.len() as u64);
    let extend = &mut |rounds: &mut Rounds, spp| rounds.extend_to(spp, None);
    goal.pursue(&mut rounds, before, extend, &mut |rounds, position| {
        let done = rounds.spp() - samples.start;
        console.note(&format!("{name}: {done} of {} samples after {:.2} s", samples.len(), position.rendering_s));
        console.advance(u64::from(done));
        checkpoint.save(rounds, position)
    })?;
    console.end();
    let outcome = rounds.outcome();
    for warning in &outcome.warnings {
        console.note(&format!("warning: {warning}"));
    }
    let (cut, makespan_s) = (shard.cut().to_string(), outcome.makespan_s);
    if as_json {
        let (index, count) = (shard.index(), shard.count());
        print_json(&json!({
            "part": path.display().to_string(), "shard": index, "shards": count, "by": cut, "first_sample": samples.start,
            "samples": samples.len(), "resumed": resumed, "pixels": rounds.pixels(), "makespan_s": makespan_s,
        }))?;
    } else {
        let pixels = counted(rounds.pixels() as usize, "pixel");
        let (first, last) = (samples.start, samples.end - 1);
        print(&format!(
            "{}: part {shard} of {name} by {cut}, samples {first} to {last} of {pixels}, {makespan_s:.3} s",
            path.display()
        ))?;
    }
    Ok(outcome.counts.invalid)
}
