//! How the rows of a claim are measured again, and the estimated costs.

use crate::claims::{Answer, Needs};
use crate::error::{Error, Result};
use crate::experiment::{Plan, Prices, Theirs};
use crate::lab::Lab;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The folder of the experiment whose rows answer a claim. The sources of the answer are paths in the archive.
pub(super) fn folder_of<'a>(answer: &'a Answer<'_>) -> Option<&'a Path> {
    let is_measured = matches!(answer.report.needs(answer.claim), Needs::Experiment(_));
    answer.sources.first().filter(|_| is_measured)?.parent()
}

/// The costs of an experiment on this machine, with its scenes.
pub(super) struct Cost {
    pub(super) plan: Plan,
    /// The scene files that are not built in.
    pub(super) scenes: BTreeSet<PathBuf>,
}

/// The costs of experiments by their folders in the archive, or why they are not known.
pub(super) type Costs = BTreeMap<PathBuf, std::result::Result<Cost, String>>;

/// Estimates by a pilot the costs of the experiments that answer claims.
pub(super) fn costs(lab: &Arc<Lab>, archive: &Path, answers: &[Answer<'_>]) -> Result<Costs> {
    let mut prices = Prices::new(lab);
    let mut costs = Costs::new();
    for answer in answers {
        let Some(folder) = folder_of(answer) else { continue };
        if costs.contains_key(folder) {
            continue;
        }
        let cost = match cost(lab, &archive.join(folder), &mut prices) {
            Ok(cost) => Ok(cost),
            Err(Error::Input(error)) => Err(error.to_string()),
            Err(other) => return Err(other),
        };
        costs.insert(folder.to_path_buf(), cost);
    }
    Ok(costs)
}

fn cost(lab: &Arc<Lab>, folder: &Path, prices: &mut Prices<'_>) -> Result<Cost> {
    let theirs = Theirs::read(lab, folder)?;
    let plan = theirs.plan(folder, prices)?;
    let scenes = theirs.definition.cells(theirs.profile)?.into_iter().flat_map(|cell| cell.scene.files).collect();
    Ok(Cost { plan, scenes })
}
