//! Images of each estimator and sampler after the same time: those that a time limit ended, or else the points of curves
//! that are nearest in time.

use crate::experiment::EXTERNAL;
use crate::image_io::Image;
use crate::measure::Seconds;
use crate::prelude::*;
use crate::words::with_interval;
use std::ptr;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let contenders = limited(results);
    let mut blocks = Vec::new();
    for (race, contenders) in gathered(contenders.iter().map(|own| (own.race, own))) {
        blocks.extend(finding(race, &contenders));
    }
    match pictures_of(results, &contenders)? {
        Some(pictures) => blocks.push(pictures.block()?),
        None => blocks.push(Block::notice("There are no images side by side: this experiment kept none.")),
    }
    if !contenders.is_empty() {
        blocks.extend(doubt(results, &contenders)?);
        blocks.push(table(&contenders));
    }
    Ok(blocks)
}

/// An image with the lines to stand above it.
pub(crate) struct Picture {
    pub(crate) caption: Vec<String>,
    pub(crate) image: Image,
}

/// The pictures of the figure, in groups that begin a row.
pub(crate) struct Pictures {
    pub(crate) title: String,
    pub(crate) subtitle: &'static str,
    pub(crate) groups: Vec<Vec<Picture>>,
}

impl Pictures {
    /// The pictures of an experiment; `None` if it kept no images.
    pub(crate) fn of(results: &Results) -> Result<Option<Self>> {
        pictures_of(results, &limited(results))
    }

    fn block(self) -> Result<Block> {
        let cell = |Picture { caption, image }: &Picture| Cell::of(image, caption.clone());
        let groups = self.groups.iter().map(|group| group.iter().map(cell).collect::<Result<Vec<Cell>>>());
        let groups = groups.collect::<Result<Vec<_>>>()?;
        Block::sheet(
            "equal-time",
            &ContactSheet::groups(self.title, self.subtitle.to_string(), groups, Comparison::Wipe),
        )
    }
}

fn pictures_of(results: &Results, contenders: &[Limited<'_>]) -> Result<Option<Pictures>> {
    if contenders.is_empty() { nearest(results) } else { at_limits(results, contenders) }
}

/// The caption of a reference.
const REFERENCE: &str = "mean of two halves";
/// A half-reference should have this many times the samples of an image.
const REFERENCE_TIMES: u32 = 10;

/// Scene, width and height, and the time limit.
type Race<'a> = (&'a str, u32, u32, Option<Seconds>);

/// A way to render, under one time limit.
struct Limited<'a> {
    race: Race<'a>,
    name: String,
    /// A row of each seed: repetitions of a seed share most of their samples.
    rows: Vec<&'a Row>,
    seconds: Option<Estimated>,
    rmse: Option<Estimated>,
}

impl<'a> Limited<'a> {
    fn of(race: Race<'a>, name: String, rows: Vec<&'a Row>, stopping: Stopping) -> Self {
        let rows: Vec<&Row> = group(rows, |row| row.seed).into_values().map(|own| own[0]).collect();
        let rmse = Estimated::rmse(&values(&rows, |row| row.mse));
        let seconds = Estimated::typical(&values(&rows, |row| row.rendering_s()), stopping);
        Self { race, name, seconds, rmse: Some(rmse).filter(|rmse| rmse.value.is_finite()), rows }
    }

    /// The fewest and the most samples per pixel that a seed reached.
    fn spp(&self) -> String {
        let spp: BTreeSet<u32> = self.rows.iter().map(|row| row.spp).collect();
        let ends: BTreeSet<&u32> = spp.first().into_iter().chain(spp.last()).collect();
        ends.into_iter().map(ToString::to_string).collect::<Vec<_>>().join(" to ")
    }

    /// The RMSE with its interval.
    fn error(&self) -> Option<String> {
        let Estimated { value, interval, .. } = self.rmse?;
        Some(interval.map_or_else(|| format!("{value:.4}"), |interval| with_interval(value, &interval, 4)))
    }

