//! `pathmark claims`: the claims of the four reports, or of a ledger of one's own, beside the measurements.

use super::plan_of_claims::plan;
use super::prelude::*;
use crate::console::markdown;
use crate::report::claims::{self, Agreement, Answer, Listing, Report, check_files, judge};

/// `pathmark claims out --report A`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders that `reproduce` or `run` wrote, each a run. Of several, all with rows under the report's conditions count; their order does not matter
    #[arg(default_value = "out", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Also write all verdicts into this folder, as CLAIMS.md and claims/claims.csv. Files that answer more claims are kept
    #[arg(long, value_name = "DIR", conflicts_with = "report")]
    out: Option<PathBuf>,
    /// Print only the claims of this report
    #[arg(long, value_name = "LETTER")]
    report: Option<String>,
    /// Judge the claims and findings of this file, or of all .toml files in this folder, instead of the four reports'. With
    /// `--out`, its name is that of the files: FINDINGS.md and claims/findings.csv for findings.toml
    #[arg(long, value_name = "FILE|DIR")]
    ledger: Option<PathBuf>,
    /// Print for each claim the command that measures its rows, with seconds and bytes, and judge none; run only a pilot
    #[arg(long, conflicts_with_all = ["out", "strict", "markdown"])]
    plan: bool,
    /// Say instead how far these results agree with those in DIR and in its folder `reports`: images bit for bit, the
    /// findings of DIR/findings.toml by their intervals, claims by their verdicts. Other bits exit with code 1
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "report", "ledger", "strict"])]
    compare: Option<PathBuf>,
    #[command(flatten)]
    form: Form,
    /// Exit with code 1 if a verdict differs from the expected one, if its bound is not older than the rows that it judges, or
    /// if no rows answer a claim of the ledger that does not expect this
    #[arg(long)]
    strict: bool,
}

/// The form of what is printed.
#[derive(Args)]
#[group(multiple = false)]
struct Form {
    /// Print an array of objects
    #[arg(long)]
    json: bool,
    /// Print the text that `--out` writes; with `--compare` a table
    #[arg(long)]
    markdown: bool,
}

/// A verdict for other programs.
#[derive(Serialize)]
struct Row<'a> {
    claim: u32,
    report: &'a str,
    says: &'a str,
    verdict: &'static str,
    expected: &'a str,
    measured: String,
    /// The measured value, the ends of its interval and their confidence, with all digits.
    value: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    level: Option<f64>,
    /// The rule that made the value and its interval, with the number of units.
    rule: String,
    predicted: String,
    why: &'a str,
    runs: String,
    to_settle: String,
    age: &'static str,
    source: Option<String>,
    /// The report's words and their place.
    quote: &'a str,
    place: &'a str,
    /// The time at which the claim was fixed.
    frozen: &'a str,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    if let Some(earlier) = &arguments.compare {
        return compare(arguments, earlier, lab);
    }
    let (mut reports, listing) = match &arguments.ledger {
        None => (Report::all(lab)?, Listing::of_reports()),
        Some(path) => {
            let ledgers = Report::read(path)?;
            let listing = Listing::of_ledgers(path, &ledgers);
            (ledgers, listing)
        }
    };
    if let Some(letter) = &arguments.report {
        let known: Vec<String> = reports.iter().map(|report| report.report.clone()).collect();
        reports.retain(|report| report.report == *letter);
        if reports.is_empty() {
            return Err(InputError::new("report", letter, "there is no such report").allowed(known.join(", ")).into());
        }
    }
    if arguments.plan {
        return plan(lab, &reports, &arguments.folders, arguments.form.json);
    }
    check_folders(arguments)?;
    if let Some(out) = &arguments.out {
        listing.enter("out", out, &mut Files::default(), &reports)?;
    }
    let answers = judge(lab, &reports, &arguments.folders)?;
    check_files(&answers, arguments.strict)?;
    if let Some(out) = &arguments.out {
        listing.check_no_loss("out", &answers, out)?;
        create_folder("out", out)?;
        listing.save(&answers, out)?;
    }
    if arguments.form.json {
        print_json(&answers.iter().map(row).collect::<Vec<_>>())?;
    } else if arguments.form.markdown {
        print(listing.markdown_of(&answers, Path::new(".")).trim_end())?;
    } else {
        print(&answers.iter().map(line).collect::<Vec<String>>().join("\n"))?;
        print(&format!("\n{} claims: {}", answers.len(), claims::totals(&answers)))?;
    }
    let of = |is_wrong: &dyn Fn(&Answer<'_>) -> bool, problem: &str| {
        let wrong: Vec<String> = answers.iter().filter(|a| is_wrong(a)).map(|a| a.claim.id.to_string()).collect();
        (!wrong.is_empty()).then(|| format!("claims {} {problem}", wrong.join(", ")))
    };
    let problems = [
        of(&|answer| answer.is_unexpected(), "have unexpected verdicts"),
        of(&|answer| answer.is_bound_younger(), "have bounds that are not older than the rows that they judge"),
        of(&|answer| answer.is_unanswered(), "have no rows that answer them"),
    ];
    let problems: Vec<String> = problems.into_iter().flatten().collect();
    if arguments.strict && !problems.is_empty() {
        return Err(Error::Check(problems.join("; ")));
    }
    Ok(())
}

