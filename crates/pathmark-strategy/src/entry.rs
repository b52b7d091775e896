//! Entries of the strategy table.

use crate::{
    Blueprint, ChunkRule, Config, Deal, Discipline, Handout, Job, LearnedRule, Strategy, StrategyError, dealt,
    learning, self_scheduling,
};

/// A strategy's entry in the table: its name, its promises, and the function that makes it.
///
/// [`Entry::new`] and [`Entry::chunks`] set the fields that most strategies share; set the other fields by name:
///
/// ```
/// use pathmark_strategy::{Blueprint, Discipline, Entry, Job, StrategyError, Workers, contract, each_run};
///
/// fn run(_: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
///     (0..jobs).for_each(|index| job(index));
///     Ok(())
/// }
///
/// const ENTRY: Entry = Entry {
///     workers: Workers::Caller,
///     ..Entry::new("mine", "all jobs on the calling thread", Discipline::InOrder, |blueprint| each_run(blueprint, run))
/// };
/// contract::verify(&ENTRY).expect("it keeps the contract");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name on the command line and in records: lower-case words with `-` between them.
    pub name: &'static str,
    /// A description in one line.
    pub about: &'static str,
    /// Where its jobs run.
    pub workers: Workers,
    /// Who starts its threads.
    pub threads: Threads,
    /// When a free worker learns of jobs that wait at another worker.
    pub sharing: Sharing,
    /// How it hands out jobs if the user sets no parameter.
    pub discipline: Discipline,
    /// The parameter that a user may set, if there is one.
    pub parameter: Option<Parameter>,
    /// Makes a strategy that is ready to run; pools start their threads here.
    pub make: fn(&Blueprint) -> Result<Box<dyn Strategy>, StrategyError>,
}

/// Calls the job once for each index below the number of jobs, as [`Strategy::run`] does.
pub type Run = fn(&Blueprint, usize, &Job) -> Result<(), StrategyError>;

/// Makes a strategy that keeps nothing between its runs, as most do that start their threads in each.
pub fn each_run(blueprint: &Blueprint, run: Run) -> Result<Box<dyn Strategy>, StrategyError> {
    struct EachRun(Blueprint, Run);

    impl Strategy for EachRun {
        fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
            (self.1)(&self.0, jobs, &job)
        }
    }

    Ok(Box::new(EachRun(blueprint.clone(), run)))
}

/// A parameter of a strategy that a user may set.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// The allowed values, for the error that refuses any other value.
    pub allowed: &'static str,
    /// Parses the parameter into a discipline; `None` if the text is not a valid parameter.
    pub read: fn(&str) -> Option<Discipline>,
}

impl Entry {
    /// Returns the entry of a strategy that runs its jobs on [`Config::threads`] workers from [`Config::spawner`],
    /// shares work at once and has no parameter.
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

    /// Returns the entry of a self-scheduling strategy: a free worker takes the next chunk of jobs, and `size` sets its
    /// size. Threads start in each run.
    ///
    /// ```
    /// use pathmark_strategy::{Entry, contract};
    ///
    /// let halves = Entry::chunks("halves", "half of what is left", |handout| (handout.jobs - handout.start) / 2);
    /// contract::verify(&halves).expect("whatever the sizes, the contract holds");
    /// ```
    pub const fn chunks(name: &'static str, about: &'static str, size: fn(&Handout) -> usize) -> Self {
        Self::new(name, about, Discipline::Chunks(ChunkRule { size, parameter: 1 }), |blueprint| {
            each_run(blueprint, self_scheduling::run)
        })
    }

    /// Returns the entry of a self-scheduling strategy whose workers read the clock. Chunk sizes depend on the measured
    /// speeds. Threads start in each run.
    pub const fn learned(name: &'static str, about: &'static str, rule: LearnedRule) -> Self {
        Self::new(name, about, Discipline::Learned(rule), |blueprint| each_run(blueprint, learning::run))
    }

    /// Returns the entry of a strategy whose workers know their jobs before they start. Threads start in each run.
    pub const fn dealt(name: &'static str, about: &'static str, deal: Deal) -> Self {
        Self::new(name, about, Discipline::Dealt(deal), |blueprint| each_run(blueprint, dealt::run))
    }

    /// Returns the discipline for the text after the colon in `--strategy name:parameter`. An invalid parameter is an
    /// error.
    pub fn discipline(&self, parameter: Option<&str>) -> Result<Discipline, StrategyError> {
        let Some(value) = parameter else { return Ok(self.discipline) };
        self.parameter.and_then(|known| (known.read)(value)).ok_or_else(|| StrategyError::Parameter {
            strategy: self.name,
            value: value.to_owned(),
            allowed: self.parameter.map_or("none", |known| known.allowed),
        })
    }

    /// Makes a strategy that is ready to run.
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
    /// On [`Config::threads`] threads.
    Threads,
}

impl Workers {
    /// Returns how many of `jobs` jobs can run at the same time when `threads` threads are requested.
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
    /// [`Config::spawner`] starts all of them.
    Spawner,
    /// The library behind the strategy starts some of them itself, and perhaps more that run no jobs. If the system
    /// refuses one of these, the library decides what happens; [`library::start`](crate::library::start) turns
    /// detectable failures into an error.
    Library,
}

/// When a free worker learns of jobs that wait at another worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// At once. As many jobs as there are workers can therefore wait for each other.
    AtOnce,
    /// When some time has passed and the other worker is between two of its jobs. A job that waits for another job may
    /// wait forever.
    Heartbeat,
}
