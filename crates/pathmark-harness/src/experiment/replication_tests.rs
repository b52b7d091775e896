//! Replications of invented rows, on a machine that disturbs runs: the errors of verdicts, and each kind of statement.

use super::comparisons::Comparisons;
use super::replication::{Both, Rows};
use super::statements::judge_together;
use super::{Cell, Definition, Kind, Profile, Reproduction, Statement};
use crate::analysis::confidence_sequence::Stopping;
use crate::lab::Lab;
use crate::measure::{Record, Warning, available_threads};
use rand::Rng;
use rand_pcg::Pcg64Dxsm;
use std::collections::BTreeSet;

const PROCESSES: u32 = 12;
const PAIRS: u32 = 6;

const TEXT: &str = "title = \"t\"\nquestion = \"q\"\nfigures = []\n[[compare]]\nwith = { strategy = [\"serial\"] }\n\
    [matrix]\nscene = [\"cornell\", \"cornell-lens\"]\nestimator = [\"bsdf\"]\nspp = [4]\nseed = [1]\n\
    strategy = [\"serial\", \"static-blocks\", \"work-stealing\"]\nthreads = [1]\ndecomposition = [\"tiles:8x8\"]\n\
    kernel = [\"scalar\"]\n";

/// The seconds of a schedule, in units of the serial ones: one that ties, and one that is faster.
fn usual(cell: &Cell) -> f64 {
    match cell.settings.strategy.as_str() {
        "serial" => 1.0,
        "static-blocks" => 1.01,
        _ => 0.7,
    }
}

/// A machine whose speed drifts, whose processes have a memory layout that favours some cells, and on which other programs
/// slow a few runs.
struct Machine {
    generator: Pcg64Dxsm,
    drift: f64,
}

impl Machine {
    fn unit(&mut self) -> f64 {
        ((self.generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(self.unit())).sqrt();
        radius * libm::cos(std::f64::consts::TAU * self.unit())
    }

    fn seconds(&mut self, usual: f64, layout: f64) -> f64 {
        self.drift += 0.01 * self.normal();
        let other = if self.unit() < 0.05 { 0.3 * self.unit() } else { 0.0 };
        0.02 * usual * libm::exp(self.drift + layout + other + 0.01 * self.normal())
    }
}

struct Experiment {
    definition: Definition,
    cells: Vec<Cell>,
    /// A row of each cell, without measurements.
    rows: Vec<Record>,
}

impl Experiment {
    fn new() -> Self {
        Self::of(TEXT)
    }

    fn of(text: &str) -> Self {
        let definition = Definition::from_text(&Lab::built_in(), "x", "x.toml", text).unwrap();
        let cells = definition.cells(Profile::Quick).unwrap();
        let row = |cell: &Cell| {
            let setup = definition.lab.prepare(cell.settings.clone()).unwrap();
            Record { cell: cell.id.clone(), ..Record::of(&setup) }
        };
        let rows = cells.iter().map(row).collect();
        Self { definition, cells, rows }
    }

    /// The rows of a measurement with this seed.
    fn measured(&self, seed: u128, usual: impl Fn(&Cell) -> f64) -> Vec<Record> {
        let mut machine = Machine { generator: Pcg64Dxsm::new(seed, 9), drift: 0.0 };
        let mut rows = Vec::new();
        for repetition in 0..PROCESSES {
            let layouts: Vec<f64> = self.cells.iter().map(|_| 0.005 * machine.normal()).collect();
            for pair in 0..PAIRS {
                let mut order: Vec<usize> = (0..self.cells.len()).collect();
                if pair % 2 == 1 {
                    order.reverse();
                }
                for at in order {
                    let makespan_s = Some(machine.seconds(usual(&self.cells[at]), layouts[at]));
                    let row = self.rows[at].clone();
                    let checksum = row.scene.clone();
                    rows.push(Record { repetition, pair: Some(pair), makespan_s, checksum, ..row });
                }
            }
        }
        rows
    }

