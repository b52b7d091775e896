//! What an effect costs: absent, compiled in but unused, used; and what all scenes gain from the profile that fits them.

use crate::analysis::Estimate;
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, Dot, DotPlot, Group, Row};
use crate::report::block::{Block, Table};
use crate::report::results::{Results, confidence, median_with_interval, with_level};
use std::collections::BTreeMap;

/// The profile with everything in it.
const LARGEST: &str = "all";

/// What tells the kernels of a row apart.
#[derive(Debug, Clone, Copy)]
struct Kind {
    scene: &'static str,
    profile: &'static str,
    /// Whether rays are tested against boxes first.
    hierarchy: bool,
}

const fn kind(scene: &'static str, profile: &'static str) -> Kind {
    Kind { scene, profile, hierarchy: false }
}

/// An effect, and where it is absent, compiled in but unused, and used.
struct Price {
    effect: &'static str,
    absent: Kind,
    unused: Kind,
    used: Kind,
}

/// Each effect beside the smallest profile without it, on the same scene.
const PRICES: &[Price] = &[
    Price {
        effect: "mirror",
        absent: kind("cornell-diffuse", "diffuse"),
        unused: kind("cornell-diffuse", "smallpt"),
        used: kind("cornell-mirror", "smallpt"),
    },
    Price {
        effect: "mirror and glass",
        absent: kind("cornell-diffuse", "diffuse"),
        unused: kind("cornell-diffuse", "smallpt"),
        used: kind("cornell", "smallpt"),
    },
    Price {
        effect: "lens",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "lens"),
        used: kind("cornell-lens", "lens"),
    },
    Price {
        effect: "fog",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "fog"),
        used: kind("cornell-fog", "fog"),
    },
    Price {
        effect: "hierarchy, planes, point lights, background",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "scenery"),
        used: Kind { hierarchy: true, ..kind("cornell", "scenery") },
    },
    Price {
        effect: "planes, polished, point lights",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "scenery"),
        used: kind("report-c", "scenery"),
    },
    Price {
        effect: "triangles",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "surfaces"),
        used: Kind { hierarchy: true, ..kind("cornell-mesh", "surfaces") },
    },
    Price {
        effect: "triangles and a Fresnel mirror",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "surfaces"),
        used: Kind { hierarchy: true, ..kind("cornell-mesh-mirror", "surfaces") },
    },
    Price {
        effect: "triangles and rough metal",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "surfaces"),
        used: Kind { hierarchy: true, ..kind("conductor-25", "surfaces") },
    },
    Price {
        effect: "triangles and Kd + Ks",
        absent: kind("cornell", "smallpt"),
        unused: kind("cornell", "surfaces"),
        used: Kind { hierarchy: true, ..kind("kd-ks-25-vndf", "surfaces") },
    },
    Price {
        effect: "all",
        absent: kind("cornell-diffuse", "diffuse"),
        unused: kind("cornell-diffuse", LARGEST),
        used: Kind { hierarchy: true, ..kind("cornell", LARGEST) },
    },
];

