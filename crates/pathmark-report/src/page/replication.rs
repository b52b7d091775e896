//! The verdicts of a replication: `replication.json`, which `replicate` writes. Their words are also those of the text
//! `REPLICATION.md`.

use crate::block::Block;
use crate::error::Result;
use crate::experiment::{Kind, REPLICATION, Replication, Reproduction, Statement};
use crate::page::Section;
use crate::words::{capital, counted};
use std::collections::BTreeMap;
use std::path::Path;

const QUESTION: &str = "Which ratios, orders, slopes and images of these rows come out here, too?";

/// The heads of [`cells`].
pub const HEADS: [&str; 8] = ["experiment", "kind", "statement", "theirs", "here", "difference", "verdict", "note"];

/// The section, if a folder is one of a replication.
pub(crate) fn section(out: &Path) -> Result<Option<Section>> {
    let path = out.join(REPLICATION);
    if !path.is_file() {
        return Ok(None);
    }
    let found = Replication::read(&path)?;
    let mut table = Block::table("statements", "Statements and verdicts", sorted(&found).into_iter().map(cells));
    for (at, head) in HEADS.into_iter().enumerate() {
        table = table.column(head, move |cells| cells[at].clone());
    }
    let machines = Block::table("machines", "The machines side by side", &found.machines)
        .column("fact", |fact| fact.name.clone())
        .column("theirs", |fact| fact.theirs.clone())
        .column("here", |fact| fact.here.clone())
        .end();
    let notices = notices(&found).into_iter().map(Block::notice);
    let blocks = [Block::finding(sentence(&found))].into_iter().chain(notices).chain([table.end(), machines]);
    Ok(Some(Section {
        name: "replication".to_string(),
        title: format!("Replication of {}", found.theirs),
        question: QUESTION.to_string(),
        analysis: rule(&found),
        in_short: Some(sentence(&found)),
        rows: found.statements.len(),
        blocks: blocks.collect(),
        ..Section::default()
    }))
}

/// The number of statements with each verdict, in a sentence.
pub fn sentence(found: &Replication) -> String {
    let count = |name: &str| found.statements.iter().filter(|own| own.verdict.name() == name).count();
    let counts: Vec<String> =
        Reproduction::NAMES.into_iter().rev().map(|name| format!("{} {name}", count(name))).collect();
    format!("{} of {}: {}.", counted(found.statements.len(), "statement"), found.theirs, counts.join(", "))
}

/// The meaning of the verdicts.
pub fn rule(found: &Replication) -> String {
    let percent = |share: f64| (1e4 * share + 1e-6).floor() / 100.0;
    format!(
        "Ratios of times and exponents count as reproduced if they differ by less than {} %. Orders are stated where times \
         differ by more; those that both sides are sure of must agree. With {} % confidence, no verdict on these is wrong: \
         each has {} % (Bonferroni's inequality). A ratio or an order is *not reproduced* only if a second measurement \
         differs in the same way. Images are compared bit for bit. Seconds are not compared.",
        percent(found.share),
        percent(found.joint_level),
        percent(found.level),
    )
}

/// Two versions of the program, and why there are no rows here, each reason with the number of statements.
pub fn notices(found: &Replication) -> Vec<String> {
    let of_versions = |[theirs, here]: [&str; 2]| {
        format!(
            "Other sources: a program of {theirs} measured their rows, and one of {here} those here. A difference of \
             times may come from the program."
        )
    };
    let mut reasons: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for verdict in found.statements.iter().map(|own| &own.verdict).filter(|verdict| !verdict.lacks().is_empty()) {
        *reasons.entry(verdict.name()).or_default().entry(verdict.lacks()).or_default() += 1;
    }
    let lacking = reasons.into_iter().map(|(name, reasons)| {
        let told = reasons.into_iter().map(|(why, count)| format!("{why} ({})", counted(count, "statement")));
        format!("{}: {}.", capital(name), told.collect::<Vec<String>>().join("; "))
    });
    found.versions().map(of_versions).into_iter().chain(lacking).collect()
}

/// The statements, those first that are not reproduced.
pub fn sorted(found: &Replication) -> Vec<&Statement> {
    let mut sorted: Vec<&Statement> = found.statements.iter().collect();
    sorted.sort_by_key(|own| Reproduction::NAMES.iter().position(|name| *name == own.verdict.name()));
    sorted
}

