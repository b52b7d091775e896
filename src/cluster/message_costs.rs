//! What MPI costs between the processes that a launcher started: `mpiexec -n 2 pathmark message-costs`.
//!
//! Rank 1 asks, rank 0 answers, and the others wait. How long a fetch-and-op takes depends on the library: some complete it without rank 0, others
//! only while rank 0 is inside a call of MPI. So it is timed while rank 0 waits, while it computes and looks after MPI now and then, as it does
//! when it renders, and while it computes without a look.

use super::hand_out::LOOK;
use super::{Cluster, failed};
use crate::analysis::quantile::{median, median_interval};
use crate::error::{InputError, Result};
use pathmark_mpi::Counter;
use serde::Serialize;
use std::hint::spin_loop;
use std::time::{Duration, Instant};

/// Repetitions of what takes microseconds, and of what may take as long as a computation.
const MANY: usize = 2000;
const FEW: usize = 20;
/// How long rank 0 computes without a look after MPI.
const COMPUTATION: Duration = Duration::from_millis(20);
/// Words that each rank gives to a gather: those of a film of 512x384 pixels, seven words a pixel, shared by two ranks.
const GATHERED: usize = 7 * 512 * 384 / 2;
const LEVEL: f64 = 0.95;

/// What one operation cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MessageCost {
    /// The operation.
    pub operation: &'static str,
    /// What rank 0 does meanwhile.
    pub rank_0: &'static str,
    /// How often it was timed.
    pub repetitions: u64,
    /// Median seconds.
    pub median_s: f64,
    /// The distribution-free 95 % interval of the median.
    pub low_s: f64,
    /// See `low_s`.
    pub high_s: f64,
}

impl Cluster {
    /// Times the operations; rank 0 has the costs, with name and version of the library.
    pub fn message_costs(self) -> Result<Option<(Vec<MessageCost>, String)>> {
        if self.size() < 2 {
            let error = InputError::new("ranks", self.size().to_string(), "messages need two processes");
            return Err(error.allowed("mpiexec -n 2 pathmark message-costs").into());
        }
        let mut costs = vec![self.told("a request and its answer", "waits", &self.requests()?)?];
        for (rank_0, pause, repetitions) in [
            ("waits", None, MANY),
            ("computes, and looks every ms", Some(LOOK), MANY),
            ("computes for 20 ms at a time", Some(COMPUTATION), FEW),
        ] {
            costs.push(self.told("a fetch-and-op", rank_0, &self.fetches(pause, repetitions)?)?);
        }
        costs.push(self.told("a gather of 5 MB from each rank", "gathers", &self.gathers()?)?);
        let (is_first, library) = (self.is_first(), self.world.version().to_string());
        self.world.end().map_err(failed)?;
        Ok(is_first.then_some((costs, library)))
    }

    /// Seconds of requests that rank 1 made.
    fn requests(&self) -> Result<Vec<f64>> {
        let world = &self.world;
        let mut word = [0];
        world.barrier().map_err(failed)?;
        match world.rank() {
            0 => {
                for _ in 0..MANY {
                    world.receive(Some(1), &mut word).map_err(failed)?;
                    world.send(1, &word).map_err(failed)?;
                }
                Ok(Vec::new())
            }
            1 => timed(MANY, || {
                world.send(0, &[1]).map_err(failed)?;
                world.receive(Some(0), &mut word).map_err(failed)
            }),
            _ => Ok(Vec::new()),
        }
    }

    /// Seconds of fetch-and-ops that rank 1 did in the memory of rank 0, which computes for `pause` between two looks after MPI.
    fn fetches(&self, pause: Option<Duration>, repetitions: usize) -> Result<Vec<f64>> {
        let world = &self.world;
        let mut counter = Counter::new(world).map_err(failed)?;
        world.barrier().map_err(failed)?;
        let seconds = match world.rank() {
            0 => {
                if let Some(pause) = pause {
                    compute(pause);
                    while !world.has_message().map_err(failed)? {
                        compute(pause);
                    }
                }
                world.receive(Some(1), &mut [0]).map_err(failed)?;
                Vec::new()
            }
            1 => {
                let seconds = timed(repetitions, || counter.next().map(drop).map_err(failed))?;
                world.send(0, &[1]).map_err(failed)?;
                seconds
            }
            _ => Vec::new(),
        };
        world.barrier().map_err(failed)?;
        counter.free().map_err(failed)?;
        Ok(seconds)
    }

    /// Seconds of gathers, as rank 0 saw them.
    fn gathers(&self) -> Result<Vec<f64>> {
        let words = vec![0; GATHERED];
        let seconds = timed(FEW, || {
            self.world.barrier().map_err(failed)?;
            self.world.gather(&words).map(drop).map_err(failed)
        })?;
        Ok(if self.is_first() { seconds } else { Vec::new() })
    }

    /// What the rank that timed an operation tells the others of it.
    fn told(&self, operation: &'static str, rank_0: &'static str, seconds: &[f64]) -> Result<MessageCost> {
        let interval = median_interval(seconds, LEVEL);
        let own = [median(seconds), interval.map(|own| own.low), interval.map(|own| own.high)];
        let words = own.map(|value| value.unwrap_or(f64::NAN).to_bits());
        let all = self.world.all_gather(&[seconds.len() as u64, words[0], words[1], words[2]]).map_err(failed)?;
        let timed = all.chunks_exact(4).find(|rank| rank[0] > 0).unwrap_or(&[0; 4]);
        let [median_s, low_s, high_s] = [1, 2, 3].map(|at| f64::from_bits(timed[at]));
        Ok(MessageCost { operation, rank_0, repetitions: timed[0], median_s, low_s, high_s })
    }
}

/// Uses the processor for so long.
fn compute(time: Duration) {
    let begin = Instant::now();
    while begin.elapsed() < time {
        spin_loop();
    }
}

/// Does something again and again; the seconds of each time.
fn timed(repetitions: usize, mut operation: impl FnMut() -> Result<()>) -> Result<Vec<f64>> {
    let one = |_| {
        let begin = Instant::now();
        operation()?;
        Ok(begin.elapsed().as_secs_f64())
    };
    (0..repetitions).map(one).collect()
}