    fn judged_with(
        &self,
        [theirs, here]: [Vec<Record>; 2],
        absent: &dyn Fn(&Cell) -> Option<String>,
    ) -> Vec<Statement> {
        let [theirs, here] = [theirs, here].map(|rows| Rows::of(rows, Stopping::Fixed, false));
        let both = Both { experiment: "x", cells: &self.cells, theirs, here, share: 0.1, absent };
        let pairs = Comparisons::of_any(&self.definition, Profile::Quick, &self.cells).unwrap().pairs;
        judge_together(both.statements(&pairs)).0
    }

    fn judged(&self, rows: [Vec<Record>; 2]) -> Vec<Statement> {
        self.judged_with(rows, &|_| None)
    }
}

fn verdicts(told: &[Statement], kind: Kind) -> Vec<&'static str> {
    told.iter().filter(|own| own.kind == kind).map(|own| own.verdict.name()).collect()
}

/// Ten replications on a machine that disturbs runs: all ratios of a tie and of a large difference come out, with the orders.
#[test]
fn a_measurement_is_reproduced_in_ten_of_ten_replications() {
    let own = Experiment::new();
    let theirs = own.measured(1, usual);
    for seed in 2..12 {
        let told = own.judged([theirs.clone(), own.measured(seed, usual)]);
        assert_eq!(verdicts(&told, Kind::Ratio), ["reproduced"; 4], "{seed}: {told:?}");
        assert_eq!(verdicts(&told, Kind::Order), ["reproduced"; 2], "{seed}: {told:?}");
        assert_eq!(verdicts(&told, Kind::Image), ["reproduced"; 2], "{seed}: {told:?}");
        // Work stealing is faster than both others; those tie, which is no order.
        assert!(told.iter().filter(|own| own.kind == Kind::Order).all(|own| own.theirs == Some(2.0)), "{told:?}");
    }
}

#[test]
fn a_ratio_that_is_bent_by_a_fifth_is_found_in_ten_of_ten_replications() {
    let own = Experiment::new();
    let theirs = own.measured(1, usual);
    let is_bent = |cell: &Cell| cell.settings.strategy == "work-stealing" && cell.settings.scene == "cornell-lens";
    let bent = |cell: &Cell| if is_bent(cell) { 1.2 * usual(cell) } else { usual(cell) };
    for seed in 2..12 {
        let told = own.judged([theirs.clone(), own.measured(seed, bent)]);
        let found: Vec<&Statement> = told.iter().filter(|own| own.verdict == Reproduction::NotReproduced).collect();
        let [found] = found.as_slice() else { panic!("{seed}: {told:?}") };
        assert!(found.says.contains("work-stealing") && found.says.contains("cornell-lens"), "{seed}: {found:?}");
        let [ratio, low, high] = found.difference.unwrap();
        assert!(low > 1.1 && high < 1.3 && (1.15..1.25).contains(&ratio), "{seed}: {found:?}");
    }
}

/// Ratios that differ only in another setting than the compared one name that setting.
#[test]
fn no_two_statements_say_the_same() {
    let two_numbers = TEXT.replace("spp = [4]", "spp = [4, 8]");
    let own = Experiment::of(&two_numbers);
    let told = own.judged([own.measured(1, usual), own.measured(2, usual)]);
    let ratios: Vec<&str> = told.iter().filter(|own| own.kind == Kind::Ratio).map(|own| own.says.as_str()).collect();
    assert_eq!((ratios.len(), ratios.iter().collect::<BTreeSet<_>>().len()), (8, 8), "{ratios:?}");
    assert!(ratios.contains(&"time of work-stealing over serial, cornell, spp 8"), "{ratios:?}");
}

/// Rows that all take twice as long give the same statements, bit for bit.
#[test]
fn seconds_are_never_stated() {
    let own = Experiment::new();
    let [theirs, here] = [1, 2].map(|seed| own.measured(seed, usual));
    let twice = |rows: &[Record]| -> Vec<Record> {
        rows.iter().map(|row| Record { makespan_s: row.makespan_s.map(|own| 2.0 * own), ..row.clone() }).collect()
    };
    let told = own.judged([theirs.clone(), here.clone()]);
    assert_eq!(own.judged([theirs.clone(), twice(&here)]), told);
    assert_eq!(own.judged([twice(&theirs), here]), told);
    assert!(told.iter().all(|own| !own.says.contains("second")), "{told:?}");
}

