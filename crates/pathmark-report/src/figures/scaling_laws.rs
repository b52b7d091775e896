//! Laws of speedup fitted to the measured speedups. If the points do not determine a law, the table says why.

use crate::analysis::scaling_law::{Fit, Law, Parameter, Point, fit};
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    Ok(vec![table(results, &[Law::Amdahl, Law::Universal], "scaling-laws")?])
}

/// A table of the fits of each law to each strategy, over numbers of workers that have a processor each. Beyond that,
/// more workers do not use more of the machine.
pub(super) fn table(results: &Results, laws: &[Law], stem: &'static str) -> Result<Block> {
    let processors = results.run.machine.processors;
    let lines = results.serial()?.lines(processors);
    let fits = lines.iter().flat_map(|(name, points)| laws.iter().map(move |law| (name, law, in_words(*law, points))));
    let title = format!("Laws of speedup, up to {processors} threads on {processors} processors");
    Ok(Block::table(stem, title, fits)
        .column("strategy", |(strategy, ..)| (*strategy).clone())
        .column("law", |(_, law, _)| law.to_string())
        .column("parameters, interval (confidence)", |(.., [parameters, _])| parameters.clone())
        .column("does it describe the points?", |(.., [_, verdict])| verdict.clone())
        .end())
}

/// The parameters, and whether the law describes the points.
fn in_words(law: Law, points: &[Point]) -> [String; 2] {
    match fit(law, points, LEVEL) {
        Fit::Unidentifiable(reason) => ["none".to_string(), format!("not identifiable: {reason}")],
        Fit::Found(fitted) => {
            let parameter = |parameter: &Parameter| {
                let estimate = &parameter.estimate;
                format!("{} = {:.4}, {}", parameter.name, estimate.value, with_level(&estimate.interval, 4))
            };
            let mut parameters: Vec<String> = fitted.parameters.iter().map(parameter).collect();
            if let Some(peak) = &fitted.peak {
                parameters.push(format!("peak at p = {:.0}, {}", peak.value, with_level(&peak.interval, 0)));
            }
            let counts = counted(fitted.worker_counts, "thread count");
            [parameters.join("; "), format!("{}; {counts} above 1", fitted.check)]
        }
    }
}
