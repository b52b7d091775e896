//! Faults of ledgers that users write: each is told with its place and the allowed values.

use super::plain_rows_tests::{folder, ledger, sorts};
use super::*;
use crate::files::Files;
use std::path::PathBuf;

const STARTER: &str = include_str!("../../../pathmark-cli/assets/starter-claims.toml");
const RATIO: &str = "statistic = \"paired-ratio\"\ncolumn = \"seconds\"\nrows = { program = \"bubble\" }\n\
                     over = { program = \"quick\" }\nat-least = 2";

fn refused(text: &str) -> String {
    Report::from_text("s.toml", text).map_or_else(|error| error.to_string(), |report| format!("accepted: {report:?}"))
}

/// A text with one part replaced, and the beginning of an error about the first line that begins with `of`.
fn changed(text: &str, [from, to]: [&str; 2], of: &str) -> (String, String) {
    assert!(text.contains(from), "{from}\n{text}");
    let text = text.replacen(from, to, 1);
    let at = text.lines().position(|line| line.starts_with(of)).unwrap_or_else(|| panic!("{of}\n{text}"));
    (text, format!("s.toml:{}:", at + 1))
}

/// The starter has comments behind its values, and an editor may write the line ends of Windows.
#[test]
fn faults_of_a_ledger_from_the_starter_are_told_with_their_lines() {
    let with_table = STARTER.lines().map(|line| {
        line.strip_prefix("# ").filter(|own| own.starts_with(['[', 'n', 'f', 's', 'v', 'r'])).unwrap_or(line)
    });
    assert!(Report::from_text("s.toml", &with_table.collect::<Vec<&str>>().join("\n")).is_ok(), "a table in comments");
    for text in [STARTER.to_string(), STARTER.replace('\n', "\r\n"), STARTER.replace("id = 1 ", "id=1 ")] {
        assert!(Report::from_text("s.toml", &text).is_ok());
        for (change, of, told) in [
            (["level = 0.95", "level = 95"], "level =", "level = 95: is not a confidence"),
            (
                ["at-least", "at-lest"],
                "at-lest",
                "field = at-lest: a claim with the statistic speedup has no such field; did you mean at-least?",
            ),
            (["quote =", "qoute ="], "qoute", "did you mean quote?"),
            (["quote =", "# quote ="], "id", "has no `quote`"),
            (["strategy = \"serial\"", "stratgy = \"serial\""], "over =", "over = stratgy"),
            (["\"speedup\"", "\"speedups\""], "statistic", "statistic = speedups"),
            (["T12:00:00Z", "T25:00:00Z"], "frozen", "does not begin with a time"),
            (["\"confirmed\"", "\"confirm\""], "expected", "expected = confirm"),
            (["reason = \"", "note = \""], "id", "no reason"),
        ] {
            let (text, place) = changed(&text, change, of);
            let error = refused(&text);
            assert!(error.starts_with(&place) && error.contains(told), "{change:?}\n{place} {told}\n{error}");
        }
    }
}

#[test]
fn fields_that_no_claim_has_are_named_beside_those_that_there_are() {
    let text = ledger(RATIO);
    for (change, of, told) in [
        (["at-least", "at-lest"], "at-lest", ["did you mean at-least?", "comparable-if"]),
        (["column", "colum"], "colum =", ["did you mean column?", "over"]),
        (["statistic", "statistc"], "statistc", ["did you mean statistic?", "without a statistic"]),
        (["level = 0.95", "level = 0.95\nx = \"n\""], "x =", ["field = x", "paired-ratio has no such field"]),
        (["reason", "a_fortiori = true\nreason"], "a_fortiori", ["did you mean a-fortiori?", "field"]),
    ] {
        let (text, place) = changed(&text, change, of);
        let error = refused(&text);
        assert!(error.starts_with(&place) && told.iter().all(|word| error.contains(word)), "{change:?}\n{error}");
    }
}