#[test]
fn reversed_orders_and_other_images_are_named() {
    let own = Experiment::new();
    let reversed = |cell: &Cell| if cell.settings.strategy == "work-stealing" { 1.3 } else { usual(cell) };
    let mut here = own.measured(2, reversed);
    for row in &mut here {
        row.checksum = "other".to_string();
    }
    let told = own.judged([own.measured(1, usual), here]);
    for kind in [Kind::Order, Kind::Image] {
        assert_eq!(verdicts(&told, kind), ["not reproduced"; 2], "{told:?}");
    }
    let note = |kind: Kind| &told.iter().find(|own| own.kind == kind).unwrap().note;
    assert_eq!(note(Kind::Order).matches(" is faster than ").count(), 2, "{told:?}");
    assert!(note(Kind::Order).contains("static-blocks") && note(Kind::Order).contains("serial"), "{told:?}");
    assert_eq!(note(Kind::Image), "checksum other instead of cornell");
}

/// Squared errors c / spp of six seeds that scatter, or their root.
#[test]
fn slopes_are_compared_by_their_exponents() {
    let own = Experiment::new();
    let errors = |seed: u128, exponent: f64| -> Vec<Record> {
        let mut machine = Machine { generator: Pcg64Dxsm::new(seed, 4), drift: 0.0 };
        let points = (1..7).flat_map(|seed| [4, 16, 64, 256].map(|spp| (seed, spp)));
        let row = |(seed, spp): (u64, u32)| {
            let mse = 0.3 * libm::pow(f64::from(spp), exponent) * libm::exp(0.02 * machine.normal());
            Record { cell: format!("{seed}/{spp}"), seed, spp, mse: Some(mse), ..own.rows[0].clone() }
        };
        points.map(row).collect()
    };
    let told = |here: Vec<Record>| own.judged([errors(1, -1.0), here]);
    let slope = |told: &[Statement]| told.iter().find(|own| own.kind == Kind::Slope).unwrap().clone();
    // The same seeds give the same images, whatever their spread.
    let same = slope(&told(errors(1, -1.0)));
    assert_eq!((same.verdict, same.theirs == same.here), (Reproduction::Reproduced, true));
    let other = slope(&told(errors(2, -1.0)));
    assert_eq!(other.verdict, Reproduction::Reproduced, "{other:?}");
    assert!((other.theirs.unwrap() + 0.5).abs() < 0.02 && !other.says.contains("0spp"), "{other:?}");
    let half = slope(&told(errors(2, -0.5)));
    assert_eq!(half.verdict, Reproduction::NotReproduced, "{half:?}");
    assert!((half.difference.unwrap()[0] - 0.25).abs() < 0.02, "{half:?}");
    assert_eq!(slope(&told(Vec::new())).verdict, Reproduction::NotMeasured("no rows here".to_string()));
    // One seed has no interval, on either side.
    let one = |seed: u128| errors(seed, -1.0).into_iter().filter(|row| row.seed == 1).collect::<Vec<Record>>();
    let few = slope(&told(one(2)));
    assert_eq!((few.verdict, few.theirs.is_some()), (Reproduction::CannotTell(Some(1)), true));
    let few = slope(&own.judged([one(1), errors(2, -1.0)]));
    assert_eq!(
        (few.verdict, few.note.as_str()),
        (Reproduction::CannotTell(None), "their rows have 1 seed, and an interval needs at least 2")
    );
}

