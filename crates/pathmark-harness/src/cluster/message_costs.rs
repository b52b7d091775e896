//! Costs of MPI between the processes that a launcher started: `mpiexec -n 2 pathmark inspect messages`.
//!
//! Rank 1 asks, rank 0 answers, and the others wait. The duration of a fetch-and-op depends on the library: some
//! complete it without rank 0, others only while rank 0 is inside a call of MPI. It is therefore timed while rank 0
//! waits, while it computes and looks after MPI now and then (as in a render), and while it computes without a look.

use super::{Cluster, failed};
use crate::analysis::quantile::{median, median_interval};
use crate::error::{InputError, Result};
use crate::input::read_text;
use crate::lab::LOOK;
use pathmark_mpi::Counter;
use serde::{Deserialize, Serialize};
use std::hint::spin_loop;
use std::path::Path;
use std::time::{Duration, Instant};

/// Repetitions of an operation of microseconds, and of one that may take as long as a computation.
const MANY: usize = 2000;
const FEW: usize = 20;
/// Time for which rank 0 computes without a look after MPI.
const COMPUTATION: Duration = Duration::from_millis(20);
/// Words that each rank gives to a gather: a film of 512x384 pixels, seven words per pixel, shared by two ranks.
const GATHERED: usize = 7 * 512 * 384 / 2;
const LEVEL: f64 = 0.95;

const REQUEST: &str = "a request and its answer";
const FETCH: &str = "a fetch-and-op";
const GATHER: &str = "a gather of 5 MB from each rank";
const WAITS: &str = "waits";
const LOOKS: &str = "computes, and looks every ms";

/// The costs measured between some ranks, as `inspect messages --json` prints them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MessageCosts {
    pub ranks: usize,
    pub mpi: String,
    pub costs: Vec<MessageCost>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MessageCost {
    pub operation: String,
    pub rank_0: String,
    pub repetitions: u64,
    pub median_s: f64,
    /// The distribution-free 95 % interval of the median.
    pub low_s: f64,
    pub high_s: f64,
}

impl MessageCosts {
    /// Reads the output of `inspect messages --json`.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        serde_json::from_str(&text).map_err(|e| {
            let error = InputError::new("messages", path.display().to_string(), format!("cannot be read: {e}"));
            error.allowed("the output of mpiexec -n 2 pathmark inspect messages --json").into()
        })
    }

    fn median_s(&self, operation: &str, rank_0: Option<&str>) -> f64 {
        let is_it = |cost: &&MessageCost| {
            cost.operation == operation
                && rank_0.is_none_or(|rank_0| cost.rank_0 == rank_0)
                && cost.median_s.is_finite()
        };
        self.costs.iter().find(is_it).map_or(0.0, |cost| cost.median_s)
    }

    pub fn request_s(&self) -> f64 {
        self.median_s(REQUEST, None)
    }

    /// Seconds of a fetch-and-op, while rank 0 waits.
    pub fn fetch_s(&self) -> f64 {
        self.median_s(FETCH, Some(WAITS))
    }

    /// Seconds of one fetch-and-op among many in sequence, while rank 0 renders and looks after MPI every [`LOOK`].
    pub fn fetch_while_rendering_s(&self) -> f64 {
        self.median_s(FETCH, Some(LOOKS))
    }

    pub fn gathered_byte_s(&self) -> f64 {
        let bytes = GATHERED * size_of::<u64>() * self.ranks.saturating_sub(1);
        self.median_s(GATHER, None) / bytes.max(1) as f64
    }
}

impl Cluster {
    /// Times the operations; rank 0 gets the costs, the others `None`.
    pub fn message_costs(self) -> Result<Option<MessageCosts>> {
        if self.size() < 2 {
            let error = InputError::new("ranks", self.size().to_string(), "is too few: messages need two processes");
            return Err(error.allowed("mpiexec -n 2 pathmark inspect messages").into());
        }
        let mut costs = vec![self.told(REQUEST, WAITS, &self.requests()?)?];
        for (rank_0, pause, repetitions) in
            [(WAITS, None, MANY), (LOOKS, Some(LOOK), MANY), ("computes for 20 ms at a time", Some(COMPUTATION), FEW)]
        {
            costs.push(self.told(FETCH, rank_0, &self.fetches(pause, repetitions)?)?);
        }
        costs.push(self.told(GATHER, "gathers", &self.gathers()?)?);
        let told = MessageCosts { ranks: self.size(), mpi: self.world.version().to_string(), costs };
        let is_first = self.is_first();
        self.world.end().map_err(failed)?;
        Ok(is_first.then_some(told))
    }

    /// Seconds of each request by rank 1; empty on other ranks.
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

    /// Seconds of fetch-and-ops by rank 1 in the memory of rank 0, which computes for `pause` between two looks after
    /// MPI.
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
                let seconds = timed(repetitions, || counter.number().map(drop).map_err(failed))?;
                world.send(0, &[1]).map_err(failed)?;
                seconds
            }
            _ => Vec::new(),
        };
        world.barrier().map_err(failed)?;
        counter.free().map_err(failed)?;
        Ok(seconds)
    }

    fn gathers(&self) -> Result<Vec<f64>> {
        let words = vec![0; GATHERED];
        let seconds = timed(FEW, || {
            self.world.barrier().map_err(failed)?;
            self.world.gather(&words).map(drop).map_err(failed)
        })?;
        Ok(if self.is_first() { seconds } else { Vec::new() })
    }

    /// The cost of an operation, sent to all ranks by the rank that timed it.
    fn told(&self, operation: &str, rank_0: &str, seconds: &[f64]) -> Result<MessageCost> {
        let interval = median_interval(seconds, LEVEL);
        let own = [median(seconds), interval.map(|own| own.low), interval.map(|own| own.high)];
        let words = own.map(|value| value.unwrap_or(f64::NAN).to_bits());
        let all = self.world.all_gather(&[seconds.len() as u64, words[0], words[1], words[2]]).map_err(failed)?;
        let timed = all.chunks_exact(4).find(|rank| rank[0] > 0).unwrap_or(&[0; 4]);
        let [median_s, low_s, high_s] = [1, 2, 3].map(|at| f64::from_bits(timed[at]));
        let (operation, rank_0) = (operation.to_string(), rank_0.to_string());
        Ok(MessageCost { operation, rank_0, repetitions: timed[0], median_s, low_s, high_s })
    }
}

fn compute(time: Duration) {
    let begin = Instant::now();
    while begin.elapsed() < time {
        spin_loop();
    }
}

fn timed(repetitions: usize, mut operation: impl FnMut() -> Result<()>) -> Result<Vec<f64>> {
    let one = |_| {
        let begin = Instant::now();
        operation()?;
        Ok(begin.elapsed().as_secs_f64())
    };
    (0..repetitions).map(one).collect()
}
