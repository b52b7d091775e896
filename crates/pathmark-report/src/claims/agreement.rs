//! Agreement of results with earlier ones: images bit for bit, findings by their intervals, claims by their verdicts.

use super::definition::Report;
use super::judge::{Answer, judge};
use super::measurement::{Measurement, Scale};
use super::verdict::Verdict;
use crate::analysis::Interval;
use crate::class::{Member, members};
use crate::error::Result;
use crate::experiment::{ImageBits, SameBits, read_records, records_path};
use crate::lab::Lab;
use crate::words::counted;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The ledger of findings in a folder of results.
const FINDINGS: &str = "findings.toml";
/// The folder within it that has the rows of the profile `--reports`.
const REPORTS: &str = "reports";

/// Things that both results have: how many there are, and those that differ.
#[derive(Debug, Default, Serialize)]
struct Shared {
    in_both: usize,
    /// Each in a line.
    differing: Vec<String>,
    /// How many the earlier results have and these lack.
    lacking: usize,
}

impl Shared {
    fn agreeing(&self) -> usize {
        self.in_both - self.differing.len()
    }
}

/// How results agree with earlier ones.
#[derive(Debug, Serialize)]
pub struct Agreement {
    rows: usize,
    experiments: usize,
    images: Shared,
    findings: Shared,
    /// Findings whose intervals do not overlap, but lie on the same side of 1: another size of the same effect.
    same_side: Vec<String>,
    verdicts: Shared,
    earlier: PathBuf,
}

/// How a finding was measured twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Twice {
    Overlapping,
    /// Both ratios are above 1, or both below, by other factors: machines differ in this.
    SameSide,
    Differing,
}

impl Twice {
    /// `None` if one of the two has no interval.
    fn of(own: &Measurement, earlier: &Measurement) -> Option<Self> {
        let (a, b) = (own.interval?, earlier.interval?);
        let is_ratio = own.scale == Scale::Logarithmic;
        let both = |holds: fn(&Interval) -> bool| is_ratio && holds(&a) && holds(&b);
        Some(if a.low <= b.high && b.low <= a.high {
            Self::Overlapping
        } else if both(|own| own.low > 1.0) || both(|own| own.high < 1.0) {
            Self::SameSide
        } else {
            Self::Differing
        })
    }
}

impl Agreement {
    /// Compares the results in some folders with those in an earlier folder and in its folder `reports`.
    pub fn of(lab: &Arc<Lab>, folders: &[PathBuf], earlier: &Path) -> Result<Self> {
        let reports = Some(earlier.join(REPORTS)).filter(|folder| folder.is_dir());
        let earlier_folders: Vec<PathBuf> = std::iter::once(earlier.to_path_buf()).chain(reports).collect();
        let (own, theirs) = (Images::read(folders)?, Images::read(&earlier_folders)?);
        let claims = Report::all(lab)?;
        let ledger = earlier.join(FINDINGS);
        let ledger = if ledger.is_file() { Report::read(&ledger)? } else { Vec::new() };
        let (findings, same_side) = of_findings(&twice(lab, &ledger, [folders, &earlier_folders])?);
        Ok(Self {
            rows: own.rows,
            experiments: own.experiments,
            images: own.compare(&theirs),
            findings,
            same_side,
            verdicts: of_verdicts(&twice(lab, &claims, [folders, &earlier_folders])?),
            earlier: earlier.to_path_buf(),
        })
    }

    /// The images that have other bits.
    pub fn other_images(&self) -> &[String] {
        &self.images.differing
    }

    /// How many images, findings and verdicts both results have, how many of them agree, and how many these lack.
    pub fn table(&self) -> [[String; 4]; 3] {
        let row = |name: &str, own: &Shared| {
            [name.to_string(), own.in_both.to_string(), own.agreeing().to_string(), own.lacking.to_string()]
        };
        [row("images", &self.images), row("findings", &self.findings), row("verdicts", &self.verdicts)]
    }

    /// A line for each finding and each verdict that is another one, and one sentence.
    pub fn in_words(&self) -> String {
        let Self { rows, experiments, images, findings, same_side, verdicts, earlier } = self;
        let earlier = earlier.display();
        let agreeing = |own: &Shared| format!("{} of {}", own.agreeing(), own.in_both);
        let overlapping = findings.agreeing() - same_side.len();
        let more = match (findings.lacking, verdicts.lacking) {
            (0, 0) => "More rows would add nothing to this comparison.".to_string(),
            (findings, verdicts) => format!(
                "With the rows of both `pathmark reproduce` and `pathmark reproduce --reports`, {} and {} more could be compared.",
                counted(findings, "finding"),
                counted(verdicts, "verdict")
            ),
        };
        let sentence = format!(
            "{} of {} agree with {earlier} in {} images, bit for bit, in {} findings ({overlapping} with overlapping intervals, {} on the same side \
             of 1) and in {} verdicts on claims. {more}",
            counted(*rows, "row"),
            counted(*experiments, "experiment"),
            agreeing(images),
            agreeing(findings),
            same_side.len(),
            agreeing(verdicts),
        );
        let lines = findings.differing.iter().chain(same_side).chain(&verdicts.differing).cloned();
        lines.chain([sentence]).collect::<Vec<String>>().join("\n")
    }
}

