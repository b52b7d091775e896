//! Plans: the table of `--plan`, what pairs reach, and a line before a long run.

use crate::console::output::print;
use crate::error::Result;
use crate::experiment::{Plan, Power, Prices, Sweep};
use crate::lab::Lab;

/// The plans of all sweeps, and how they were made.
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
        let sum = Some(self.sum()).filter(|_| self.each.len() > 1);
        for plan in self.each.iter().chain(&sum) {
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

/// Prints the plan of one experiment, and what pairs of its comparisons reach.
pub(super) fn print_with_power(lab: &Lab, sweep: &Sweep<'_>) -> Result<()> {
    Plans::new(lab, std::slice::from_ref(sweep))?.print(0)?;
    for Power { with, comparisons, round_s, plans } in sweep.power()? {
        print(&format!("\n{comparisons} comparisons with {with}; a round of all its cells takes {round_s:.2} s"))?;
        print(&format!("{:>9}  {:>9}  {:>7}  {:>8}", "precision", "processes", "pairs", "seconds"))?;
        for (share, plan) in plans {
            let goal = format!("±{:.0} %", 100.0 * share);
            print(&match plan {
                Some(plan) => {
                    format!("{goal:>9}  {:>9}  {:>7}  {:>8.0}", plan.processes, plan.pairs, plan.seconds)
                }
                None => format!("{goal:>9}  not within {} processes", 1 << 12),
            })?;
        }
    }
    Ok(())
}

fn megabytes(plan: &Plan) -> f64 {
    plan.bytes as f64 / 1e6
}