#[test]
fn tables_are_named_once_and_claims_ask_for_them_by_name() {
    let text = ledger(RATIO);
    let (wrong, place) = changed(&text, ["experiment = \"sorts\"", "experiment = \"sort\""], "experiment =");
    let error = refused(&wrong);
    let told = "experiment = sort: is no table of this ledger, and rows of an experiment have no column seconds; \
                did you mean sorts? (allowed: sorts)";
    // `rows` is checked first, and `program` is its column.
    assert!(error.starts_with(&place) && error.contains(&told.replace("seconds", "program")), "{error}");
    // A wrong column of an experiment's rows is the column's fault.
    let of_experiment = wrong.replace("\"seconds\"\nrows", "\"second\"\nrows").replace("program", "strategy");
    let error = refused(&of_experiment.replace("settings = [\"strategy\", \"n\"]", "settings = [\"n\"]"));
    assert!(error.contains("column = second: there is no such column in records.csv"), "{error}");
    let twice = text.replacen(
        "[[claim]]",
        "[[table]]\nname = \"sorts\" # again\nfile = \"other.csv\"\nsettings = []\nvalues = []\n[[claim]]",
        1,
    );
    let error = refused(&twice);
    assert!(error.starts_with("s.toml:12:8: name = sorts: is the name of two tables"), "{error}");
}

#[test]
fn numbers_and_names_that_mean_nothing_are_refused() {
    let text = ledger(RATIO);
    let within = |ends: &'static str| ["at-least = 2", ends];
    for (change, of, told) in [
        (within("at-least = nan"), "at-least", ["at-least = NaN", "a finite number"]),
        (within("at-most = inf"), "at-most", ["at-most = inf", "a finite number"]),
        (within("within = [-inf, 2]"), "within", ["within = -inf", "a finite number"]),
        (within("within = [2, 1]"), "within", ["within = [2, 1]", "[low, high]"]),
        (["id = 1", "id = 0"], "id = 0", ["id = 0", "1 to 4294967295"]),
        (["id = 1", "id = -1"], "id = -1", ["id = -1", "u32"]),
        (["report = \"S\"", "report = \"\""], "report", ["report: is not one line", "a name"]),
        (["title = \"Sorting\"", "title = \" \""], "title", ["title", "a name"]),
        (["title = \"Sorting\"", "title = \"a\\nb\""], "title", ["title", "a name"]),
        (["claim = \"c\"", "claim = \"\""], "claim = \"\"", ["claim: is empty", "the sentence"]),
    ] {
        let (text, place) = changed(&text, change, of);
        let error = refused(&text);
        assert!(error.starts_with(&place) && told.iter().all(|word| error.contains(word)), "{change:?}\n{error}");
    }
    let none = refused("report = \"S\"\ntitle = \"T\"\nabout = \"A\"\nclaim = []\n");
    assert!(none.starts_with("s.toml:4:1: claim: there is none (allowed: one [[claim]]"), "{none}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twice.toml");
    let claim = text.split_once("[[claim]]").unwrap().1;
    std::fs::write(&path, format!("{text}[[claim]]{claim}")).unwrap();
    let error = Report::read(&path).unwrap_err().to_string();
    assert!(error.contains("twice.toml:28:6: id = 1: occurs twice"), "{error}");
}

/// The answers to a user's ledger about `sorts.csv`, or the error.
fn answers(evidence: &str, folders: &[&tempfile::TempDir], is_strict: bool) -> std::result::Result<String, String> {
    let own = tempfile::tempdir().unwrap();
    let path = own.path().join("s.toml");
    std::fs::write(&path, ledger(evidence)).unwrap();
    let reports = Report::read(&path).map_err(|error| error.to_string())?;
    let folders: Vec<PathBuf> = folders.iter().map(|folder| folder.path().to_path_buf()).collect();
    let answers = judge(&Lab::built_in(), &reports, &folders).map_err(|error| error.to_string())?;
    check_files(&answers, is_strict).map_err(|error| error.to_string())?;
    Ok(format!("{} {} {}", answers[0].verdict, answers[0].is_unanswered(), answers[0].why))
}

