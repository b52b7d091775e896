//! Comparisons: which cells of an experiment run side by side.
//!
//! ```toml
//! [[compare]]
//! what = { effects = ["lens", "fog"] }   # optional: all cells
//! with = { effects = ["smallpt"] }
//! goal = "1 %"                           # optional: half of the interval that the ratio should have
//! ```
//!
//! Each cell that `what` selects is compared with those that `with` selects and that agree with it in every setting of the
//! image that the entry does not name. Cells that are connected by comparisons form a group.

use super::diff::parse_share;
use super::{Cell, Definition, Profile};
use crate::error::{Error, InputError, Result};
use crate::measure::{SERIAL, SETTINGS};
use serde::Deserialize;
use std::collections::{BTreeMap, HashSet};

/// An entry of an experiment.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Compare {
    #[serde(default)]
    what: Selection,
    with: Selection,
    goal: Option<String>,
}

/// Settings, each with the values that a cell may have.
type Selection = BTreeMap<String, Vec<toml::Value>>;

/// A comparison of two cells, by their places in the list of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Comparison {
    pub(super) what: usize,
    pub(super) with: usize,
    /// Half of the interval that the ratio of times should have, as a share of the ratio.
    pub(super) goal: Option<f64>,
}

/// The comparisons of an experiment's cells.
#[derive(Debug, Clone, Default)]
pub(super) struct Comparisons {
    pub(super) pairs: Vec<Comparison>,
}

fn matches(selection: &Selection, cell: &Cell) -> Result<bool> {
    let word = |value: &toml::Value| value.as_str().map_or_else(|| value.to_string(), str::to_string);
    for (name, values) in selection {
        let values: Vec<String> = values.iter().map(word).collect();
        if !cell.matches(&format!("{name}={}", values.join(",")))? {
            return Ok(false);
        }
    }
    Ok(true)
}

impl Comparisons {
    /// The comparisons of these cells; curves are never compared.
    pub(super) fn of(definition: &Definition, profile: Profile, cells: &[Cell]) -> Result<Self> {
        Self::of_entries(&definition.compare, definition, profile, cells)
    }

    /// The comparisons of these cells, or if the experiment names none, those with the serial runs of each image.
    pub(super) fn of_any(definition: &Definition, profile: Profile, cells: &[Cell]) -> Result<Self> {
        if !definition.compare.is_empty() {
            return Self::of(definition, profile, cells);
        }
        let with = BTreeMap::from([("strategy".to_string(), vec![toml::Value::from(SERIAL)])]);
        Self::of_entries(&[Compare { what: Selection::new(), with, goal: None }], definition, profile, cells)
    }

    fn of_entries(entries: &[Compare], definition: &Definition, profile: Profile, cells: &[Cell]) -> Result<Self> {
        let mut pairs: Vec<Comparison> = Vec::new();
        for entry in entries {
            let located = |error: Error| error.placed(|input| definition.located(profile, input));
            let goal = entry.goal.as_deref().map(|text| parse_share("goal", &text.replace(' ', ""))).transpose();
            let goal = goal.map_err(located)?;
            let named = |name: &str| entry.what.contains_key(name) || entry.with.contains_key(name);
            let shared: Vec<_> =
                SETTINGS.iter().filter(|setting| setting.changes_image && !named(setting.name)).collect();
            let image = |cell: &Cell| shared.iter().map(|setting| cell.shown(setting)).collect::<Vec<String>>();
            let selected = |selection: &Selection| -> Result<Vec<(usize, Vec<String>)>> {
                let mut found = Vec::new();
                for (index, cell) in cells.iter().enumerate().filter(|(_, cell)| cell.points.len() == 1) {
                    if matches(selection, cell)? {
                        found.push((index, image(cell)));
                    }
                }
                Ok(found)
            };
            let (what, with) = (selected(&entry.what).map_err(located)?, selected(&entry.with).map_err(located)?);
            let mut by_image: BTreeMap<&[String], Vec<usize>> = BTreeMap::new();
            for (index, image) in &with {
                by_image.entry(image).or_default().push(*index);
            }
            let is_new = |pairs: &[Comparison], own: usize, other: usize| {
                let same = |pair: &Comparison| {
                    [pair.what, pair.with] == [own, other] || [pair.with, pair.what] == [own, other]
                };
                own != other && !pairs.iter().any(same)
            };
            for (own, image) in &what {
                for other in by_image.get(image.as_slice()).into_iter().flatten() {
                    if is_new(&pairs, *own, *other) {
                        pairs.push(Comparison { what: *own, with: *other, goal });
                    }
                }
            }
        }
        Ok(Self { pairs })
    }

    /// Refuses entries by which no cell is compared, in a sweep of all cells, and a second stage without goals.
    pub(super) fn check(&self, definition: &Definition, profile: Profile) -> Result<()> {
        if self.pairs.is_empty() && !definition.compare.is_empty() {
            let error = InputError::new("compare", "", "selects no two cells of one image");
            return Err(definition.located(profile, error.allowed("values that cells of the matrix have")));
        }
        if definition.second_stage(profile)?.is_some() && self.pairs.iter().all(|pair| pair.goal.is_none()) {
            let error = InputError::new("at-least", "", "is for comparisons that miss their goal, and none has a goal");
            return Err(
                definition.located(profile, error.allowed("goal under [[compare]], or a number of repetitions"))
            );
        }
        Ok(())
    }