fn check_folders(arguments: &Arguments) -> Result<()> {
    for folder in &arguments.folders {
        if !folder.is_dir() {
            return Err(InputError::new("folder", folder.display().to_string(), "there is no such folder").into());
        }
    }
    Ok(())
}

/// Prints how the folders agree with earlier results.
fn compare(arguments: &Arguments, earlier: &Path, lab: &Arc<Lab>) -> Result<()> {
    check_folders(arguments)?;
    if !earlier.is_dir() {
        return Err(InputError::new("compare", earlier.display().to_string(), "there is no such folder").into());
    }
    let found = Agreement::of(lab, &arguments.folders, earlier)?;
    if arguments.form.json {
        print_json(&found)?;
    } else if arguments.form.markdown {
        let table = markdown::table(["compared", "in both", "agree", "missing here"], found.table());
        print(&format!("{table}\n\n{}", found.in_words().replace('\n', "\n\n")))?;
    } else {
        print(&found.in_words())?;
    }
    match found.other_images() {
        [] => Ok(()),
        [first, ..] => {
            let count = counted(found.other_images().len(), "image");
            Err(Error::Check(format!("{count} with other bits, for example {first}")))
        }
    }
}

fn row<'a>(answer: &'a Answer<'_>) -> Row<'a> {
    let interval = answer.interval();
    Row {
        claim: answer.claim.id,
        report: &answer.report.report,
        says: &answer.claim.claim,
        verdict: answer.verdict.name(),
        expected: &answer.claim.expected,
        measured: answer.measured(),
        value: answer.value(),
        low: interval.map(|interval| interval.low),
        high: interval.map(|interval| interval.high),
        level: interval.map(|interval| interval.level),
        rule: answer.rule(),
        predicted: answer.predicted(),
        why: &answer.why,
        runs: answer.in_runs(),
        to_settle: answer.settled_by(),
        age: answer.age(),
        source: answer.source(),
        quote: &answer.claim.quote,
        place: &answer.claim.place,
        frozen: answer.claim.frozen_utc(),
    }
}

fn line(answer: &Answer<'_>) -> String {
    let claim = answer.claim;
    let numbers = match answer.source() {
        Some(_) => format!("{}, predicted {}; {}", answer.measured(), answer.predicted(), answer.rule()),
        None => String::new(),
    };
    let notes = [answer.in_runs(), answer.settled_by(), answer.age().to_string()];
    let notes: Vec<String> = notes.into_iter().filter(|note| !note.is_empty()).collect();
    let more = [numbers, notes.join("; "), answer.why.clone()].into_iter().filter(|line| !line.is_empty());
    let head = format!("{:>3} {}  {:15} {}", claim.id, answer.report.report, answer.verdict.to_string(), claim.claim);
    std::iter::once(head).chain(more).collect::<Vec<String>>().join("\n        ")
}
