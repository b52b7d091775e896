//! The table of all figures; each figure has a file of its own beside this one.
//!
//! To add a figure: write its file with a function from results to blocks, and add its `mod` and its line below. An
//! experiment names its figures, and may give each options in a table `[figure.NAME]`, which the figure's own type
//! reads.

mod acceleration;
mod baselines;
mod bias;
mod bounces;
mod clamp_bias;
mod clock;
mod contact_sheet;
mod cost_map;
mod effect_steps;
mod effects;
mod equal_time;
mod error_against_time;
mod estimators;
mod forecast;
mod gallery;
mod generators;
mod granularity;
mod kernels;
mod losses;
mod message_costs;
mod mistakes;
mod openmp;
pub(crate) mod options;
mod outputs;
mod oversubscription;
mod pairs;
mod precision;
mod price_list;
mod ranks_forecast;
mod rmse_against_spp;
mod rmse_against_time;
mod roughness;
mod roulette;
mod scaling_laws;
mod scene_accuracy;
mod schedules;
mod self_test;
mod speedup;
mod time_against_spp;
mod timelines;
mod weak_scaling;

pub(super) use equal_time::Pictures;

use super::block::Block;
use super::results::Results;
use crate::error::{InputError, Result};
use crate::experiment::Definition;
use options::{NoOptions, Yardstick};

/// An entry of the table of figures.
pub struct FigureEntry {
    /// Its name in experiment files.
    pub name: &'static str,
    /// Its subject, in a line.
    pub about: &'static str,
    make: fn(&Results) -> Result<Vec<Block>>,
    /// Whether it compares with serial runs.
    of_serial: bool,
    /// Refuses options that the figure does not have.
    check: fn(&Definition, &str) -> Result<()>,
}

macro_rules! entries {
    ($($module:ident, $name:literal, $options:ty, $(needs $baseline:ident,)? $about:literal;)*) => {
        &[$(FigureEntry {
            name: $name,
            about: $about,
            make: $module::blocks,
            of_serial: !<[&str]>::is_empty(&[$(stringify!($baseline))?]),
            check: options::check::<$options>,
        }),*]
    };
}