#[test]
fn values_that_no_row_has_are_refused() {
    let own = folder(&sorts());
    for (change, line, told) in [
        (
            ["\"bubble\"", "\"buble\""],
            24,
            "rows.program = buble: occurs in no row of the table sorts; did you mean bubble? (allowed: bubble, quick)",
        ),
        (["\"quick\"", "[\"quick\", \"quik\"]"], 25, "over.program = quik"),
        (
            ["\"bubble\" }", "\"bubble\", n = 5 }"],
            24,
            "rows.n = 5: occurs in no row of the table sorts (allowed: 100, 1000, 10000)",
        ),
        (["\"bubble\" }", "\"bubble\", n = \">=1e9\" }"], 24, "rows.n = >=1e9"),
    ] {
        let error = answers(&RATIO.replace(change[0], change[1]), &[&own], false).unwrap_err();
        assert!(error.contains(&format!("s.toml:{line}:")) && error.contains(told), "{change:?}\n{error}");
    }
    // Each value may be in another folder; conditions of the paper may be met by no row.
    let [bubbles, quicks] = ["quick", "bubble"].map(|other| {
        let rows = sorts();
        let kept = rows.lines().filter(|line| !line.contains(&format!(",{other},")));
        folder(&kept.flat_map(|line| [line, "\n"]).collect::<String>())
    });
    assert!(answers(RATIO, &[&bubbles], false).unwrap_err().contains("over.program = quick"));
    assert!(answers(RATIO, &[&bubbles, &quicks], false).is_ok());
    let unmet = answers(&format!("{RATIO}\ncomparable-if = {{ n = 5 }}"), &[&own], true).unwrap();
    assert!(unmet.starts_with("not comparable false"), "{unmet}");
    // The table has both, and no row has both.
    let rows = RATIO.replace("\"bubble\"", "\"bubble\", n = 7").replace("\"quick\"", "\"quick\", n = 100");
    let unanswered = answers(&rows, &[&folder(&format!("{}7,0,quick,1,\n", sorts()))], true).unwrap();
    assert!(unanswered.starts_with("not answered true"), "{unanswered}");
}

