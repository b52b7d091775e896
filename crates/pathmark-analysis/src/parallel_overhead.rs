//! Parallel overhead: the workers' time beyond the work of the serial run, divided by its cause.
//!
//! p workers are occupied for p (T + M) seconds: the makespan T, and then the merge M, in which one thread works and
//! the others wait. The overhead of a parallel run is that time minus the time of the serial run (A. Grama and others,
//! "Introduction to Parallel Computing", 2003, 5.1). All terms are in seconds of one worker:
//!
//! p (T + M) = work + inflation + starting + between jobs + tail + merge
//!
//! * *work*: seconds inside jobs of the serial run.
//! * *inflation*: seconds inside jobs of this run minus the work. It is negative if the jobs took less time.
//! * *starting*: from handing over the jobs to each worker's first job.
//! * *between jobs*: from a job's end to the same worker's next job.
//! * *tail*: from each worker's last job to T; all of T for a worker without a job.
//! * *merge*: p M.
//!
//! Inflation is overhead and the other terms are idleness in the sense of N. Tallent and J. Mellor-Crummey ("Effective
//! performance measurement and analysis of multithreaded applications", `PPoPP` 2009). Work over the seconds inside
//! jobs is the computation scalability of the POP model, and the tail is its load balance (M. Wagner and others, "A
//! structured approach to performance analysis", 2017).
//!
//! If p workers share fewer processors P, seconds inside jobs include waiting for a processor. Then P replaces p, the
//! CPU time replaces the seconds inside jobs, and the processors' idle time is one term, because no clock divides it.

use serde::Serialize;

/// A use of the workers' time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Inside jobs, as long as the serial run was.
    Work,
    /// Inside jobs, longer than the serial run was.
    Inflation,
    /// Before each worker's first job.
    Starting,
    /// Between two jobs of a worker; before its first job too, if [`Run::starting_s`] is unknown.
    Between,
    /// After each worker's last job.
    Tail,
    /// While one thread merges the pieces.
    Merge,
    /// Idle processors that more workers share.
    Idle,
}

impl Part {
    /// All parts, in the order of a run.
    pub const ALL: [Self; 7] =
        [Self::Work, Self::Inflation, Self::Starting, Self::Between, Self::Tail, Self::Merge, Self::Idle];
}

/// The measured times of a run, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Run {
    pub workers: usize,
    /// Processors of the machine.
    pub processors: usize,
    /// From handing over the jobs until all were done.
    pub makespan_s: f64,
    /// From then on until the pieces were merged.
    pub merge_s: f64,
    /// Inside jobs, over all workers.
    pub busy_s: f64,
    /// Before the first job and between jobs, over all workers that had one.
    pub gap_s: f64,
    /// The part of the gaps before the first job, if it is known.
    pub starting_s: Option<f64>,
    /// CPU time during the makespan, if the system reports it.
    pub cpu_s: Option<f64>,
}

/// Differences of times may be below 0 by this share of the workers' time, by rounding.
const SLACK: f64 = 1e-6;
/// The same for CPU times: the system may count them in ticks of this length, over another period than the clock.
const CPU_SLACK: f64 = 0.02;
const CPU_TICK_S: f64 = 0.01;

/// The parts of a run's time, which add up to the whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decomposition {
    /// Seconds of all workers, or of all processors if they are fewer.
    pub whole_s: f64,
    /// Seconds of each part that is known, in the order of [`Part::ALL`].
    pub parts: Vec<(Part, f64)>,
}

