//! Each strategy compared with one of them: OpenMP's dynamic schedule, the field's yardstick, unless the experiment
//! names another.

use crate::prelude::*;
use crate::titles::Sides;

/// The field's yardstick.
const OPENMP: &str = "openmp-dynamic";

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let yardstick = yardstick(results, "openmp", OPENMP)?;
    let schedules = results.by(|row| &row.schedule);
    // If it ran with several numbers of threads, take the largest number that does not exceed the processors.
    let own = schedules.iter().filter(|(schedule, _)| schedule.key.strategy == yardstick);
    let place = |schedule: &Schedule| (schedule.key.threads <= results.run.machine.processors, schedule.key.threads);
    let Some((own, own_rows)) = own.max_by_key(|(schedule, _)| place(schedule)) else {
        return Ok(vec![Block::notice(format!("{yardstick} was not run, so there is nothing to compare with."))]);
    };
    let others = schedules.iter().filter(|(s, _)| *s != own && s.key.threads == own.key.threads);
    let cells = others.map(|(schedule, rows)| (*schedule, &rows[..], &own_rows[..]));
    let mut ratios = time_ratios(cells, any_schedule, results.stopping())?;
    ratios.sort_by(|a, b| a.1.rising(&b.1));
    let rows =
        ratios.iter().map(|(schedule, ratio)| DotRow::new(&schedule.name, vec![Some(Estimated::from(*ratio).dot())]));
    let axis = Axis::linear(format!("time / time of {yardstick}")).including([0.95, 1.05]);
    let title = if yardstick == OPENMP { "OpenMP's dynamic schedule" } else { &yardstick };
    let result = result(&ratios, title);
    let mut plot = DotPlot::new(Title::new(format!("Time against {title}")).with_result(result), axis, rows.collect());
    plot.guides = vec![(1.0, yardstick.clone())];
    plot.subtitle = results.workload();
    let bars = ratio_bars(ratios.iter().map(|(_, ratio)| *ratio));
    plot.caption = format!("{} each. {bars}", counted(own.key.threads, "thread"));
    let best = ratios.iter().find(|(schedule, ratio)| !ratio.is_partial && !schedule.name.starts_with("openmp"));
    let finding = best.map(|(best, ratio)| {
        Block::finding(format!(
            "With {} the fastest of this program's strategies is {}: {:.3} times the time of {yardstick}, {}.",
            counted(best.key.threads, "thread"),
            best.name,
            ratio.value,
            with_level(&ratio.interval, 3),
        ))
    });
    Ok([Block::figure("openmp", plot)].into_iter().chain(finding).collect())
}

/// The result in a line, from ratios in ascending order.
fn result(ratios: &[(&Schedule, Ratio)], title: &str) -> Option<String> {
    let sides = Sides::of(ratios.iter().map(|(_, ratio)| *ratio));
    let fastest = ratios.iter().find(|(_, ratio)| !ratio.is_partial && ratio.interval.high < 1.0);
    let ties = format!("{} of {} schedules", sides.open, sides.count());
    let slowest = titles::largest_above_1(ratios.iter().map(|(schedule, ratio)| (*schedule, *ratio)));
    Some(match (fastest, slowest) {
        (Some((fastest, ratio)), _) => {
            let less = titles::percent(1.0 - ratio.value);
            format!("{} takes {less} less time than {title}; {ties} tie with it", fastest.name)
        }
        (None, Some((slowest, ratio))) => {
            let longer = titles::longer(ratio.value);
            format!("No schedule is faster than {title}: {ties} tie with it, {} takes {longer}", slowest.name)
        }
        (None, None) if sides.count() == 0 => return None,
        (None, None) => format!("This machine cannot tell {} from {title}", counted(sides.count(), "schedule")),
    })
}
