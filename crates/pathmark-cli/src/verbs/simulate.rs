//! `pathmark simulate TRACE`: replays the jobs of a run on workers that this machine does not have.

use super::prelude::*;
use super::run::note_doubts;
use crate::cluster::MessageCosts;
use crate::console::output::aligned;
use crate::experiment::{MESSAGES, read_calibration};
use crate::measure::{
    CALIBRATIONS, CalibrationRow, ForeignLoad, SERIAL, TimingConcerns, TraceFile, available_threads, calibrate,
};
use crate::report::forecasts::{self, Predicted};
use crate::report::rank_forecasts::{self, RankPlan};
use crate::report::{Block, LEVEL, Results};
use crate::simulate::{Contender, Hardware, Messages, Observed, contenders, forecast};

/// `pathmark simulate run.csv --workers 1..4096`, after `pathmark render cornell --strategy serial --trace run.csv`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A trace that `render --trace` wrote, preferably of the strategy serial; or an experiment's folder with traces, whose measured runs
    /// are then predicted
    trace: PathBuf,
    /// Numbers of workers: a list, or A..B for A, twice A and so on up to B
    #[arg(long, value_name = "LIST", default_value = "1..4096")]
    workers: String,
    /// Only these strategies of `pathmark list strategies`, optionally with a parameter [default: all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    strategies: Vec<String>,
    /// Speed of one slow core; all others have speed 1
    #[arg(long, value_name = "SPEED", conflicts_with = "efficiency_cores")]
    slow_core: Option<f64>,
    /// N fast cores; all others have the given speed
    #[arg(long, value_name = "N:SPEED")]
    efficiency_cores: Option<String>,
    /// Forecast processes instead, which share jobs by these rules, as in `render --ranks`
    #[arg(long, value_name = "RULE", value_delimiter = ',', help_heading = "Processes")]
    ranks: Vec<String>,
    /// Numbers of processes, each with --workers threads
    #[arg(long, value_name = "LIST", default_value = "2..64", help_heading = "Processes", requires = "ranks")]
    nodes: String,
    /// Message costs, as printed by `mpiexec -n 2 pathmark inspect messages --json` [default: those of the experiment's folder, or zero]
    #[arg(long, value_name = "FILE", help_heading = "Processes", requires = "ranks")]
    messages: Option<PathBuf>,
    /// Leave out the check that predicts runs on this machine and measures them
    #[arg(long)]
    no_check: bool,
    /// Folder for the table and the figures
    #[arg(long, value_name = "DIR", default_value = "out/simulation")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let workers = parse_workers("workers", &arguments.workers)?;
    let hardware = hardware(arguments)?;
    let measured = if arguments.trace.is_dir() { Some(Results::open(lab, &arguments.trace)?) } else { None };
    let traces = match &measured {
        Some(results) => results.largest_serial_traces()?,
        None => vec![TraceFile::read(&arguments.trace)?],
    };
    let Some(trace) = traces.first() else {
        let problem = "holds no trace of the strategy serial";
        return Err(InputError::new("trace", arguments.trace.display().to_string(), problem).into());
    };
    if let Some(doubt) = trace.doubt() {
        console.note(&doubt);
    }
    // Threads that share a processor wait for it within their jobs.
    if trace.header.workers > 1 {
        console.note(&format!(
            "warning: this trace is of {} workers, so its jobs may contain waiting; a serial trace (render --strategy serial) \
             forecasts better",
            trace.header.workers
        ));
    }
    let costs: Vec<Vec<f64>> = traces.iter().map(TraceFile::costs_s).collect();
    // A strategy that is named twice is one.
    let mut named: Vec<String> = Vec::new();
    for name in &arguments.strategies {
        if !named.contains(name) {
            named.push(name.clone());
        }
    }
    let names = match &named[..] {
        [] => lab.strategies().iter().map(|entry| entry.name.to_string()).collect(),
        // A process with one thread runs its jobs in order.
        names if !arguments.ranks.is_empty() && !names.iter().any(|name| name == SERIAL) => {
            [names, &[SERIAL.to_string()]].concat()
        }
        names => names.to_vec(),
    };
    for name in &names {
        lab.strategy_named(name)?;
    }
    if !arguments.no_check && measured.is_none() {
        // These settings will be run. They come from a file, so they may be wrong or ask for too much.
        lab.prepare(trace.header.settings.clone())?;
    }
    let mut files = Files::default();
    files.reads("the trace", &arguments.trace);
    let mut rules = Vec::new();
    for rule in &arguments.ranks {
        rules.push(lab.rank_rule("ranks", rule)?);
    }
    let nodes = parse_workers("nodes", &arguments.nodes)?;
    let own = if rules.is_empty() { forecasts::FORECAST_FILES } else { rank_forecasts::RANK_FORECAST_FILES };
    for name in own {
        files.claims("out", &arguments.out.join(name))?;
    }
    create_folder("out", &arguments.out)?;
    let rows = overheads(arguments, lab, &names, console)?;
    let mut contenders = contenders(lab, &rows);

    if !arguments.no_check {
        let (predicted, doubts) = match &measured {
            Some(results) => (forecasts::predictions(results, &contenders)?, results.doubts()),
            None => predict_live(lab, trace, &contenders, console)?,
        };
        note_doubts(&doubts, console);
        show(&forecasts::prediction_blocks(&predicted))?;
    }
    let settings = &trace.header.settings;
    let spec = &settings.spec;
    let workload = format!(
        "{}, {}x{}, {} spp, {}, simulated{}",
        settings.scene,
        spec.width,
        spec.height,
        settings.spp,
        settings.decomposition,
        hardware_in_words(arguments)
    );
    let (blocks, table) = if rules.is_empty() {
        contenders.push(Contender::longest_first());
        let rows = forecast(&costs, &contenders, &workers, &hardware, LEVEL);
        (forecasts::forecast_blocks(&rows, &workload, hardware == Hardware::default(), &named), "forecast.csv")
    } else {
        let messages = messages(arguments, console)?;
        if let Some(results) = measured.as_ref().filter(|_| !arguments.no_check) {
            let predictions = rank_forecasts::rank_predictions(results, &contenders, messages)?;
            show(&rank_forecasts::rank_prediction_blocks(&predictions))?;
        }
        let usual = [Settings::default().strategy];
        let strategies = if named.is_empty() { &usual } else { &named[..] };
        let (rules, ranks, threads) = (&rules, &nodes, &workers);
        let plan = RankPlan { rules, strategies, ranks, threads, messages, hardware };
        let pixels = f64::from(spec.width) * f64::from(spec.height);
        let rows = rank_forecasts::rank_forecast(&plan, &contenders, &costs, pixels);
        (rank_forecasts::rank_forecast_blocks(&rows, &workload, strategies), "ranks-forecast.csv")
    };
    show(&blocks)?;
    for block in &blocks {
        block.save(&arguments.out)?;
    }
    print(&format!("figures and {table} in {}", arguments.out.display()))
}

