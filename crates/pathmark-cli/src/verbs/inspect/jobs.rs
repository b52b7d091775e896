//! `pathmark inspect jobs FILE`: one run, job by job.

use crate::atomic_file;
use crate::measure::{TraceFile, chrome_trace};
use crate::plot::Figure;
use crate::report::timeline;
use crate::verbs::prelude::*;

/// `pathmark inspect jobs run.csv -o run.svg`, after `pathmark render cornell --trace run.csv`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A file that `render --trace` wrote, or a file in an experiment's folder `traces`
    file: PathBuf,
    /// Output file: .svg or .png for a chart with a lane for each worker, .json for trace events that Perfetto opens
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// More workers have no line of their own.
const MOST_LINES: usize = 16;

pub(super) fn run(arguments: &Arguments, console: &Console) -> Result<()> {
    let write = arguments.output.as_deref().map(|path| Ok::<_, Error>((path, writer(path)?))).transpose()?;
    let mut files = Files::default();
    files.reads("the trace", &arguments.file);
    arguments.output.as_ref().map_or(Ok(()), |path| files.writes("output", path))?;
    let trace = TraceFile::read(&arguments.file)?;
    if let Some(doubt) = trace.doubt() {
        console.note(&doubt);
    }
    let Some(balance) = timeline::balance(&trace) else {
        let problem = "contains invalid worker numbers or times";
        return Err(InputError::new("trace", arguments.file.display().to_string(), problem).into());
    };
    if let Some((path, write)) = write {
        let bytes = write(&trace)?;
        atomic_file::write(path, |file| file.write_all(&bytes))?;
    }
    let capacity_s = balance.makespan_s * balance.workers.len() as f64;
    let percent = |seconds: f64| 100.0 * seconds / capacity_s;
    let by_worker = balance.workers.iter().enumerate().filter(|_| balance.workers.len() <= MOST_LINES);
    let by_worker = by_worker.map(|(worker, own)| {
        let [busy, gaps, tail] = [own.busy_s, own.gap_s, own.tail_s].map(|seconds| seconds * 1e3);
        let jobs = counted(own.jobs, "job");
        format!("\nworker {worker}: {jobs}, busy {busy:.3} ms, gaps {gaps:.3} ms, tail {tail:.3} ms")
    });
    let by_worker: String = by_worker.collect();
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| format!("{value:.3}"));
    print(&format!(
        "{}\n{} on {}, makespan {:.3} ms\nbusy {:.2} %, gaps {:.2} %, tail {:.2} %\nload imbalance {}, gap per job {} µs{by_worker}",
        timeline::name(&trace),
        counted(balance.jobs(), "job"),
        counted(balance.workers.len(), "worker"),
        balance.makespan_s * 1e3,
        percent(balance.busy_s()),
        percent(balance.gap_s()),
        percent(balance.tail_s()),
        number(balance.imbalance()),
        number(balance.overhead_per_job_s().map(|seconds| seconds * 1e6)),
    ))
}

type Writer = fn(&TraceFile) -> Result<Vec<u8>>;

fn writer(path: &Path) -> Result<Writer> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => Ok(|trace| Ok(timeline::chart(trace).svg()?.into_bytes())),
        Some("png") => Ok(|trace| timeline::chart(trace).png()),
        Some("json") => Ok(|trace| {
            let name = |job: usize| format!("job {job}");
            Ok(chrome_trace(&trace.trace(), &timeline::name(trace), name).to_string().into_bytes())
        }),
        _ => Err(InputError::new("output", path.display().to_string(), "has an unsupported extension")
            .allowed(".svg, .png, .json")
            .into()),
    }
}