/// Too few processes, no rows, cells that this machine cannot run, and cells that it does not even have.
#[test]
fn statements_without_rows_say_what_is_missing() {
    let own = Experiment::new();
    let theirs = own.measured(1, usual);
    let told = |here: Vec<Record>| own.judged([theirs.clone(), here]);
    let two = told(theirs.iter().filter(|row| row.repetition < 2).cloned().collect());
    let of_ratio = |told: &[Statement]| told.iter().find(|own| own.kind == Kind::Ratio).unwrap().verdict.clone();
    assert_eq!(of_ratio(&two), Reproduction::CannotTell(Some(1)));
    assert_eq!(verdicts(&two, Kind::Order), ["cannot tell"; 2]);
    let failed = theirs.iter().map(|row| Record { error: "no such kernel".to_string(), ..row.clone() }).collect();
    let lacking = Reproduction::NotMeasured("no such kernel".to_string());
    assert!(told(failed).iter().all(|own| own.verdict == lacking));
    let with = |warning: Warning| -> Vec<Record> {
        theirs.iter().map(|row| Record { warnings: warning.to_string(), makespan_s: None, ..row.clone() }).collect()
    };
    let without_device = told(with(Warning::NoDevice));
    assert!(without_device.iter().all(|own| own.verdict.lacks().ends_with("finds a GPU on this machine")));
    assert!(without_device.iter().all(|own| own.verdict.name() == "other hardware"), "{without_device:?}");
    assert!(told(with(Warning::NoProgram)).iter().all(|own| own.verdict.name() == "not measured"));
    let none = Reproduction::NotMeasured("no rows here".to_string());
    assert!(told(Vec::new()).iter().all(|own| own.verdict == none));
    let absent = |cell: &Cell| (cell.settings.scene == "cornell").then(|| "64 processors instead of 2".to_string());
    let here = theirs.iter().filter(|row| row.scene != "cornell").cloned().collect();
    let told_without = own.judged_with([theirs.clone(), here], &absent);
    let lacking = Reproduction::OtherHardware("64 processors instead of 2".to_string());
    for kind in [Kind::Ratio, Kind::Order, Kind::Image] {
        let of_kind: Vec<&Statement> = told_without.iter().filter(|own| own.kind == kind).collect();
        let (without, with) = of_kind.split_at(of_kind.len() / 2);
        assert!(without.iter().all(|own| own.verdict == lacking), "{of_kind:?}");
        assert!(with.iter().all(|own| own.verdict == Reproduction::Reproduced), "{of_kind:?}");
    }
    let unknown = Record { cell: "of another version".to_string(), ..theirs[0].clone() };
    let told = own.judged([[theirs.clone(), vec![unknown]].concat(), theirs.clone()]);
    let verdict = Reproduction::NotMeasured("this version of the program has no such cell".to_string());
    assert!(told.iter().any(|own| own.kind == Kind::Cells && own.verdict == verdict), "{told:?}");
    let threads = available_threads() + 62;
    let elsewhere = Record { cell: "elsewhere".to_string(), threads, ..theirs[0].clone() };
    let told = own.judged([[theirs.clone(), vec![elsewhere]].concat(), theirs.clone()]);
    let found: Vec<&Statement> = told.iter().filter(|own| own.kind == Kind::Cells).collect();
    let [cells] = found.as_slice() else { panic!("{told:?}") };
    let why = format!("{threads} threads instead of {}", available_threads());
    assert_eq!((cells.says.as_str(), &cells.verdict), ("cell elsewhere", &Reproduction::OtherHardware(why)));
}

/// Ratios of which their rows are too few for an interval are stated, too, with what theirs lack.
#[test]
fn ratios_of_few_repetitions_are_stated() {
    let own = Experiment::new();
    let few = |count: u32| own.measured(1, usual).into_iter().filter(|row| row.repetition < count).collect();
    let ratios = |theirs: Vec<Record>| -> Vec<Statement> {
        own.judged([theirs, own.measured(2, usual)]).into_iter().filter(|own| own.kind == Kind::Ratio).collect()
    };
    let told = ratios(few(2));
    let note = "their rows have 2 repetitions, and an interval needs at least 3";
    assert_eq!((told.len(), ratios(few(3)).len()), (4, 4));
    assert!(told.iter().all(|own| own.verdict == Reproduction::CannotTell(None) && own.note == note), "{told:?}");
}

/// Of many ratios with errors, each has a smaller share of the joint level, so intervals are wider than that of one alone.
#[test]
fn statements_share_one_level() {
    let own = Experiment::new();
    let [theirs, here] = [1, 2].map(|seed| own.measured(seed, usual));
    let of_one_scene = |rows: &[Record]| rows.iter().filter(|row| row.scene == "cornell").cloned().collect();
    let width = |told: &[Statement]| {
        let [_, low, high] = told[0].difference.unwrap();
        libm::log(high / low)
    };
    let all = width(&own.judged([theirs.clone(), here.clone()]));
    let few = width(&own.judged([of_one_scene(&theirs), of_one_scene(&here)]));
    assert!(all > 1.05 * few, "{all} {few}");
}
