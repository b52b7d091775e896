//! Plans of `reproduce`: the table of `--plan`, and a line before a long run.

use crate::console::output::print;
use crate::error::Result;
use crate::experiment::{Plan, Prices, Sweep};
use crate::lab::Lab;

pub(super) struct Plans {
    pub(super) each: Vec<Plan>,
    kinds: usize,
    guessed: usize,
}

impl Plans {
    /// Renders the pilot and plans all sweeps.
    pub(super) fn new(lab: &Lab, sweeps: &[Sweep<'_>]) -> Result<Self> {
        let mut prices = Prices::new(lab);
        let each = sweeps.iter().map(|sweep| sweep.plan(&mut prices)).collect::<Result<Vec<_>>>()?;
        Ok(Self { each, kinds: prices.kinds(), guessed: prices.guessed })
    }

    fn sum(&self) -> Plan {
        self.each.iter().fold(Plan::default(), |sum, plan| Plan {
            name: "all".to_string(),
            cells: sum.cells + plan.cells,
            rows: sum.rows + plan.rows,
            references_s: sum.references_s + plan.references_s,
            halves: sum.halves + plan.halves,
            cells_s: sum.cells_s + plan.cells_s,
            bytes: sum.bytes + plan.bytes,
        })
    }

    /// The sum of all plans, in a line.
    pub(super) fn told(&self) -> String {
        let all = self.sum();
        let (minutes, megabytes) = ((all.seconds() / 60.0).ceil(), megabytes(&all));
        format!(
            "about {minutes:.0} min for {} rows of {} experiments and {megabytes:.0} MB, estimated by a pilot of {} renders; existing rows take no time",
            all.rows,
            self.each.len(),
            self.kinds - self.guessed
        )
    }

    /// Prints the table of all experiments, and how its seconds were estimated.
    pub(super) fn print(&self, left_out: usize) -> Result<()> {
        let width = self.each.iter().map(|plan| plan.name.len()).max().unwrap_or(0).max(10);
        let head = format!("{:width$}  {:>6}  {:>6}  {:>8}  {:>8}", "experiment", "cells", "rows", "seconds", "MB");
        let row = |plan: &Plan| {
            let (seconds, megabytes) = (plan.seconds(), megabytes(plan));
            format!("{:width$}  {:>6}  {:>6}  {seconds:>8.0}  {megabytes:>8.1}", plan.name, plan.cells, plan.rows)
        };
        print(&head)?;
        for plan in self.each.iter().chain([&self.sum()]) {
            print(&row(plan))?;
        }
        let pilot = self.kinds - self.guessed;
        print(&format!(
            "Seconds are an estimate: {pilot} small renders on one thread gave the time of a sample, and a cell's samples are divided by the processors \
             that its threads can use. The cost of schedules, locks and other programs is not included; MB exclude figures."
        ))?;
        if self.guessed > 0 {
            print(&format!(
                "{} kinds of images were not rendered; the estimate uses the mean of the others.",
                self.guessed
            ))?;
        }
        if left_out > 0 {
            print(&format!("{left_out} experiments do not have this profile."))?;
        }
        Ok(())
    }
}

fn megabytes(plan: &Plan) -> f64 {
    plan.bytes as f64 / 1e6
}