/// The images in some folders of results.
#[derive(Default)]
struct Images {
    rows: usize,
    experiments: usize,
    bits: ImageBits,
}

impl Images {
    fn read(folders: &[PathBuf]) -> Result<Self> {
        let mut all = Self::default();
        for out in folders {
            for Member { folder, .. } in members(out)? {
                let rows = read_records(&records_path(&folder))?;
                all.experiments += 1;
                all.rows += rows.iter().filter(|row| row.error.is_empty()).count();
                all.bits.add(&rows);
            }
        }
        Ok(all)
    }

    fn compare(&self, earlier: &Self) -> Shared {
        let mut found = Shared::default();
        for (image, bits) in self.bits.beside(&earlier.bits) {
            match bits {
                SameBits::Lacking => {
                    found.lacking += 1;
                    continue;
                }
                SameBits::Other(how) => found.differing.push(format!("{image}: {how}")),
                SameBits::Same => {}
            }
            found.in_both += 1;
        }
        found
    }
}

/// The answers of both results to the same claims.
fn twice<'a>(lab: &Arc<Lab>, reports: &'a [Report], [own, earlier]: [&[PathBuf]; 2]) -> Result<[Vec<Answer<'a>>; 2]> {
    Ok([judge(lab, reports, own)?, judge(lab, reports, earlier)?])
}

fn pairs<'a, 'b>([own, earlier]: &'b [Vec<Answer<'a>>; 2]) -> impl Iterator<Item = (&'b Answer<'a>, &'b Answer<'a>)> {
    own.iter().zip(earlier)
}

fn of_findings(answers: &[Vec<Answer<'_>>; 2]) -> (Shared, Vec<String>) {
    let (mut found, mut same_side) = (Shared::default(), Vec::new());
    for (own, earlier) in pairs(answers).filter(|(_, earlier)| earlier.verdict == Verdict::Measured) {
        let measured = own.found.as_ref().filter(|_| own.verdict == Verdict::Measured);
        let Some(twice) = measured.zip(earlier.found.as_ref()).and_then(|(own, earlier)| Twice::of(own, earlier))
        else {
            found.lacking += 1;
            continue;
        };
        found.in_both += 1;
        let told = |how: &str| {
            let (here, there) = (own.measured(), earlier.measured());
            format!("finding {}, {}: {here} here, {there} there, {how}", own.claim.id, own.claim.claim)
        };
        match twice {
            Twice::Overlapping => {}
            Twice::SameSide => same_side.push(told("on the same side of 1")),
            Twice::Differing => found.differing.push(told("which differ")),
        }
    }
    (found, same_side)
}

fn of_verdicts(answers: &[Vec<Answer<'_>>; 2]) -> Shared {
    let mut found = Shared::default();
    for (own, earlier) in pairs(answers).filter(|(_, earlier)| earlier.is_judged()) {
        if !own.is_judged() {
            found.lacking += 1;
            continue;
        }
        found.in_both += 1;
        if own.verdict != earlier.verdict {
            let (id, says) = (own.claim.id, &own.claim.claim);
            found.differing.push(format!("claim {id}, {says}: {} here, {} there", own.verdict, earlier.verdict));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::confidence_sequence::Stopping;

    fn twice(own: [f64; 2], earlier: [f64; 2], scale: Scale) -> Option<Twice> {
        let of = |ends: [f64; 2]| Measurement::typical(&ends, scale, Stopping::Fixed, 0.95, "repetition").unwrap();
        // Two equal values have no error.
        Twice::of(&of(own), &of(earlier))
    }

    #[test]
    fn two_measurements_overlap_point_the_same_way_or_differ() {
        let of = |own, earlier| twice([own, own], [earlier, earlier], Scale::Logarithmic);
        assert_eq!(of(1.9, 1.9), Some(Twice::Overlapping));
        assert_eq!(of(1.9, 1.2), Some(Twice::SameSide));
        assert_eq!(of(0.9, 0.2), Some(Twice::SameSide));
        assert_eq!(of(1.9, 0.9), Some(Twice::Differing));
        assert_eq!(of(1.0, 1.2), Some(Twice::Differing), "no effect is no smaller effect");
        assert_eq!(
            twice([1.9, 1.9], [1.2, 1.2], Scale::Linear),
            Some(Twice::Differing),
            "1 is nothing to a difference"
        );
        assert_eq!(twice([0.5, 4.0], [1.9, 1.9], Scale::Logarithmic), Some(Twice::Overlapping), "a wide interval");
        let one = Measurement::typical(&[2.0], Scale::Linear, Stopping::Fixed, 0.95, "repetition").unwrap();
        assert_eq!(Twice::of(&one, &one), None, "a single value has no interval");
    }
}