    /// The chosen cells, and those with which they are compared, in the order of all cells.
    pub(super) fn with_partners(&self, all: &[Cell], chosen: &[Cell]) -> Vec<Cell> {
        let ids: HashSet<&str> = chosen.iter().map(|cell| cell.id.as_str()).collect();
        let is_chosen = |index: usize| ids.contains(all[index].id.as_str());
        let partners: HashSet<usize> =
            self.pairs.iter().filter(|pair| is_chosen(pair.what)).map(|pair| pair.with).collect();
        let wanted = (0..all.len()).filter(|index| is_chosen(*index) || partners.contains(index));
        wanted.map(|index| all[index].clone()).collect()
    }

    /// The comparisons, each over all of its seeds: two cells of another seed are other processes of the same comparison.
    pub(super) fn over_seeds(&self, cells: &[Cell]) -> Vec<Vec<Comparison>> {
        let without_seed = |index: usize| {
            let Cell { id, keys: (image, _), .. } = &cells[index];
            id.replacen(&image.to_string(), &image.without_seed().to_string(), 1)
        };
        let mut places = BTreeMap::new();
        let mut found: Vec<Vec<Comparison>> = Vec::new();
        for pair in &self.pairs {
            let place = *places.entry([pair.what, pair.with].map(without_seed)).or_insert(found.len());
            if place == found.len() {
                found.push(Vec::new());
            }
            found[place].push(*pair);
        }
        found
    }

    /// The groups of cells that are connected by comparisons, each in the order of the cells.
    pub(super) fn groups(&self, cells: usize) -> Vec<Vec<usize>> {
        let mut group_of: Vec<usize> = (0..cells).collect();
        for pair in &self.pairs {
            let (own, other) = (group_of[pair.what], group_of[pair.with]);
            group_of.iter_mut().filter(|group| **group == other).for_each(|group| *group = own);
        }
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, group) in group_of.into_iter().enumerate() {
            groups.entry(group).or_default().push(index);
        }
        let mut groups: Vec<Vec<usize>> = groups.into_values().filter(|group| group.len() > 1).collect();
        groups.sort();
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Lab;

    fn groups(compare: &str) -> Vec<Vec<usize>> {
        let text = format!(
            "title = \"t\"\nquestion = \"q\"\nfigures = []\n{compare}\n[matrix]\nscene = [\"cornell\", \"cornell-lens\"]\n\
             spp = [4]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\nkernel = [\"scalar\"]\n\
             effects = [\"fitting\", \"all\"]\n"
        );
        let definition = Definition::from_text(&Lab::built_in(), "x", "x.toml", &text).unwrap();
        let cells = definition.cells(Profile::Quick).unwrap();
        assert_eq!(cells.len(), 4);
        Comparisons::of(&definition, Profile::Quick, &cells).unwrap().groups(cells.len())
    }

    /// Two scenes with two profiles and three seeds: six comparisons in six groups, which are two comparisons.
    #[test]
    fn seeds_are_processes_of_one_comparison() {
        let text = "title = \"t\"\nquestion = \"q\"\nfigures = []\n[[compare]]\nwhat = { effects = [\"all\"] }\n\
                    with = { effects = [\"smallpt\", \"lens\"] }\n[matrix]\nscene = [\"cornell\", \"cornell-lens\"]\n\
                    spp = [4]\nseed = [1, 2, 3]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\n\
                    kernel = [\"scalar\"]\neffects = [\"fitting\", \"all\"]\n";
        let definition = Definition::from_text(&Lab::built_in(), "x", "x.toml", text).unwrap();
        let cells = definition.cells(Profile::Quick).unwrap();
        let comparisons = Comparisons::of(&definition, Profile::Quick, &cells).unwrap();
        assert_eq!(comparisons.groups(cells.len()).len(), 6);
        let over_seeds = comparisons.over_seeds(&cells);
        assert_eq!(over_seeds.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3]);
        for seeds in over_seeds {
            let scenes = seeds.iter().map(|pair| cells[pair.what].settings.scene.as_str());
            assert_eq!(scenes.collect::<HashSet<_>>().len(), 1);
        }
    }

    /// A cell is selected by the profile that fits its scene, even if it asked for none. Cells of two scenes are compared
    /// only if the entry names scenes.
    #[test]
    fn cells_are_selected_by_the_values_that_they_use() {
        assert_eq!(groups("[[compare]]\nwith = { effects = [\"smallpt\", \"lens\"] }").len(), 2);
        assert_eq!(groups("[[compare]]\nwith = { effects = [\"smallpt\"] }").len(), 1);
        let across =
            "[[compare]]\nwhat = { scene = [\"cornell-lens\"] }\nwith = { scene = [\"cornell\"], effects = [\"all\"] }";
        assert_eq!(groups(across).iter().map(Vec::len).collect::<Vec<_>>(), [3]);
        assert!(groups("[[compare]]\nwith = { effects = [\"fog\"] }").is_empty());
    }
}