#[test]
fn a_file_that_no_folder_has_is_an_error() {
    let (own, empty) = (folder(&sorts()), tempfile::tempdir().unwrap());
    let error = answers(RATIO, &[&empty], false).unwrap_err();
    assert!(error.contains("s.toml:8:8: file = sorts.csv: is in none of the judged folders"), "{error}");
    assert!(answers(RATIO, &[&empty, &own], true).is_ok());
    // Another table has rows: only `--strict` asks for all.
    let both = format!(
        "{RATIO}\n[[table]]\nname = \"others\"\nfile = \"no.csv\"\nsettings = []\nvalues = [\"s\"]\n[[claim]]\nid = 2\nclaim = \"c\"\n\
                        experiment = \"others\"\nstatistic = \"value\"\ncolumn = \"s\"\nlevel = 0.95\n"
    );
    assert!(answers(&both, &[&own], false).unwrap().starts_with("confirmed"));
    let error = answers(&both, &[&own], true).unwrap_err();
    assert!(error.contains("s.toml:29:8: file = no.csv"), "{error}");
    // The wrong kind of file.
    for (make, told) in [
        ((|path| std::fs::create_dir(path)) as fn(PathBuf) -> std::io::Result<()>, "is a folder"),
        (|path| std::os::unix::fs::symlink("nowhere", path), "is a link to a file that is not there"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        make(folder.path().join("sorts.csv")).unwrap();
        let error = answers(RATIO, &[&folder], false).unwrap_err();
        assert!(error.contains("s.toml:8:8: file = ") && error.contains(told), "{error}");
    }
    let expected = ledger(RATIO).replace("\"confirmed\"", "\"confirmed or not-answered\"");
    let reports = [Report::from_text("s.toml", &expected).unwrap()];
    let answers = judge(&Lab::built_in(), &reports, &[empty.path().to_path_buf()]).unwrap();
    assert!(check_files(&answers, true).is_ok() && !answers[0].is_unanswered());
}

/// A text with our heading that somebody else wrote stays, and so do the verdicts on another report of the same name.
#[test]
fn only_files_of_the_same_ledger_are_replaced() {
    let (own, out) = (folder(&sorts()), tempfile::tempdir().unwrap());
    let save = |text: &str| {
        let reports = [Report::from_text("s.toml", text).unwrap()];
        let answers = judge(&Lab::built_in(), &reports, &[own.path().to_path_buf()]).unwrap();
        let listing = Listing::of_ledgers(&PathBuf::from("s.toml"), &reports);
        listing.enter("out", out.path(), &mut Files::default(), &reports).map_err(|error| error.to_string())?;
        listing.save(&answers, out.path()).unwrap();
        Ok::<(), String>(())
    };
    let (text, table) = (out.path().join("S.md"), out.path().join("claims/s.csv"));
    let prediction = ledger(RATIO);
    let finding = "report = \"S\"\ntitle = \"Sorting\"\nabout = \"Mine.\"\n[[table]]\nname = \"t\"\nfile = \"sorts.csv\"\nsettings = [\"program\", \"n\"]\n\
                   values = [\"seconds\"]\n[[claim]]\nid = 1\nclaim = \"a | b\"\nexperiment = \"t\"\nstatistic = \"value\"\ncolumn = \"seconds\"\nlevel = 0.95\n";
    for ledger in [prediction.as_str(), finding] {
        for theirs in
            ["# Sorting\n\nMy own notes.\n", "# Sorting\n", "# Sorting and more\n\n`pathmark claims` computed", ""]
        {
            std::fs::write(&text, theirs).unwrap();
            let error = save(ledger).unwrap_err();
            assert!(error.contains("S.md: already exists"), "{theirs}\n{error}");
            assert_eq!(std::fs::read_to_string(&text).unwrap(), theirs);
        }
        std::fs::remove_file(&text).unwrap();
        save(ledger).unwrap();
        save(ledger).unwrap();
        let other = ledger.replace("report = \"S\"", "report = \"R\"");
        let error = save(&other).unwrap_err();
        assert!(error.contains("s.csv: has verdicts on the report S"), "{error}");
        std::fs::remove_file(&table).unwrap();
        std::fs::remove_file(&text).unwrap();
    }
}

/// A quotation of two lines with signs of Markdown stays one quotation, and other words stay in their line.
#[test]
fn words_of_the_paper_change_no_text_around_them() {
    let own = folder(&sorts());
    let text = ledger(RATIO)
        .replace("quote = \"q\"", "quote = \"\"\"\nfast & <b>bold</b>\n# not a heading\n\"\"\"")
        .replace("claim = \"c\"", "claim = \"one\\ntwo\"")
        .replace("reported = \"r\"", "reported = \"*2*\\n\\n## x\"");
    let reports = [Report::from_text("s.toml", &text).unwrap()];
    let answers = judge(&Lab::built_in(), &reports, &[own.path().to_path_buf()]).unwrap();
    let shown = Listing::of_ledgers(&PathBuf::from("s.toml"), &reports).markdown_of(&answers, own.path());
    let entry = "### 1. one two\n\n**Confirmed**, in 1 of 1 run\n\n> fast & \\<b>bold\\</b>\n> \\# not a heading (p)\n\n- Reported: \\*2\\* ## x\n";
    assert!(shown.contains(entry), "{shown}");
    assert_eq!(answers[0].value().map(f64::round), Some(1000.0));
    assert!(answers[0].interval().is_some_and(|own| own.low <= 1000.0 + 1e-6 && own.high >= 1000.0 - 1e-6));
}