/// A statement as a row of a table.
pub fn cells(own: &Statement) -> [String; 8] {
    let value = |value: Option<f64>, interval: Option<[f64; 2]>| match (value, interval) {
        (None, _) => "-".to_string(),
        (Some(count), _) if own.kind == Kind::Order => counted(count as usize, "order"),
        (Some(value), None) => format!("{value:.3}"),
        (Some(value), Some([low, high])) => format!("{value:.3} ({low:.3} to {high:.3})"),
    };
    let difference = own.difference.map(|[middle, low, high]| (middle, [low, high]));
    let note = match &own.verdict {
        _ if !own.note.is_empty() => own.note.clone(),
        Reproduction::CannotTell(Some(more)) => counted(*more, &format!("more {}", own.kind.unit())),
        Reproduction::CannotTell(None) if own.kind == Kind::Order => "the times here are too close".to_string(),
        Reproduction::CannotTell(None) => "theirs are too few, or the difference lies at the limit".to_string(),
        verdict => verdict.lacks().to_string(),
    };
    [
        own.experiment.clone(),
        own.kind.name().to_string(),
        own.says.clone(),
        value(own.theirs, own.theirs_interval),
        value(own.here, own.here_interval),
        value(difference.map(|(middle, _)| middle), difference.map(|(_, ends)| ends)),
        own.verdict.name().to_string(),
        note,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::MachineFact;

    fn statement(kind: Kind, verdict: Reproduction) -> Statement {
        Statement {
            experiment: "e".to_string(),
            kind,
            says: "time of a over b, cornell".to_string(),
            theirs: Some(1.5),
            theirs_interval: Some([1.4, 1.6]),
            here: Some(1.51),
            here_interval: None,
            difference: Some([1.0, 0.9, 1.1]),
            verdict,
            note: String::new(),
        }
    }

    fn replication() -> Replication {
        let [failed, lacking] = ["no such kernel", "64 threads instead of 2"].map(str::to_string);
        Replication {
            theirs: "results/<b>".to_string(),
            share: 0.1,
            joint_level: 0.95,
            level: 0.999_999,
            machines: [["processor", "large", "small"], ["Pathmark's sources", "abc", "def"]]
                .map(|fact| fact.map(str::to_string))
                .map(|[name, theirs, here]| MachineFact { name, theirs, here })
                .into(),
            statements: vec![
                statement(Kind::Ratio, Reproduction::Reproduced),
                statement(Kind::Slope, Reproduction::CannotTell(Some(1))),
                statement(Kind::Order, Reproduction::NotReproduced),
                statement(Kind::Image, Reproduction::OtherHardware(lacking)),
                statement(Kind::Image, Reproduction::NotMeasured(failed)),
            ],
        }
    }

    #[test]
    fn a_replication_is_a_section_with_its_counts_and_both_machines() {
        let folder = tempfile::tempdir().unwrap();
        assert!(section(folder.path()).unwrap().is_none());
        let path = folder.path().join(REPLICATION);
        replication().write(&path).unwrap();
        let found = section(folder.path()).unwrap().unwrap();
        let expected = "5 statements of results/<b>: 1 reproduced, 1 other hardware, 1 not measured, 1 cannot tell, 1 not reproduced.";
        assert_eq!((found.in_short.as_deref(), found.blocks[0].as_finding()), (Some(expected), Some(expected)));
        assert!(found.analysis.contains("less than 10 %") && found.analysis.contains("each has 99.99 %"));
        let is_told = |at: usize, said: &str| matches!(&found.blocks[at], Block::Notice(text) if text.contains(said));
        assert!(is_told(1, "a program of abc measured their rows, and one of def those here"));
        assert!(is_told(2, "Not measured: no such kernel (1 statement)."));
        assert!(is_told(3, "Other hardware: 64 threads instead of 2 (1 statement)."));
        let html = crate::page::html(&[found]).unwrap();
        let place = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text}: {html}"));
        let order = [
            "Replication of results/&lt;b&gt;",
            "data-verdict=\"not reproduced\"",
            "data-verdict=\"cannot tell\"",
            "1 more seed",
            "data-verdict=\"not measured\"",
            "no such kernel",
            "data-verdict=\"other hardware\"",
            "data-verdict=\"reproduced\"",
            "The machines side by side",
            ">large<",
            ">small<",
        ];
        assert!(order.map(place).is_sorted(), "{html}");
        std::fs::write(&path, "{}").unwrap();
        let error = section(folder.path()).err().unwrap();
        assert!(error.exit_code() == 2 && error.to_string().contains("replication.json"), "{error}");
    }

    #[test]
    fn values_have_their_intervals_and_orders_are_counted() {
        let [_, _, _, theirs, here, difference, ..] = cells(&statement(Kind::Ratio, Reproduction::Reproduced));
        assert_eq!([theirs, here, difference], ["1.500 (1.400 to 1.600)", "1.510", "1.000 (0.900 to 1.100)"]);
        let order =
            Statement { theirs: Some(40.0), here: Some(1.0), ..statement(Kind::Order, Reproduction::Reproduced) };
        assert_eq!(cells(&order)[3..5], ["40 orders", "1 order"]);
        let other =
            Statement { note: "checksum a instead of b".into(), ..statement(Kind::Image, Reproduction::NotReproduced) };
        assert_eq!(cells(&other)[7], "checksum a instead of b");
        let second =
            Statement { note: "a second one".into(), ..statement(Kind::Ratio, Reproduction::CannotTell(None)) };
        assert_eq!(cells(&second)[7], "a second one");
    }
}