/// The costs of handing out jobs: those calibrated with the trace explain it better than those of this machine now.
fn overheads(arguments: &Arguments, lab: &Lab, names: &[String], console: &Console) -> Result<Vec<CalibrationRow>> {
    let calibrated = arguments.trace.join("calibration.csv");
    if calibrated.is_file() && arguments.strategies.is_empty() {
        return read_calibration(&calibrated);
    }
    console.note("calibrating: every strategy hands out empty jobs");
    let load = ForeignLoad::begin();
    let rows = calibrate(lab, names, 0..CALIBRATIONS)?;
    if let Some(warning) = load.warning() {
        console.note(&warning);
    }
    Ok(rows)
}

/// The costs of messages from the user's file, or from the folder; none without either.
fn messages(arguments: &Arguments, console: &Console) -> Result<Messages> {
    let own = arguments.trace.join(MESSAGES);
    if let Some(path) = arguments.messages.as_ref().or(own.is_file().then_some(&own)) {
        return Ok(rank_forecasts::messages(&MessageCosts::read(path)?));
    }
    console.note("messages are assumed to cost nothing; --messages sets their costs");
    Ok(Messages::default())
}

/// Parses numbers of workers: `1..4096`, which doubles, or `1,2,768`.
fn parse_workers(field: &'static str, text: &str) -> Result<Vec<usize>> {
    let number = |text: &str| text.trim().parse::<usize>().ok().filter(|workers| (1..=MOST_WORKERS).contains(workers));
    let list = match text.split_once("..") {
        Some((first, last)) => {
            number(first).zip(number(last)).filter(|(first, last)| first <= last).map(|(first, last)| {
                let doubled = std::iter::successors(Some(first), |workers| Some(2 * workers));
                doubled.take_while(|workers| *workers < last).chain([last]).collect()
            })
        }
        None => text.split(',').map(number).collect::<Option<Vec<usize>>>(),
    };
    let sorted = |mut list: Vec<usize>| {
        list.sort_unstable();
        list.dedup();
        list
    };
    list.map(sorted).ok_or_else(|| {
        InputError::new(field, text, "is not a valid range or list")
            .allowed(format!("numbers from 1 to {MOST_WORKERS}, as in 1..64 or 1,2,768"))
            .into()
    })
}

/// The slowest core: slower ones are unrealistic, and take long to replay.
const SLOWEST: f64 = 0.01;
/// Simulations of more workers are unrealistic, and take long.
const MOST_WORKERS: usize = 1 << 16;

fn hardware(arguments: &Arguments) -> Result<Hardware> {
    let speed = |field: &str, text: &str, value: Option<f64>| {
        value.filter(|speed| (SLOWEST..=1.0).contains(speed)).ok_or_else(|| {
            let error = InputError::new(field, text, "has no valid speed");
            Error::from(error.allowed(format!("a speed from {SLOWEST} to 1, where 1 is a core like this one")))
        })
    };
    Ok(match (&arguments.slow_core, &arguments.efficiency_cores) {
        (Some(slow), _) => Hardware::OneSlow(speed("slow-core", &slow.to_string(), Some(*slow))?),
        (None, Some(text)) => {
            let (performance, efficient) = text.split_once(':').unwrap_or((text, ""));
            let unreadable =
                || InputError::new("efficiency-cores", text, "cannot be read").allowed("N:SPEED, as in 8:0.5");
            let performance = performance.parse().map_err(|_| unreadable())?;
            Hardware::Mixed { performance, efficient: speed("efficiency-cores", text, efficient.parse().ok())? }
        }
        (None, None) => Hardware::Identical,
    })
}

