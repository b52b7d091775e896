//! `pathmark rank DIR`: which schedules can be told apart?

use super::prelude::*;
use super::run::note_doubts;
use crate::console::markdown;
use crate::error::printable;
use crate::experiment::{ImageRanking, Place, ranking};
use crate::report::latex::tabular;

/// `pathmark rank out/thread-scaling --filter threads=2`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of an experiment: `out/thread-scaling`
    folder: PathBuf,
    /// Rank only cells in which AXIS has one of the values; may be given several times
    #[arg(long, value_name = "AXIS=VALUES")]
    filter: Vec<String>,
    /// Print the ranking as one JSON object
    #[arg(long)]
    json: bool,
    /// Print the ranking as tables in Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Print the ranking as tables for LaTeX, which need its package booktabs
    #[arg(long, conflicts_with_all = ["json", "markdown"])]
    latex: bool,
}

/// The meaning of places, ratios and letters.
const RULE: &str = "The place is decided by the median of a schedule's times, each divided by the median time of its repetition. \
The ratios to the first schedule are of these two alone, so they may order neighbours in another way. Schedules that \
share a letter cannot be told apart; all other orders hold together with 95 % confidence.";

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    if arguments.folder.exists() && !arguments.folder.is_dir() {
        let folder = arguments.folder.display().to_string();
        return Err(InputError::new("folder", folder, "is not a folder").allowed("as in out/thread-scaling").into());
    }
    let found = ranking(lab, &arguments.folder, &arguments.filter)?;
    if arguments.json {
        print_json(&json_of(&found)?)?;
    } else if arguments.latex {
        let tables: String = found.images.iter().map(latex).collect();
        print(&format!("{tables}% {RULE}"))?;
    } else {
        let shown = if arguments.markdown { in_markdown } else { table };
        let tables: Vec<String> = found.images.iter().map(shown).collect();
        print(&format!("{}\n\n{RULE}", tables.join("\n\n")))?;
    }
    if found.images.iter().any(|image| image.part[1] > 1) {
        console
            .note("schedules of different parts were never measured in one repetition, so each part is ranked apart");
    }
    if !found.without_time.is_empty() {
        let names: Vec<_> = found.without_time.iter().map(|cell| printable(cell)).collect();
        console.note(&format!(
            "{} not ranked, because no row has a time: {}",
            counted(names.len(), "cell"),
            names.join(", ")
        ));
    }
    let most = found.images.iter().flat_map(|image| &image.places).map(|place| place.repetitions).max().unwrap_or(0);
    let least = found.least_repetitions as usize;
    if most < least {
        console.note(&format!(
            "{} cannot tell any two schedules apart: it takes {least} (run --repetitions {least}), or fewer schedules (--filter)",
            counted(most, "repetition")
        ));
    }
    note_doubts(&found.doubts, console);
    Ok(())
}

fn latex(image: &ImageRanking) -> String {
    let heads = ["schedule", "time / first", "interval", "median", "groups"].map(str::to_string);
    let row = |place: &Place| {
        let [ratio, interval, median, groups, _] = cells(place);
        vec![place.schedule.clone(), ratio, interval, median, groups]
    };
    let rows: Vec<Vec<String>> = image.places.iter().map(row).collect();
    format!("% {}\n{}", title(image), tabular(&heads, &rows))
}

fn table(image: &ImageRanking) -> String {
    let width = image.places.iter().map(|place| letters(&place.groups).len()).max().unwrap_or(0).max("groups".len());
    let head = format!("{:>12} {:>16} {:>11}  {:width$}  schedule", "time / first", "interval", "median", "groups");
    let line = |place: &Place| {
        let [ratio, interval, median, groups, schedule] = cells(place);
        format!("{ratio:>12} {interval:>16} {median:>11}  {groups:width$}  {schedule}")
    };
    let lines = [title(image), head].into_iter().chain(image.places.iter().map(line));
    lines.chain([fastest(image)]).collect::<Vec<_>>().join("\n")
}

fn in_markdown(image: &ImageRanking) -> String {
    let heads = ["time / first", "interval", "median", "groups", "schedule"];
    let table = markdown::table(heads, image.places.iter().map(cells));
    format!("### {}\n\n{table}\n\n{}", title(image), fastest(image))
}

/// Ratio, interval, median, letters and name of a schedule.
fn cells(place: &Place) -> [String; 5] {
    let interval = place.interval.map_or_else(|| "-".to_string(), |i| format!("{:.3} to {:.3}", i.low, i.high));
    let ratio = place.ratio.map_or_else(|| "-".to_string(), |ratio| format!("{ratio:.3}"));
    let median = format!("{:.1} ms", 1e3 * place.median_s);
    [ratio, interval, median, letters(&place.groups), printable(&place.schedule).into_owned()]
}

fn title(image: &ImageRanking) -> String {
    let [part, parts] = image.part;
    let of_part = if parts > 1 { format!(", part {part} of {parts}") } else { String::new() };
    format!("{}{of_part}", printable(&image.image))
}

/// Which schedules may be the fastest, in a sentence.
fn fastest(image: &ImageRanking) -> String {
    let ImageRanking { fastest, compared, places, .. } = image;
    let of = if *compared < places.len() {
        format!("{compared} (the matrix of the others has fewer repetitions)")
    } else {
        "them".to_string()
    };
    match (*compared, fastest.len()) {
        _ if places.len() == 1 => "no other schedule was measured with it".to_string(),
        (0 | 1, _) => "too few schedules have all repetitions to determine the fastest".to_string(),
        (_, 0) => format!("each of {of} is slower than another one"),
        (all, left) if left == all => format!("any of {of} may be the fastest"),
        _ => format!("with 95 % confidence, the fastest of {of} is among: {}", printable(&fastest.join(", "))),
    }
}

/// The letter of a group: a to z, then aa, ab and so on.
fn letter(group: usize) -> String {
    let last = char::from(b'a' + (group % 26) as u8);
    if group < 26 { last.to_string() } else { format!("{}{last}", letter(group / 26 - 1)) }
}

/// The letters of an entry's groups: entries that share a letter cannot be told apart.
pub(super) fn letters(groups: &[usize]) -> String {
    groups.iter().map(|group| letter(*group)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_has_its_letter() {
        let found: Vec<String> = [0, 1, 25, 26, 27, 51, 52, 701, 702].into_iter().map(letter).collect();
        assert_eq!(found, ["a", "b", "z", "aa", "ab", "az", "ba", "zz", "aaa"]);
        assert_eq!(letters(&[0, 2]), "a c");
    }
}