/// Decomposes a run by the seconds inside jobs of its serial run.
///
/// `None` for times that contradict each other (more seconds in jobs and gaps than the workers had), for values that
/// are negative or not finite, and for workers that share processors without a CPU time.
pub fn decompose(run: &Run, serial_busy_s: f64) -> Option<Decomposition> {
    let Run { workers, processors, makespan_s, merge_s, busy_s, gap_s, starting_s, cpu_s } = *run;
    let slots = workers.min(processors) as f64;
    let (capacity_s, merge_s) = (slots * makespan_s, slots * merge_s);
    let (used_s, idle) = if workers > processors {
        let cpu_s = cpu_s?;
        (cpu_s, vec![(Part::Idle, capacity_s - cpu_s)])
    } else {
        let gaps = match starting_s {
            Some(starting_s) => vec![(Part::Starting, starting_s), (Part::Between, gap_s - starting_s)],
            None => vec![(Part::Between, gap_s)],
        };
        (busy_s, [gaps, vec![(Part::Tail, capacity_s - busy_s - gap_s)]].concat())
    };
    let slack_s = if workers > processors { CPU_SLACK * capacity_s + CPU_TICK_S } else { SLACK * capacity_s };
    let is_possible = capacity_s > 0.0
        && [capacity_s, merge_s, used_s, serial_busy_s].iter().all(|seconds| *seconds >= 0.0 && seconds.is_finite())
        && idle.iter().all(|(_, seconds)| *seconds >= -slack_s);
    let work = [(Part::Work, serial_busy_s), (Part::Inflation, used_s - serial_busy_s)];
    let mut parts: Vec<(Part, f64)> = work.into_iter().chain(idle).chain([(Part::Merge, merge_s)]).collect();
    parts.sort_by_key(|(part, _)| *part);
    is_possible.then_some(Decomposition { whole_s: capacity_s + merge_s, parts })
}

