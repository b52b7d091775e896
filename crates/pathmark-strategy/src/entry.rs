//! A strategy's line in the table.

use crate::{
    Blueprint, ChunkRule, Config, Deal, Discipline, Handout, LearnedRule, Strategy, StrategyError, dealt, learning,
    self_scheduling,
};

/// A strategy's line in the table: what it is called, what it promises, and how it is made.
///
/// [`Entry::new`] and [`Entry::chunks`] fill in what most strategies have in common; the rest is said by field:
///
/// ```
/// use pathmark_strategy::{Discipline, Entry, Job, Strategy, StrategyError, Workers, contract};
///
/// struct Mine;
///
/// impl Strategy for Mine {
///     fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
///         (0..jobs).for_each(|index| job(index));
///         Ok(())
///     }
/// }
///
/// const ENTRY: Entry = Entry {
///     workers: Workers::Caller,
///     ..Entry::new("mine", "all jobs on the calling thread", Discipline::InOrder, |_| Ok(Box::new(Mine)))
/// };
/// contract::verify(&ENTRY).expect("it keeps the contract");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name on the command line and in records: lower-case words with `-` between them.
    pub name: &'static str,
    /// What it does, in one line.
    pub about: &'static str,
    /// Where its jobs run.
    pub workers: Workers,
    /// Who starts its threads.
    pub threads: Threads,
    /// When a worker that is free finds out about jobs that wait at another one.
    pub sharing: Sharing,
    /// How it hands out jobs if nothing is set.
    pub discipline: Discipline,
    /// What may be set, if anything.
    pub parameter: Option<Parameter>,
    /// Makes one that is ready to run; pools start their threads here.
    pub make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>,
}

/// What a user may set of a strategy.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// What it can be, for the error that refuses anything else.
    pub allowed: &'static str,
    /// How the strategy then hands out jobs; `None` if the text means nothing to it.
    pub read: fn(&str) -> Option<Discipline>,
}

impl Entry {
    /// A strategy that runs its jobs on [`Config::threads`] workers from [`Config::spawner`], shares work at once and has nothing to set.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        discipline: Discipline,
        make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>,
    ) -> Self {
        Self {
            name,
            about,
            workers: Workers::Threads,
            threads: Threads::Spawner,
            sharing: Sharing::AtOnce,
            discipline,
            parameter: None,
            make,
        }
    }

    /// A self-scheduling strategy: a worker that is free takes the next chunk of jobs, whose size `size` says. Threads start in each run.
    ///
    /// ```
    /// use pathmark_strategy::{Entry, contract};
    ///
    /// let halves = Entry::chunks("halves", "half of what is left", |handout| (handout.jobs - handout.start) / 2);
    /// contract::verify(&halves).expect("whatever the sizes, the contract holds");
    /// ```
    pub const fn chunks(name: &'static str, about: &'static str, size: fn(&Handout) -> usize) -> Self {
        Self::new(name, about, Discipline::Chunks(ChunkRule { size, parameter: 1 }), self_scheduling::make)
    }

    /// A self-scheduling strategy whose workers read the clock and get chunks by how fast they have been. Threads start in each run.
    pub const fn learned(name: &'static str, about: &'static str, rule: LearnedRule) -> Self {
        Self::new(name, about, Discipline::Learned(rule), learning::make)
    }

    /// A strategy whose workers know their jobs before they start. Threads start in each run.
    pub const fn dealt(name: &'static str, about: &'static str, deal: Deal) -> Self {
        Self::new(name, about, Discipline::Dealt(deal), dealt::make)
    }

    /// How it hands out jobs, given what follows the colon in `--strategy name:parameter`; refuses what means nothing to it.
    pub fn discipline(&self, parameter: Option<&str>) -> Result<Discipline, StrategyError> {
        let Some(value) = parameter else { return Ok(self.discipline) };
        self.parameter.and_then(|known| (known.read)(value)).ok_or_else(|| StrategyError::Parameter {
            strategy: self.name,
            value: value.to_owned(),
            allowed: self.parameter.map_or("none", |known| known.allowed),
        })
    }

    /// Makes one that is ready to run.
    pub fn build(&self, config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
        let discipline = self.discipline(config.parameter.as_deref())?;
        let Config { threads, spawner, .. } = config;
        (self.make)(&Blueprint { strategy: self.name, discipline, threads, spawner })
    }
}

/// Where a strategy's jobs run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Workers {
    /// On the thread that calls [`Strategy::run`]; [`Config::threads`] has no meaning.
    Caller,
    /// On a thread for each job; [`Config::threads`] has no meaning.
    PerJob,
    /// On as many threads as [`Config::threads`] says.
    Threads,
}

impl Workers {
    /// How many jobs can run at the same time when `threads` are asked for and there are `jobs`.
    pub fn at_once(self, threads: usize, jobs: usize) -> usize {
        match self {
            Self::Caller => jobs.min(1),
            Self::PerJob => jobs,
            Self::Threads => jobs.min(threads),
        }
    }
}

/// Who starts a strategy's threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    /// [`Config::spawner`], all of them.
    Spawner,
    /// The library behind the strategy starts some of them by its own means, and perhaps more that run no jobs. If the system refuses one of
    /// these, what happens is the library's affair; [`library::start`](crate::library::start) turns what can be known into an error.
    Library,
}

/// When a worker that is free finds out about jobs that wait at another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// At once, so as many jobs as there are workers can wait for each other.
    AtOnce,
    /// When the other one comes between two of its jobs and some time has passed. A job that waits for another one may wait for
    /// ever.
    Heartbeat,
}
