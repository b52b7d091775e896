//! The report page in a browser: its script works, and nothing is wider than the screen.
//!
//! Needs a Chromium on the path; without one the test says so and passes, because a browser is no part of Pathmark.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Window widths in pixels: the narrowest that Chromium opens, a desktop screen and a wide screen.
const WIDTHS: [u32; 3] = [500, 1300, 1900];

/// Runs in the page after its own script, and appends its findings to the page as JSON.
const LOOK: &str = r##"
window.addEventListener("load", () => {
  const all = (selector) => Array.from(document.querySelectorAll(selector));
  const seen = { errors: window.pageErrors };
  seen.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.emptyFigures = all("figure").filter((figure) => figure.getBoundingClientRect().height < 50).map((f) => f.id);
  const marks = (svg) => svg.querySelectorAll("g.series *, circle.note").length;
  seen.blankFigures = all("figure svg").filter((svg) => marks(svg) === 0).map((svg) => svg.parentElement.id);
  seen.deadLinks = all("a[href^='#']").filter((a) => !document.getElementById(a.hash.slice(1))).map((a) => a.hash);
  const svg = document.getElementById("thread-scaling-speedup").querySelector("svg");
  const note = svg.querySelector("circle.note[data-series='work-stealing'][data-of='2']");
  const box = note.getBoundingClientRect();
  const at = { clientX: box.x + box.width / 2, clientY: box.y + box.height / 2, bubbles: true };
  note.dispatchEvent(new PointerEvent("pointermove", at));
  seen.shown = document.getElementById("value").textContent;
  seen.value = Number(note.dataset.value);
  const entry = svg.querySelector("g.legend[data-series='work-stealing']");
  const line = svg.querySelector("g.series[data-series='work-stealing']");
  seen.before = getComputedStyle(line).display;
  entry.dispatchEvent(new MouseEvent("click", { bubbles: true }));
  seen.after = getComputedStyle(line).display;
  const table = all("table").find((t) => t.tHead && t.tHead.textContent.includes("work inflation"));
  const column = Array.from(table.tHead.rows[0].cells).findIndex((cell) => cell.textContent === "speedup");
  const order = () => Array.from(table.tBodies[0].rows).map((row) => parseFloat(row.cells[column].textContent));
  table.tHead.rows[0].cells[column].querySelector("button").click();
  seen.ascending = order();
  table.tHead.rows[0].cells[column].querySelector("button").click();
  seen.descending = order();
  seen.tools = all("#thread-scaling-speedup .tools button").map((button) => button.textContent);
  const slider = document.querySelector("#timelines-contact-sheet .viewer input[type=range]");
  const canvas = document.querySelector("#timelines-contact-sheet .viewer canvas");
  const pictures = [0, 1].map((step) => {
    slider.value = step;
    slider.dispatchEvent(new Event("input"));
    return canvas.toDataURL();
  });
  seen.slides = pictures[0] !== pictures[1];
  const claims = document.getElementById("claims");
  const [report, verdict] = Array.from(claims.querySelectorAll(".filters select"));
  const choose = (choice, value) => {
    choice.value = value;
    choice.dispatchEvent(new Event("change"));
  };
  const left = () => Array.from(claims.querySelectorAll("td[data-verdict]")).filter((cell) => cell.checkVisibility());
  const letters = () => Array.from(new Set(left().map((cell) => cell.closest("details").querySelector("summary").textContent)));
  choose(report, "Report C");
  seen.ofReport = letters();
  choose(verdict, "context");
  seen.ofVerdict = Array.from(new Set(left().map((cell) => cell.dataset.verdict)));
  seen.filtered = [left().length, claims.querySelector("output").textContent];
  choose(report, "all");
  choose(verdict, "all");
  seen.unfiltered = [left().length, claims.querySelector("output").textContent];
  all("details").forEach((details) => { details.open = true; });
  seen.cutTables = all("details.wide").filter((table) => table.scrollWidth > table.clientWidth + 1).length;
  seen.background = getComputedStyle(document.body).backgroundColor;
  const told = document.createElement("script");
  told.type = "application/json";
  told.id = "seen";
  told.textContent = JSON.stringify(seen);
  document.body.append(told);
});
"##;

fn browser() -> Option<&'static str> {
    let answers = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success());
    BROWSERS.into_iter().find(answers)
}

