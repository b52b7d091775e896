//! Speedups of one schedule against several baselines of the same image, and those that exceed the number of workers.

use crate::analysis::speedup::{Oddity, oddity, serial_fraction_within};
use crate::prelude::*;

/// A schedule and the compiled-in effects, which distinguish the builds and schedules of an experiment.
type Kind<'a> = (&'a Schedule, &'a str);

/// A schedule on several threads against one baseline.
struct Against<'a> {
    own: Kind<'a>,
    baseline: Kind<'a>,
    speedup: Ratio,
}

impl Against<'_> {
    fn workers(&self) -> usize {
        self.own.0.key.threads
    }

    fn is_superlinear(&self) -> bool {
        oddity(&self.speedup.interval, self.workers()) == Some(Oddity::Superlinear)
    }

    fn name(&self) -> String {
        format!("{} over {}", told_kind(self.own), told_kind(self.baseline))
    }
}

fn told_kind((schedule, effects): Kind<'_>) -> String {
    let threads = schedule.key.threads;
    let of_several = if threads > 1 { format!(" on {threads} threads") } else { String::new() };
    format!("{}{of_several}, effects {effects}", schedule.key.strategy)
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let kinds: BTreeMap<Kind<'_>, Vec<&Row>> = results.by(|row| (&row.schedule, row.effects.as_str()));
    let (alone, several): (Vec<_>, Vec<_>) = kinds.iter().partition(|((schedule, _), _)| schedule.key.threads == 1);
    let cells = several.into_iter().flat_map(|(own, rows)| {
        alone.iter().map(move |(baseline, base)| ((*own, **baseline), base.as_slice(), rows.as_slice()))
    });
    let all = time_ratios(cells, any_schedule, results.stopping())?.into_iter();
    let mut all: Vec<Against<'_>> = all.map(|((own, baseline), speedup)| Against { own, baseline, speedup }).collect();
    all.sort_by(|a, b| a.speedup.falling(&b.speedup));
    let dots = all.iter().map(|a| DotRow::new(a.name(), vec![Some(Estimated::from(a.speedup).dot())])).collect();
    let ends = titles::ends_apart(all.iter().map(|against| ((), Estimated::from(against.speedup))));
    let result = ends.map(|[((), least), ((), most)]| {
        format!("The baseline alone changes the speedup from {:.2} to {:.2}", least.value, most.value)
    });
    let title = Title::new("One schedule against several baselines").with_result(result);
    let mut plot = DotPlot::new(title, Axis::linear("speedup").including([1.0, 2.1]), dots);
    let workers = all.iter().map(Against::workers).collect::<BTreeSet<_>>().into_iter();
    plot.guides = workers.map(|workers| (workers as f64, format!("{workers} workers"))).collect();
    plot.subtitle = results.workload();
    plot.caption = ratio_bars(all.iter().map(|against| against.speedup));
    Ok([Block::figure("baselines", plot)].into_iter().chain(finding(&all)).chain([table(&all)]).collect())
}

fn finding(all: &[Against<'_>]) -> Option<Block> {
    let mut ranked = all.iter().filter(|against| !against.speedup.is_partial);
    let most = ranked.next()?;
    let verdict = if most.is_superlinear() { "superlinear" } else { "not superlinear" };
    let told = |Against { speedup, .. }: &Against<'_>, times: &str| {
        format!("{:.2} {times}, {}", speedup.value, with_level(&speedup.interval, 2))
    };
    let (name, workers) = (most.name(), most.workers());
    let highest = format!("{name}: {}, {verdict} on {workers} workers", told(most, "times as fast"));
    Some(Block::finding(match ranked.next_back() {
        Some(least) => {
            let (name, told) = (least.name(), told(least, "times"));
            format!("{highest}; {name}: {told}. The schedule is the same; only the baseline differs.")
        }
        None => format!("{highest}."),
    }))
}

fn table(all: &[Against<'_>]) -> Block {
    let fraction = |against: &&Against<'_>| {
        serial_fraction_within(&against.speedup.estimate(), against.workers()).map(Estimated::from)
    };
    Block::table("baselines", "Speedup and Karp-Flatt fraction by baseline", all)
        .column("schedule", |against| told_kind(against.own))
        .column("baseline", |against| told_kind(against.baseline))
        .estimated("speedup", Decimals(3), |against| Estimated::from(against.speedup))
        .estimated("e", Decimals(3), fraction)
        .column("remark", |against| if against.is_superlinear() { "superlinear".into() } else { String::new() })
        .end()
}