/// The differences from cores that are all like this one.
fn hardware_in_words(arguments: &Arguments) -> String {
    let parts = [
        arguments.slow_core.map(|speed| format!(", one core of speed {speed}")),
        arguments.efficiency_cores.as_ref().map(|cores| format!(", fast cores and the others' speed {cores}")),
    ];
    parts.into_iter().flatten().collect()
}

/// Estimated seconds of all rounds of predictions; there are at least one and at most five.
const CHECK_S: f64 = 30.0;
/// Estimated seconds of a round above which this machine is not predicted.
const MOST_CHECK_S: f64 = 120.0;

/// Runs the trace's own workload on 1, 2, 4 ... and all processors of this machine. Each round begins with a serial run
/// for the job costs. The doubts are about the times of all these runs.
fn predict_live(
    lab: &Lab,
    trace: &TraceFile,
    contenders: &[Contender],
    console: &Console,
) -> Result<(Predicted, TimingConcerns)> {
    let processors = available_threads();
    let base = &trace.header.settings;
    let work_s: f64 = trace.costs_s().iter().sum();
    let doubled =
        std::iter::successors(Some(1), |threads| Some(2 * threads)).take_while(|threads| *threads < processors);
    let counts: Vec<usize> = doubled.chain([processors]).collect();
    let mut schedules = Vec::new();
    for contender in contenders.iter().filter(|contender| contender.name != "serial") {
        let threads = if contender.has_a_thread_per_job() { &[1][..] } else { &counts };
        for &threads in threads {
            let settings = Settings { strategy: contender.name.clone(), threads, ..base.clone() };
            match lab.prepare(settings) {
                Ok(setup) => schedules.push(setup),
                Err(error) => console.note(&format!("{} is not tried on this machine: {error}", contender.name)),
            }
        }
    }
    let used = |setup: &Setup| setup.threads().min(processors) as f64;
    let round_s: f64 = schedules.iter().map(|setup| work_s / used(setup)).sum::<f64>() + work_s;
    if round_s > MOST_CHECK_S {
        console.note(&format!(
            "this machine is not predicted: trying all strategies on the jobs of the trace would take {round_s:.0} s"
        ));
        return Ok((Predicted::of(&[], contenders, processors), TimingConcerns::default()));
    }
    let rounds = (CHECK_S / round_s).clamp(1.0, 5.0) as u64;
    let (mut runs, mut doubts) = (Vec::new(), TimingConcerns::default());
    console.begin("predicting this machine", rounds * schedules.len() as u64);
    for round in 0..rounds {
        let serial = lab.prepare(Settings { strategy: "serial".to_string(), threads: 1, ..base.clone() })?;
        let alone = serial.run(None)?;
        doubts.add(&alone.warned());
        let costs = TraceFile::new(&serial, &alone).costs_s();
        for (index, setup) in schedules.iter().enumerate() {
            let settings = setup.settings();
            let outcome = setup.run(None)?;
            doubts.add(&outcome.warned());
            let inflation = forecasts::inflation(outcome.cpu_s(), alone.cpu_s());
            let own = TraceFile::new(setup, &outcome).costs_s();
            let observed = Observed {
                inflation,
                decomposition: settings.decomposition.clone(),
                strategy: settings.strategy.clone(),
                workers: setup.threads(),
                repetition: round as u32,
                makespan_s: outcome.makespan_s,
                busy: (setup.threads() <= processors).then(|| own.iter().sum::<f64>() / costs.iter().sum::<f64>()),
            };
            runs.push((observed, costs.clone()));
            console.advance(round * schedules.len() as u64 + index as u64 + 1);
        }
    }
    console.end();
    Ok((Predicted::of(&runs, contenders, processors), doubts))
}

fn show(blocks: &[Block]) -> Result<()> {
    for block in blocks {
        match block {
            Block::Finding(text) | Block::Notice(text) => print(&format!("{text}\n"))?,
            Block::Table { table, .. } => {
                let heads = table.heads().map(str::to_string).collect();
                print(&format!("{}\n{}", table.title, aligned(heads, table.rows(), true)))?;
            }
            Block::Answer { .. } | Block::Figure { .. } | Block::Picture { .. } => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workers_are_doubled_or_listed() {
        assert_eq!(parse_workers("workers", "1..10").unwrap(), [1, 2, 4, 8, 10]);
        assert_eq!(parse_workers("workers", "3..3").unwrap(), [3]);
        assert_eq!(parse_workers("workers", "1, 2,768").unwrap(), [1, 2, 768]);
        for wrong in ["", "0", "4..2", "1..", "x", "1,,2", "1..99999999"] {
            assert!(parse_workers("workers", wrong).is_err(), "{wrong}");
        }
    }
}