/// Opens the page in a window of `width` pixels and returns the findings of `LOOK`.
fn looked_at(browser: &str, page: &Path, profile: &Path, width: u32, dark: bool) -> Value {
    let mut command = Command::new(browser);
    command.args(["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"]);
    command.args(["--virtual-time-budget=10000", "--dump-dom"]).arg(format!("--window-size={width},1000"));
    command.arg(format!("--user-data-dir={}", profile.display()));
    if dark {
        command.arg("--blink-settings=preferredColorScheme=0");
    }
    let output = command.arg(format!("file://{}", page.display())).output().expect("a browser starts");
    let dom = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    let (_, seen) = dom.split_once("id=\"seen\">").unwrap_or_else(|| panic!("nothing seen: {errors}"));
    let (json, _) = seen.split_once("</script>").expect("the end of what was seen");
    serde_json::from_str(json).unwrap_or_else(|error| panic!("{error} in {json}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().filter_map(Value::as_f64).collect()
}

#[test]
fn the_page_works_in_a_browser() {
    let Some(browser) = browser() else {
        eprintln!("skipped: none of {BROWSERS:?} is on the path");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    fs::rename(folder.path().join("tiny.toml"), folder.path().join("thread-scaling.toml")).unwrap();
    finish(pathmark(folder.path(), &["run", "thread-scaling.toml", "--out", "out"])).with_code(0);
    let pictures = TINY
        .replace("figures = [\"speedup\", \"schedules\"]", "figures = [\"contact-sheet\"]\nkeep = [\"images\"]")
        .replace("spp = [4]", "spp = [4, 8]")
        .replace("tiles:8x8", "tiles:16x16")
        .replace("[quick]", "[reference]\nestimator = \"bsdf\"\n\n[quick]");
    // The rows of an experiment of this name answer a claim, so claims appear on the page.
    fs::write(folder.path().join("timelines.toml"), pictures).unwrap();
    finish(pathmark(folder.path(), &["run", "timelines.toml", "--out", "out", "--repetitions", "1"])).with_code(0);
    let html = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    let errors = "<script>window.pageErrors = []; window.addEventListener('error', (e) => window.pageErrors.push(e.message));</script>";
    let watched = html
        .replacen("<style>", &format!("{errors}<style>"), 1)
        .replace("</body>", &format!("<script>{LOOK}</script></body>"));
    let page = folder.path().join("watched.html");
    fs::write(&page, watched).unwrap();
    let ledgers = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/experiments/claims")).unwrap();
    let texts = ledgers.filter_map(|ledger| fs::read_to_string(ledger.unwrap().path()).ok());
    let claims = texts.map(|text| text.matches("[[claim]]").count() as u64).sum();
    let mut backgrounds = Vec::new();
    for (index, (width, dark)) in WIDTHS.into_iter().flat_map(|width| [(width, false), (width, true)]).enumerate() {
        let seen = looked_at(browser, &page, &folder.path().join(format!("profile-{index}")), width, dark);
        for empty in ["errors", "emptyFigures", "blankFigures", "deadLinks"] {
            assert_eq!(seen[empty].as_array().map(Vec::len), Some(0), "{width} pixels: {empty}: {seen}");
        }
        assert!(seen["overflow"].as_f64().unwrap() <= 0.0, "{width} pixels: the page is wider than the screen: {seen}");
        // On narrower screens a table scrolls in its own box.
        assert!(width < 1300 || seen["cutTables"] == 0, "{width} pixels: a table is wider than the page: {seen}");
        let shown = seen["shown"].as_str().unwrap();
        assert!(shown.starts_with("work-stealing: ") && shown.contains("threads = 2"), "{shown}");
        let offered = "pathmark run thread-scaling.toml --quick --filter strategy=work-stealing --out ";
        assert!(shown.contains(offered), "{shown}");
        let value: f64 = shown["work-stealing: ".len()..].split(' ').next().unwrap().parse().unwrap();
        assert!((value - seen["value"].as_f64().unwrap()).abs() <= 5e-4 * value, "{shown}");
        assert_eq!((seen["before"].as_str(), seen["after"].as_str()), (Some("inline"), Some("none")), "{seen}");
        let (up, down) = (numbers(&seen["ascending"]), numbers(&seen["descending"]));
        assert!(up.len() > 2 && up.is_sorted() && down.iter().rev().eq(&up), "{seen}");
        assert_eq!(seen["slides"], true, "the slider changes the picture: {seen}");
        assert_eq!(seen["ofReport"], serde_json::json!(["Report C: claims and verdicts"]), "{seen}");
        assert_eq!(seen["ofVerdict"], serde_json::json!(["context"]), "{seen}");
        for (choice, at_least) in [("filtered", 1), ("unfiltered", claims)] {
            let left = seen[choice][0].as_u64().unwrap();
            assert!(left >= at_least && left <= claims, "{seen}");
            assert_eq!(seen[choice][1], serde_json::json!(format!("{left} of {claims} claims")), "{seen}");
        }
        assert_eq!(seen["tools"], serde_json::json!(["SVG", "PNG", "CSV", "logarithmic axes"]));
        backgrounds.push(seen["background"].as_str().unwrap().to_string());
    }
    assert!(backgrounds[0] != backgrounds[1], "dark mode has another background: {backgrounds:?}");
}
