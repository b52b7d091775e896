//! What a report can show: one figure a file; this file is their table.
//!
//! To add one: write its file with a function from results to blocks, and give it a line in `figures!` below. An experiment names the
//! figures that it wants.

use super::block::Block;
use super::results::Results;
use crate::error::{InputError, Result};
use crate::experiment::Definition;

/// One line of the table of figures.
pub struct FigureEntry {
    /// Its name in experiment files.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    make: fn(&Results) -> Result<Vec<Block>>,
}

macro_rules! figures {
    ($($module:ident, $name:literal, $about:literal;)*) => {
        $(mod $module;)*

        /// The figures, in the order in which they are listed.
        pub const FIGURES: &[FigureEntry] =
            &[$(FigureEntry { name: $name, about: $about, make: $module::blocks }),*];
    };
}

figures! {
    contact_sheet, "contact-sheet", "renders at growing spp beside the reference, with maps of their error";
    rmse_against_spp, "rmse-against-spp", "error against samples per pixel, with the fitted slope";
    rmse_against_time, "rmse-against-time", "what accuracy costs: error against seconds, a line per schedule";
    error_against_time, "error-against-time", "what accuracy costs: error against seconds, a line per estimator and sampler";
    price_list, "price-list", "seconds to each accuracy, and how well a part of the measurements predicts the rest";
    pairs, "pairs", "every two estimators and samplers against each other at equal error and at equal time";
    equal_time, "equal-time", "what each estimator and sampler shows after the same time";
    estimators, "estimators", "times as fast to the same error as the first estimator, by scene";
    roulette, "roulette", "efficiency by when chance ends paths and by what";
    clamp_bias, "clamp-bias", "light lost by clamping each subpixel before averaging, by samples per pixel";
    time_against_spp, "time-against-spp", "seconds against samples per pixel, with the linear fit";
    speedup, "speedup", "speedup, efficiency and Karp-Flatt serial fraction against threads";
    scaling_laws, "scaling-laws", "Amdahl's law and the Universal Scalability Law fitted to the speedups";
    weak_scaling, "weak-scaling", "scaled speedup against threads, with Gustafson's law";
    clock, "clock", "what CPU time, as clock() counts it, would have claimed";
    granularity, "granularity", "efficiency against the size of a job, METG(50 %), overhead of a job";
    oversubscription, "oversubscription", "time against threads and pieces beyond the number of processors";
    timelines, "timelines", "who did what when, and where workers times makespan went";
    cost_map, "cost-map", "seconds of each tile over the image";
    generators, "generators", "time by random number generator and threads, with context switches";
    outputs, "outputs", "time and memory by the way pieces get into the film";
    roughness, "roughness", "a rough material with directions by the cosine and by its facets: images, variance, time";
    openmp, "openmp", "time of each strategy as a multiple of OpenMP's dynamic schedule";
    self_test, "self-test", "how often a cell measured twice seems to differ from itself";
    forecast, "forecast", "simulated speedup on other machines, and how well this one is predicted";
    gallery, "gallery", "what every scene looks like, and what it calls for";
    scene_accuracy, "scene-accuracy", "error, path length and price of accuracy by scene";
    effects, "effects", "what an effect costs: absent, compiled in but unused, used";
    kernels, "kernels", "samples per second of lanes over those of the scalar kernel, by instruction set and precision";
    precision, "precision", "time, error, light, escapes and invalid samples of single precision beside double";
    acceleration, "acceleration", "time per ray against primitives and gain against spp, by accelerator";
    schedules, "schedules", "time, load imbalance and context switches of each schedule";
}

fn find(name: &str) -> Option<&'static FigureEntry> {
    FIGURES.iter().find(|entry| entry.name == name)
}

/// Refuses a definition that names a figure that there is not: better before a sweep than after it.
pub fn check_figures(definition: &Definition) -> Result<()> {
    match definition.figures.iter().find(|name| find(name).is_none()) {
        None => Ok(()),
        Some(name) => {
            let names: Vec<&str> = FIGURES.iter().map(|entry| entry.name).collect();
            let at = crate::input::locate(&definition.text, "figures", name);
            Err(InputError::new("figures", name, "there is no figure of that name")
                .allowed(names.join(", "))
                .in_file(&definition.file, at)
                .into())
        }
    }
}

/// Everything that the experiment's figures show.
pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    check_figures(&results.definition)?;
    let mut blocks = Vec::new();
    for entry in results.definition.figures.iter().filter_map(|name| find(name)) {
        blocks.extend((entry.make)(results)?);
    }
    Ok(blocks)
}