/// The figures, in the order of lists: module, name, type of its options, whether it needs serial runs to compare with,
/// and its subject.
pub const FIGURES: &[FigureEntry] = entries! {
    contact_sheet, "contact-sheet", NoOptions, "renders at growing spp beside the reference, with maps of their error";
    rmse_against_spp, "rmse-against-spp", rmse_against_spp::Options, "error against samples per pixel, with the fitted slope";
    rmse_against_time, "rmse-against-time", NoOptions, "error against seconds, a line per schedule";
    error_against_time, "error-against-time", NoOptions, "error against seconds, a line per estimator and sampler";
    price_list, "price-list", NoOptions, "seconds to each accuracy, and predictions of later points from earlier ones";
    pairs, "pairs", NoOptions, "every two estimators and samplers against each other at equal error and at equal time";
    equal_time, "equal-time", NoOptions, "images of each estimator and sampler after the same time";
    estimators, "estimators", NoOptions, "speed to the same error relative to the first estimator, by scene";
    roulette, "roulette", Yardstick, "efficiency of each Russian roulette rule";
    bounces, "bounces", NoOptions, "light by number of bounces, and lengths of paths";
    bias, "bias", bias::Options, "light, noise and doubtful pixels by epsilon, filter, clamp or variants of a scene";
    clamp_bias, "clamp-bias", clamp_bias::Options, "light lost by clamping each subpixel before averaging, by samples per pixel";
    time_against_spp, "time-against-spp", NoOptions, "seconds against samples per pixel, with the linear fit";
    speedup, "speedup", NoOptions, needs serial, "speedup, efficiency and Karp-Flatt serial fraction against threads";
    baselines, "baselines", NoOptions, "speedups of one schedule against several baselines, and those above the number of workers";
    scaling_laws, "scaling-laws", NoOptions, needs serial, "Amdahl's law and the Universal Scalability Law fitted to the speedups";
    weak_scaling, "weak-scaling", NoOptions, needs serial, "scaled speedup against threads, with Gustafson's law";
    clock, "clock", NoOptions, "speedups by CPU time, as clock() counts it, beside those by wall time";
    granularity, "granularity", granularity::Options, "efficiency against the size of a job, METG(50 %), overhead of a job";
    oversubscription, "oversubscription", oversubscription::Options, "time against threads and pieces beyond the number of processors";
    timelines, "timelines", NoOptions, "jobs of each worker over time, and the parts of workers x makespan";
    cost_map, "cost-map", NoOptions, "seconds of each tile over the image";
    generators, "generators", generators::Options, "time by random number generator and threads, with context switches";
    mistakes, "mistakes", mistakes::Options, "errors on purpose beside the right way: time, and error of the image's mean";
    outputs, "outputs", NoOptions, "time and memory of each output, by which pieces get into the film";
    roughness, "roughness", roughness::Options, "a rough material with directions by the cosine and by its facets: images, variance, time";
    openmp, "openmp", Yardstick, "time of each strategy as a multiple of OpenMP's dynamic schedule";
    self_test, "self-test", NoOptions, "how often a cell that is measured twice appears to differ from itself";
    forecast, "forecast", forecast::Options, "simulated speedup on other machines, and how well this one is predicted";
    ranks_forecast, "ranks-forecast", ranks_forecast::Options, needs serial, "simulated speedup of several processes, and how well those here are predicted";
    message_costs, "message-costs", NoOptions, "cost of messages between two processes, and the wait for a rank that computes";
    gallery, "gallery", NoOptions, "a picture of every scene, and the effects that it calls for";
    scene_accuracy, "scene-accuracy", scene_accuracy::Options, "error, path length and price of accuracy by scene";
    effects, "effects", effects::Options, "cost of an effect: absent, compiled in but unused, used";
    kernels, "kernels", NoOptions, "samples per second of lanes over those of the scalar kernel, by instruction set and precision";
    precision, "precision", NoOptions, "time, error, light, escapes and invalid samples of single precision beside double";
    acceleration, "acceleration", NoOptions, "time per ray against primitives and gain against spp, by accelerator";
    losses, "losses", NoOptions, needs serial, "why a schedule is not as many times as fast as it has workers: work inflation, idle time, merge";
    schedules, "schedules", NoOptions, "time, load imbalance and context switches of each schedule";
};

fn find(name: &str) -> Option<&'static FigureEntry> {
    FIGURES.iter().find(|entry| entry.name == name)
}

/// Refuses a definition that names an unknown figure or gives one unknown options, so that a sweep does not run in
/// vain.
pub fn check_figures(definition: &Definition) -> Result<()> {
    if let Some(name) = definition.figures.iter().find(|name| find(name).is_none()) {
        let names: Vec<&str> = FIGURES.iter().map(|entry| entry.name).collect();
        let at = crate::input::locate(&definition.text, "figures", name);
        return Err(InputError::new("figures", name, "there is no figure of that name")
            .allowed(names.join(", "))
            .in_file(&definition.file, at)
            .into());
    }
    if let Some(name) = definition.figure.keys().find(|name| !definition.figures.contains(name)) {
        let at = place(&definition.text, name);
        return Err(InputError::new("figure", name, "has parameters, but `figures` does not list it")
            .allowed(definition.figures.join(", "))
            .in_file(&definition.file, at)
            .into());
    }
    let mut listed = FIGURES.iter().filter(|entry| definition.figure.contains_key(entry.name));
    listed.try_for_each(|entry| (entry.check)(definition, entry.name))
}

/// The position of the table's head: line and column.
fn place(text: &str, name: &str) -> Option<(usize, usize)> {
    let is_head = |line: &str| line.trim_start_matches('[').starts_with(&format!("figure.{name}"));
    text.lines().position(|line| line.starts_with('[') && is_head(line)).map(|index| (index + 1, 1))
}

/// The first of the experiment's figures that compares with serial runs.
pub fn figure_of_serial(definition: &Definition) -> Option<&'static str> {
    let figures = definition.figures.iter().filter_map(|name| find(name));
    figures.into_iter().find(|entry| entry.of_serial).map(|entry| entry.name)
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    check_figures(&results.definition)?;
    let mut blocks = Vec::new();
    for entry in results.definition.figures.iter().filter_map(|name| find(name)) {
        blocks.extend((entry.make)(results)?);
    }
    Ok(blocks)
}