impl Kind {
    fn is_of(&self, record: &Record) -> bool {
        let hierarchy = record.accelerator != "none";
        record.scene == self.scene && record.effects == self.profile && hierarchy == self.hierarchy
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let mut blocks = prices(results);
    blocks.extend(scenes(results));
    if blocks.is_empty() {
        blocks.push(Block::Finding(
            "Nothing was run with and without an effect, so there is no price of one.".to_string(),
        ));
    }
    Ok(blocks)
}

/// Processor seconds of a sample by repetition: others on the machine disturb them less than the time that passes. Several rows of one
/// repetition are averaged.
fn sample_times(results: &Results, is_wanted: impl Fn(&Record) -> bool) -> BTreeMap<u32, f64> {
    let mut times: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for record in results.records.iter().filter(|record| is_wanted(record)) {
        if let (Some(cpu_s), Some(paths)) = (record.cpu_s(), record.paths) {
            times.entry(record.repetition).or_default().push(cpu_s / paths as f64);
        }
    }
    times.into_iter().map(|(repetition, times)| (repetition, times.iter().sum::<f64>() / times.len() as f64)).collect()
}

/// The median of the ratios within a repetition.
fn ratio(above: &BTreeMap<u32, f64>, below: &BTreeMap<u32, f64>) -> Option<Estimate> {
    let ratios = below.iter().filter_map(|(repetition, below)| Some(above.get(repetition)? / below));
    let (value, interval) = median_with_interval(&ratios.collect::<Vec<f64>>())?;
    Some(Estimate { value, interval: interval? })
}

fn dot(ratio: &Estimate) -> Dot {
    Dot { value: ratio.value, interval: Some((ratio.interval.low, ratio.interval.high)) }
}

fn words(ratio: &Estimate) -> String {
    format!("{:.3}, {}", ratio.value, with_level(&ratio.interval, 3))
}

fn nanoseconds(times: &BTreeMap<u32, f64>) -> String {
    median(&times.values().copied().collect::<Vec<f64>>())
        .map_or_else(|| "-".to_string(), |s| format!("{:.0}", s * 1e9))
}

fn rays(results: &Results, is_wanted: impl Fn(&Record) -> bool) -> String {
    let found = results.records.iter().find(|record| is_wanted(record));
    found
        .and_then(|r| Some(r.rays? as f64 / r.paths? as f64))
        .map_or_else(|| "-".to_string(), |rays| format!("{rays:.2}"))
}

fn prices(results: &Results) -> Vec<Block> {
    let (mut rows, mut table, mut intervals, mut unused_ratios) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for Price { effect, absent, unused, used } in PRICES {
        let times = |kind: &Kind| sample_times(results, |record| kind.is_of(record));
        let (without, idle, at_work) = (times(absent), times(unused), times(used));
        let (Some(unused_ratio), Some(used_ratio)) = (ratio(&idle, &without), ratio(&at_work, &without)) else {
            continue;
        };
        intervals.extend([unused_ratio.interval, used_ratio.interval]);
        unused_ratios.push((*effect, unused_ratio));
        rows.push(Row { name: (*effect).to_string(), dots: vec![Some(dot(&unused_ratio)), Some(dot(&used_ratio))] });
        table.push(vec![
            (*effect).to_string(),
            format!("{}, {}", absent.scene, absent.profile),
            nanoseconds(&without),
            rays(results, |record| absent.is_of(record)),
            unused.profile.to_string(),
            nanoseconds(&idle),
            words(&unused_ratio),
            format!("{}, {}", used.scene, used.profile),
            nanoseconds(&at_work),
            rays(results, |record| used.is_of(record)),
            words(&used_ratio),
        ]);
    }
    if rows.is_empty() {
        return Vec::new();
    }
    let axis = Axis::linear("processor time of a sample / without the effect").including([0.95, 1.05]);
    let mut plot = DotPlot::new("The price of an effect", axis, rows);
    plot.groups = ["compiled in, unused", "used"]
        .iter()
        .enumerate()
        .map(|(index, name)| Group { name: (*name).to_string(), look: Look::nth(index) })
        .collect();
    plot.guides = vec![(1.0, "absent".to_string())];
    plot.subtitle = machine(results);
    plot.caption = format!(
        "Median of ratios within a repetition. Bars: {}. What uses an effect is another image, with other paths.",
        confidence(&intervals)
    );
    let above = |least: f64| {
        unused_ratios
            .iter()
            .filter(|(_, ratio)| ratio.interval.low > least)
            .map(|(effect, _)| *effect)
            .collect::<Vec<_>>()
    };
    let dearest = unused_ratios.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let finding = dearest.map(|(effect, ratio)| {
        let beyond = above(1.0);
        let verdict = if beyond.is_empty() {
            "None of them costs anything beyond the noise".to_string()
        } else {
            format!("Beyond the noise cost: {}", beyond.join("; "))
        };
        Block::Finding(format!(
            "An effect that is compiled into the kernel but not used by the scene makes a sample take {} times as long at most ({effect}). {verdict}.",
            words(ratio),
        ))
    });
    let columns = [
        "effect",
        "absent",
        "ns per sample",
        "rays per sample",
        "unused: profile",
        "ns per sample",
        "ratio (confidence)",
        "used",
        "ns per sample",
        "rays per sample",
        "ratio (confidence)",
    ];
    let title = "The price of an effect: absent, compiled in but unused, used".to_string();
    let mut blocks = vec![Block::Figure { stem: "effects", figure: Box::new(plot) }];
    blocks.extend(finding);
    blocks.push(Block::Table {
        stem: "effects-table",
        table: Table { title, columns: columns.map(String::from).to_vec(), rows: table },
    });
    blocks
}

/// A scene under the profile that fits it, and the time under the largest over that.
struct Fit {
    scene: String,
    profile: String,
    fitting: BTreeMap<u32, f64>,
    largest: BTreeMap<u32, f64>,
    ratio: Estimate,
}

/// The rows of a scene in the largest profile, and in the smallest other one.
fn fits(results: &Results) -> Vec<Fit> {
    let of_scene = |((scene, accelerator), records): ((String, String), Vec<&Record>)| {
        let mut profiles: Vec<&str> = crate::scene::PROFILES.iter().map(|entry| entry.name).collect();
        profiles.retain(|name| *name != LARGEST && records.iter().any(|record| record.effects == *name));
        let profile = profiles.first()?.to_string();
        let times = |profile: &str| {
            sample_times(results, |r| r.scene == scene && r.accelerator == accelerator && r.effects == profile)
        };
        let (fitting, largest) = (times(&profile), times(LARGEST));
        let ratio = ratio(&largest, &fitting)?;
        Some(Fit { scene, profile, fitting, largest, ratio })
    };
    let groups = results.by(|record| (record.scene.clone(), record.accelerator.clone()));
    let mut fits: Vec<Fit> = groups.into_iter().filter_map(of_scene).collect();
    // Once is enough; `none` comes before the hierarchies.
    fits.dedup_by(|later, first| later.scene == first.scene);
    fits
}

fn scenes(results: &Results) -> Vec<Block> {
    let mut fits = fits(results);
    fits.sort_by(|a, b| b.ratio.value.total_cmp(&a.ratio.value));
    let Some(overall) = median(&fits.iter().map(|fit| fit.ratio.value).collect::<Vec<f64>>()) else {
        return Vec::new();
    };
    let row = |fit: &Fit| Row { name: format!("{} ({})", fit.scene, fit.profile), dots: vec![Some(dot(&fit.ratio))] };
    let axis =
        Axis::linear("processor time with every effect compiled in / with the fitting profile").including([0.95, 1.1]);
    let mut plot = DotPlot::new("What a fitting profile gains", axis, fits.iter().map(row).collect());
    plot.guides = vec![(1.0, "no gain".to_string())];
    plot.subtitle = machine(results);
    plot.caption = format!(
        "Median of ratios within a repetition, same image. Bars: {}.",
        confidence(&fits.iter().map(|fit| fit.ratio.interval).collect::<Vec<_>>())
    );
    let slower: Vec<&str> =
        fits.iter().filter(|fit| fit.ratio.interval.high < 1.0).map(|fit| fit.scene.as_str()).collect();
    let faster = fits.iter().filter(|fit| fit.ratio.interval.low > 1.0).count();
    let never = if slower.is_empty() {
        "for none is it slower beyond the noise".to_string()
    } else {
        format!("beyond the noise it is slower for {}", slower.join(", "))
    };
    let mut blocks = vec![
        Block::Figure { stem: "profiles", figure: Box::new(plot) },
        Block::Finding(format!(
            "Of {} scenes the fitting profile renders {faster} faster than the largest profile beyond the noise; {never}. The largest one takes {overall:.3} times as long in the median.",
            fits.len(),
        )),
    ];
    blocks.extend(fits.iter().find(|fit| fit.profile == "diffuse").map(|fit| {
        let verdict = match (fit.ratio.interval.low >= 1.1, fit.ratio.interval.high < 1.1) {
            (true, _) => "the fitting profile is at least 1.1 times as fast",
            (_, true) => "the fitting profile gains less than a tenth: the tests that it leaves out are predicted well",
            _ => "this run cannot tell whether that is more or less than 1.1",
        };
        Block::Finding(format!(
            "Diffuse spheres alone ({}) take {} times as long with every effect compiled in: {verdict}.",
            fit.scene,
            words(&fit.ratio)
        ))
    }));
    let cells = |fit: &Fit| {
        vec![
            fit.scene.clone(),
            fit.profile.clone(),
            nanoseconds(&fit.fitting),
            nanoseconds(&fit.largest),
            words(&fit.ratio),
        ]
    };
    let columns = ["scene", "fitting profile", "ns per sample", "ns per sample with all effects", "ratio (confidence)"];
    let table = Table {
        title: "Every scene under the fitting and the largest profile".to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: fits.iter().map(cells).collect(),
    };
    blocks.push(Block::Table { stem: "profiles-table", table });
    blocks
}

fn machine(results: &Results) -> String {
    let schedule = results
        .records
        .first()
        .map_or_else(String::new, |r| format!("{}, {}x{}, {} spp, ", r.strategy, r.width, r.height, r.spp));
    format!("{schedule}{}", results.run.machine.cpu)
}
