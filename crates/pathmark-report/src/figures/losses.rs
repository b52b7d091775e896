//! Why not N times? The uses of the workers' time as stacked bars, and the largest loss of each schedule in words.

use crate::analysis::parallel_overhead::Part;
use crate::plot::style::{Colour, SERIES};
use crate::plot::{Piece, StackPart, StackRow, StackedBars};
use crate::prelude::*;
use crate::why::{Explained, explain};

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let found = explain(results)?;
    if found.is_empty() {
        let reason = "No schedule of several workers has a serial run beside it, so its losses are unknown.";
        return Ok(vec![Block::notice(reason)]);
    }
    // A loss over fewer repetitions than the others have is not ranked. Nor are those of other numbers of threads than the
    // title of the speedups is about: a thread for each processor, or fewer where nothing ran so.
    let processors = results.run.machine.processors;
    let place = |own: &Explained| (own.threads == processors, own.threads < processors);
    let usual = found.iter().map(place).max();
    let losses = found.iter().filter(|own| Some(place(own)) == usual);
    let losses = losses.filter_map(|own| Some((own, own.largest_loss()?)));
    let losses = losses.filter(|(_, (_, told))| !told.is_partial);
    let worst = losses.max_by(|a, b| a.1.1.value.total_cmp(&b.1.1.value));
    let mut blocks = vec![Block::figure("losses", chart(results, &found, worst))];
    blocks.extend(worst.map(|(own, _)| Block::finding(&own.sentence)));
    let mut table = Block::table("losses", "Why not N times? Shares of workers × time in percent", &found)
        .column("schedule", |own| own.name.clone());
    for part in parts(&found) {
        table = table.estimated(name_of(&found, part), Decimals(1), |own| Some(own.share(part)?.times(100.0)));
    }
    blocks.push(table.column("in words", |own| own.sentence.clone()).end());
    Ok(blocks)
}

/// The parts that some schedule has.
fn parts(found: &[Explained]) -> impl Iterator<Item = Part> {
    Part::ALL.into_iter().filter(|part| found.iter().any(|own| own.share(*part).is_some()))
}

/// The name of a part in the first schedule that has it.
fn name_of(found: &[Explained], part: Part) -> &'static str {
    found.iter().find(|own| own.share(part).is_some()).map_or("", |own| own.name_of(part))
}

fn chart(results: &Results, found: &[Explained], worst: Option<(&Explained, (Part, Estimated))>) -> StackedBars {
    let certain = worst.filter(|(_, (_, told))| told.interval.is_some_and(|interval| interval.low > 0.0));
    let result = certain.map(|(own, (part, told))| {
        let (name, part) = (&own.name, own.name_of(part));
        format!("Why not {} times? {name}, loses {:.0} % ({part})", own.slots, 100.0 * told.value)
    });
    let parts: Vec<Part> = parts(found).collect();
    let part = |part: &Part| StackPart { name: name_of(found, *part).to_string(), colour: colour(*part) };
    let row = |own: &Explained| {
        let piece = |part: &Part| {
            let told = own.share(*part)?.times(100.0);
            let shorter = if *part == Part::Work {
                own.share(Part::Inflation).map_or(0.0, |told| told.value.min(0.0))
            } else {
                0.0
            };
            let length = told.value + 100.0 * shorter;
            Some(Piece { length, value: told.value, interval: told.bar(), count: told.count })
        };
        let is_partial = own.share(Part::Work).is_some_and(|told| told.is_partial);
        let remark = if is_partial { ", fewer repetitions" } else { "" };
        StackRow { name: format!("{}{remark}", own.name), pieces: parts.iter().map(piece).collect() }
    };
    let shared = if found.iter().any(|own| own.is_oversubscribed) {
        "; of processors × time where more workers share them"
    } else {
        ""
    };
    StackedBars {
        title: Title::new("Why not N times? Where the time of the workers goes").with_result(result),
        subtitle: results.workload(),
        caption: format!(
            "Typical values over repetitions of shares of workers × (makespan + merge){shared}. Serial work: seconds inside jobs of the serial run \
             in the same repetition; if jobs took less time, its bar is shorter. The table has the intervals."
        ),
        axis: Axis::linear("share of workers × time, %").including([100.0]),
        parts: parts.iter().map(part).collect(),
        rows: found.iter().map(row).collect(),
    }
}

fn colour(part: Part) -> Colour {
    let place = match part {
        Part::Work => 0,
        Part::Inflation => 1,
        Part::Tail => 2,
        Part::Between => 3,
        Part::Starting => 4,
        Part::Merge => 5,
        Part::Idle => 7,
    };
    SERIES[place]
}