    fn caption(&self) -> Vec<String> {
        let seconds = self.seconds.map_or_else(String::new, |seconds| format!(", {:.3} s", seconds.value));
        let samples = format!("{} spp{seconds}, {}", self.spp(), counted(self.rows.len(), "seed"));
        let error = self.error().map(|error| format!("RMSE {error}"));
        [self.name.clone()].into_iter().chain(error).chain([samples]).collect()
    }
}

/// The contenders with a time limit, by scene, size and limit, in the order of the estimators in the definition.
fn limited<'a>(results: &'a Results) -> Vec<Limited<'a>> {
    let rows = || results.rows().filter(|row| row.time_limit_s.is_some() && row.makespan_s.is_some());
    let has_schedules = rows().map(|row| &row.schedule).collect::<BTreeSet<_>>().len() > 1;
    let order = results.definition.estimator_names();
    let place = |row: &Row| order.iter().position(|name| *name == row.estimator).unwrap_or(order.len());
    let name = |row: &Row| {
        let image = results.series_name_in_scene(row);
        let image = if image.is_empty() { row.estimator.clone() } else { image };
        joined([image, if has_schedules { row.schedule.label() } else { String::new() }])
    };
    let race = |row: &'a Row| -> Race<'a> { (row.scene.as_str(), row.width, row.height, row.time_limit_s) };
    let groups = group(rows(), |row| (race(row), place(row), name(row)));
    let contender = |((race, _, name), rows)| Limited::of(race, name, rows, results.stopping());
    groups.into_iter().map(contender).collect()
}

/// Scene and time limit, in words.
fn told((scene, _, _, limit): Race<'_>) -> String {
    let seconds = limit.map(|limit| format!(" after {limit} s"));
    format!("{scene}{}", seconds.unwrap_or_default())
}