impl Decomposition {
    /// The share of the whole that a part has; `None` if the part is unknown.
    pub fn share(&self, part: Part) -> Option<f64> {
        self.parts.iter().find(|(own, _)| *own == part).map(|(_, seconds)| seconds / self.whole_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balance::{Span, of_spans};
    use Part::{Between, Idle, Inflation, Merge, Starting, Tail, Work};

    /// The decomposition of a traced run, whose jobs took `serial_s` in the serial run.
    fn traced(spans: &[Span], makespan_s: f64, workers: usize, merge_s: f64, serial_s: f64) -> Decomposition {
        let balance = of_spans(spans.iter().copied(), makespan_s, workers).unwrap();
        let first = |worker: usize| {
            let own = spans.iter().filter(|span| span.0 == worker).map(|span| span.1);
            own.reduce(f64::min).unwrap_or(0.0)
        };
        let run = Run {
            workers,
            processors: workers,
            makespan_s,
            merge_s,
            busy_s: balance.busy_s(),
            gap_s: balance.gap_s(),
            starting_s: Some((0..workers).map(first).sum()),
            cpu_s: None,
        };
        let found = decompose(&run, serial_s).unwrap();
        assert_complete(&found);
        found
    }

    fn assert_complete(found: &Decomposition) {
        let sum: f64 = found.parts.iter().map(|(_, seconds)| seconds).sum();
        assert!((sum - found.whole_s).abs() <= 1e-12 * found.whole_s, "{found:?}");
    }

    /// Two workers and jobs of 3, 1 and 2 s, dealt as {3, 2} and {1}: the second worker waits for 4 s of 10.
    #[test]
    fn a_tail_is_the_wait_for_the_longest_share() {
        let found = traced(&[(0, 0.0, 3.0), (0, 3.0, 5.0), (1, 0.0, 1.0)], 5.0, 2, 0.0, 6.0);
        let expected = [(Work, 6.0), (Inflation, 0.0), (Starting, 0.0), (Between, 0.0), (Tail, 4.0), (Merge, 0.0)];
        assert_eq!((found.whole_s, &found.parts[..]), (10.0, &expected[..]));
        assert_eq!((found.share(Tail), found.share(Work), found.share(Idle)), (Some(0.4), Some(0.6), None));
    }

    /// The second worker begins half a second late, pauses for a quarter, and the merge takes an eighth.
    #[test]
    fn each_loss_is_found_alone_and_beside_the_others() {
        let late = traced(&[(0, 0.0, 2.0), (1, 0.5, 2.0)], 2.0, 2, 0.0, 3.5);
        assert_eq!((late.share(Starting), late.share(Between), late.share(Tail)), (Some(0.125), Some(0.0), Some(0.0)));
        let gap = traced(&[(0, 0.0, 2.0), (1, 0.0, 1.0), (1, 1.25, 2.0)], 2.0, 2, 0.0, 3.75);
        assert_eq!((gap.share(Starting), gap.share(Between)), (Some(0.0), Some(0.0625)));
        let all = traced(&[(0, 0.0, 1.5), (1, 0.5, 1.0), (1, 1.25, 2.0)], 2.0, 2, 0.125, 2.5);
        let expected = [(Work, 2.5), (Inflation, 0.25), (Starting, 0.5), (Between, 0.25), (Tail, 0.5), (Merge, 0.25)];
        assert_eq!((all.whole_s, &all.parts[..]), (4.25, &expected[..]));
    }

    /// Every job takes a tenth longer beside another one than alone.
    #[test]
    fn inflated_work_is_no_idleness() {
        let found = traced(&[(0, 0.0, 1.1), (1, 0.0, 1.1)], 1.1, 2, 0.0, 2.0);
        let [work, inflation, tail] = [Work, Inflation, Tail].map(|part| found.share(part).unwrap());
        assert!((inflation / work - 0.1).abs() < 1e-12 && tail.abs() < 1e-12, "{found:?}");
        let faster = traced(&[(0, 0.0, 0.5), (1, 0.0, 0.5)], 0.5, 2, 0.0, 2.0);
        assert_eq!(faster.share(Inflation), Some(-1.0));
    }

    #[test]
    fn a_worker_without_a_job_is_all_tail() {
        let alone = Run { workers: 4, processors: 4, makespan_s: 1.0, busy_s: 1.0, ..Run::default() };
        assert_eq!(decompose(&alone, 1.0).unwrap().share(Tail), Some(0.75));
    }

    /// Eight threads on two processors, of which a quarter is idle: the clock says 7.5 s inside jobs.
    #[test]
    fn workers_that_share_processors_are_counted_by_their_cpu_time() {
        let run = Run {
            workers: 8,
            processors: 2,
            makespan_s: 1.0,
            merge_s: 0.25,
            busy_s: 7.5,
            gap_s: 0.5,
            starting_s: Some(0.5),
            cpu_s: Some(1.5),
        };
        let found = decompose(&run, 1.25).unwrap();
        assert_complete(&found);
        assert_eq!(found.parts, [(Work, 1.25), (Inflation, 0.25), (Merge, 0.5), (Idle, 0.5)]);
        assert_eq!(decompose(&Run { cpu_s: None, ..run }, 1.25), None);
    }

    #[test]
    fn a_start_that_nobody_noted_is_a_gap() {
        let run = Run { workers: 2, processors: 2, makespan_s: 1.0, busy_s: 1.5, gap_s: 0.25, ..Run::default() };
        let found = decompose(&run, 1.5).unwrap();
        assert_complete(&found);
        assert_eq!((found.share(Starting), found.share(Between)), (None, Some(0.125)));
    }

    #[test]
    fn contradicting_times_have_no_answer() {
        let run = Run { workers: 2, processors: 2, makespan_s: 1.0, busy_s: 1.5, gap_s: 0.25, ..Run::default() };
        for wrong in [
            Run { workers: 0, ..run },
            Run { makespan_s: 0.0, ..run },
            Run { makespan_s: f64::NAN, ..run },
            Run { busy_s: 2.5, ..run },
            Run { gap_s: 0.75, ..run },
            Run { starting_s: Some(0.5), ..run },
            Run { merge_s: -1.0, ..run },
            Run { merge_s: f64::INFINITY, ..run },
        ] {
            assert_eq!(decompose(&wrong, 1.5), None, "{wrong:?}");
        }
        assert_eq!(decompose(&run, f64::NAN), None);
    }
}