/// The smallest error of a race, and the contenders that are not told apart from it, because their intervals overlap.
fn finding(race: Race<'_>, contenders: &[&Limited<'_>]) -> Option<Block> {
    let mut ranked: Vec<(&Limited<'_>, f64)> =
        contenders.iter().filter_map(|own| Some((*own, own.rmse?.value))).collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let ((best, _), others) = ranked.split_first().filter(|(_, others)| !others.is_empty())?;
    let bar = |own: &Limited<'_>| own.rmse.and_then(|rmse| rmse.bar());
    let overlaps = |own: &Limited<'_>| bar(own).zip(bar(best)).is_none_or(|(own, best)| own.0 <= best.1);
    let tied: Vec<&str> = others.iter().filter(|(own, _)| overlaps(own)).map(|(own, _)| own.name.as_str()).collect();
    let verdict = match tied.as_slice() {
        [] => "The intervals of all others lie above it.".to_string(),
        names => format!("Not told apart from it, because the intervals overlap: {}.", names.join("; ")),
    };
    let (race, name, error) = (told(race), &best.name, best.error()?);
    Some(Block::finding(format!("{race}: {name} has the smallest RMSE, {error}. {verdict}")))
}

/// A group for each race, with errors and times over all seeds above the pictures.
fn at_limits(results: &Results, contenders: &[Limited<'_>]) -> Result<Option<Pictures>> {
    let races = gathered(contenders.iter().map(|own| (own.race, own)));
    let mut images = results.kept_images(|row| row.time_limit_s.is_some())?;
    let mut groups = Vec::new();
    for (&race, contenders) in &races {
        let mut group = Vec::new();
        for contender in contenders {
            let is_own = |row: &Row| contender.rows.iter().any(|own| ptr::eq(*own, row));
            let own = images.iter().enumerate().filter(|(_, (row, _))| is_own(row));
            let first = own.min_by_key(|(_, (row, _))| row.seed).map(|(index, _)| index);
            if let Some(index) = first {
                let mut caption = contender.caption();
                if races.len() > 1 {
                    caption[0] = format!("{}: {}", told(race), contender.name);
                }
                group.push(Picture { caption, image: images.swap_remove(index).1 });
            }
        }
        if !group.is_empty()
            && let Some(image) = results.reference_image(Some(race.0))?
        {
            group.push(Picture { caption: vec![format!("{}: reference", race.0), REFERENCE.to_string()], image });
        }
        groups.push(group);
    }
    groups.retain(|group| !group.is_empty());
    let title = races.keys().map(|race| told(*race)).collect::<Vec<_>>().join("; ");
    let subtitle = "Each picture is that of the lowest seed; RMSE with its 95 % interval, and the typical seconds, are over all seeds. \
        Values above 1 are white.";
    Ok((!groups.is_empty()).then_some(Pictures { title, subtitle, groups }))
}

/// Images after about the same time: of each curve the point that is nearest.
fn nearest(results: &Results) -> Result<Option<Pictures>> {
    let Some(scene) = results.first().map(|row| row.scene.clone()) else { return Ok(None) };
    let order = results.definition.estimator_names();
    let place = |record: &Row| order.iter().position(|name| *name == record.estimator).unwrap_or(order.len());
    let mut kept: BTreeMap<(usize, String), Vec<(&Row, Image)>> = BTreeMap::new();
    for (record, image) in results.kept_images(|record| record.scene == scene && record.makespan_s.is_some())? {
        let sampler = if record.sampler == EXTERNAL { String::new() } else { format!(" + {}", record.sampler) };
        let name = format!("{}{sampler}", record.estimator);
        kept.entry((place(record), name)).or_default().push((record, image));
    }
    let seconds = |record: &Row| record.makespan_s.unwrap_or(0.0);
    let longest = |images: &Vec<(&Row, Image)>| images.iter().map(|(record, _)| seconds(record)).reduce(f64::max);
    let Some(time) = kept.values().filter_map(longest).reduce(f64::min) else { return Ok(None) };
    let distance = |record: &Row| (libm::log(seconds(record) / time)).abs();
    let mut group = Vec::new();
    for ((_, name), images) in kept {
        let Some((record, image)) = images.into_iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0))) else {
            continue;
        };
        let error = record.rmse.map_or_else(String::new, |rmse| format!("RMSE {rmse:.4}, "));
        let caption = vec![name, format!("{error}{} spp, {:.2} s", record.spp, seconds(record))];
        group.push(Picture { caption, image });
    }
    if let Some(image) = results.reference_image(Some(&scene))? {
        group.push(Picture { caption: vec!["reference".to_string(), REFERENCE.to_string()], image });
    }
    let title = format!("{scene} after about {time:.2} s");
    let subtitle = "Of each curve the point that is nearest in time; neighbouring points differ by a factor of two. Values above 1 are white.";
    Ok(Some(Pictures { title, subtitle, groups: vec![group] }))
}

/// A notice if the references have too few samples for the images that the time limit allowed.
fn doubt(results: &Results, contenders: &[Limited<'_>]) -> Result<Option<Block>> {
    let most = contenders.iter().flat_map(|own| &own.rows).map(|row| row.spp).max().unwrap_or(0);
    let reference = results.definition.reference(results.profile())?;
    let few = reference.filter(|(_, spp)| *spp < most.saturating_mul(REFERENCE_TIMES));
    Ok(few.map(|(_, spp)| {
        let advice = "the references' own noise may move all of these errors; raise `reference-spp`";
        Block::notice(format!("An image has {most} spp and each half-reference {spp}: {advice}."))
    }))
}

fn table(contenders: &[Limited<'_>]) -> Block {
    Block::table("equal-time", "Errors under a time limit", contenders)
        .column("scene", |own| own.race.0.to_string())
        .column("time limit, s", |own| own.race.3.map_or_else(String::new, |limit| limit.to_string()))
        .column("rendered by", |own| own.name.clone())
        .estimated("RMSE", Significant(3), |own| own.rmse)
        .estimated("seconds", Significant(3), |own| own.seconds)
        .column("spp", |own| own.spp())
        .column("seeds", |own| own.rows.len().to_string())
        .end()
}
