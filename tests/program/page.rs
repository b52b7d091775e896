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

/// Window widths in pixels: a telephone, the narrowest window that Chromium opens, a desktop screen and a wide screen.
const WIDTHS: [u32; 4] = [PHONE, 500, 1300, 1900];

/// The width of a telephone. Its page is in a frame of a wider window.
const PHONE: u32 = 390;

/// The window around the frame, which gets the findings by a message.
const FRAME: &str = r#"<!DOCTYPE html><script>
window.addEventListener("message", (event) => {
  const told = document.createElement("script");
  told.type = "application/json";
  told.id = "seen";
  told.textContent = event.data;
  document.body.append(told);
});
</script><iframe src="PAGE" width="390" height="844" style="border: 0"></iframe>"#;

/// An address with filters of the claims.
const ADDRESS: &str = "#claims&report=Report+C&verdict=context";

/// Runs in the page after its own script, and appends its findings to the page as JSON.
const LOOK: &str = r##"
window.addEventListener("load", () => {
  const all = (selector) => Array.from(document.querySelectorAll(selector));
  const seen = { errors: window.pageErrors };
  seen.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.emptyFigures = all("figure").filter((figure) => figure.getBoundingClientRect().height < 50).map((f) => f.id);
  const marks = (svg) => svg.querySelectorAll("g.series *, circle.note").length;
  const isTimeline = (svg) => svg.parentElement.querySelector("script.jobs") !== null;
  seen.blankFigures = all("figure svg").filter((svg) => marks(svg) === 0 && !isTimeline(svg)).map((svg) => svg.parentElement.id);
  seen.deadLinks = all("a[href^='#']").filter((a) => !document.getElementById(a.hash.slice(1))).map((a) => a.hash);
  const answers = all("#answers article");
  const isAnswer = (part) => part.querySelector("h2 .badge") && part.querySelector("p").textContent.length > 20 && part.querySelector("a svg");
  seen.answers = [answers.length, answers.filter(isAnswer).length];
  seen.first = document.getElementById("answers").getBoundingClientRect().top + window.scrollY;
  const svg = document.getElementById("thread-scaling-speedup").querySelector("svg");
  const press = (part, key, more) => part.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more }));
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
  entry.focus();
  seen.focus = document.activeElement === entry;
  press(entry, "Enter");
  seen.pressed = getComputedStyle(line).display;
  const value = document.getElementById("value");
  value.hidden = true;
  svg.focus();
  press(svg, "ArrowRight");
  seen.byKey = [value.hidden, value.textContent];
  press(svg, "ArrowRight");
  seen.byKey.push(value.textContent);
  const figure = getComputedStyle(svg.querySelector("text")).fill;
  seen.figure = [figure, getComputedStyle(svg.querySelector("rect")).fill];
  const other = document.querySelector("#thread-scaling-speedup .other svg");
  seen.otherAxes = Array.from(other.querySelectorAll("circle.note")).map((note) => note.dataset.value === "" || note.getAttribute("aria-label") === null).filter((lacks) => lacks).length;
  const table = all("table").find((t) => t.tHead && t.tHead.textContent.includes("work inflation"));
  const column = Array.from(table.tHead.rows[0].cells).findIndex((cell) => cell.textContent === "speedup");
  const order = () => Array.from(table.tBodies[0].rows).map((row) => parseFloat(row.cells[column].textContent));
  table.tHead.rows[0].cells[column].querySelector("button").click();
  seen.ascending = order();
  table.tHead.rows[0].cells[column].querySelector("button").click();
  seen.descending = order();
  seen.tools = all("#thread-scaling-speedup .tools button").map((button) => button.textContent);
  // The viewer: the left picture over the whole width, then steps, light, zoom, and back.
  const view = document.querySelector("#timelines-contact-sheet .viewer");
  const [main, beside] = Array.from(view.querySelectorAll("canvas"));
  const [edge] = Array.from(view.querySelectorAll("input[type=range]"));
  edge.value = 1;
  edge.dispatchEvent(new Event("input"));
  const pictures = () => [main, beside].map((canvas) => canvas.toDataURL());
  // The middle of a pixel of the image, 24 x 16, that is neither dark nor bright.
  const centre = (place) => [main.width * ((place % 24) + 0.5) / 24, main.height * (Math.floor(place / 24) + 0.5) / 16].map(Math.floor);
  const colourAt = (at) => Array.from(main.getContext("2d").getImageData(...at, 1, 1).data).slice(0, 3);
  const pixel = Array.from({ length: 24 * 16 }, (_, place) => centre(place)).find((at) => colourAt(at).every((value) => value > 30 && value < 150));
  const colour = () => colourAt(pixel);
  const start = pictures();
  const frame = main.getBoundingClientRect();
  const [clientX, clientY] = [frame.x + ((pixel[0] + 0.5) / main.width) * frame.width, frame.y + ((pixel[1] + 0.5) / main.height) * frame.height];
  main.dispatchEvent(new PointerEvent("pointermove", { clientX, clientY, bubbles: true }));
  seen.under = view.querySelector(".value").textContent.split("left ")[1].split(",")[0].split(" ").map(Number);
  seen.middle = colour();
  press(view, "E");
  press(view, "E");
  seen.brighter = colour();
  seen.stops = view.querySelector("output").textContent;
  press(view, "e");
  press(view, "e");
  seen.same = pictures().every((picture, place) => picture === start[place]);
  const changes = (act) => {
    const before = pictures();
    act();
    return pictures().map((picture, place) => picture !== before[place]);
  };
  seen.zoomed = changes(() => press(view, "+"));
  seen.wheeled = changes(() => main.dispatchEvent(new WheelEvent("wheel", { deltaY: 1, ctrlKey: true, clientX, clientY, bubbles: true, cancelable: true })));
  seen.moved = changes(() => press(view, "ArrowRight"));
  press(view, "0");
  edge.value = 1;
  edge.dispatchEvent(new Event("input"));
  seen.back = pictures().every((picture, place) => picture === start[place]);
  seen.second = [changes(() => press(view, "2")), view.querySelector("select").value];
  const oneToOne = Array.from(view.querySelectorAll("button")).find((button) => button.textContent === "1:1");
  seen.oneToOne = changes(() => oneToOne.click())[0];
  // The trace on the picture: no tile before the start, all at the end.
  const replay = document.querySelector("#timelines-timelines .replay");
  replay.closest("details").open = true;
  const time = replay.querySelector("input[type=range]");
  const moments = [0, 1000].map((now) => {
    time.value = now;
    time.dispatchEvent(new Event("input"));
    return [replay.querySelector("canvas").toDataURL(), replay.querySelector("p").textContent];
  });
  seen.replay = [moments[0][0] !== moments[1][0], moments[0][1], moments[1][1]];
  // The job under the pointer is told in sight, also at the end of lanes that are as high as the window.
  const lanes = document.querySelector("#timelines-timelines canvas.timeline");
  lanes.scrollIntoView({ block: "end" });
  const area = lanes.getBoundingClientRect();
  const job = lanes.closest("details").querySelector(".job");
  // Under foreign load a lane may be idle for most of the time.
  for (let x = area.left + area.width / 4; x < area.right && !job.textContent.startsWith("Job "); x += area.width / 64) {
    for (let y = area.top + 1; y < area.bottom && !job.textContent.startsWith("Job "); y += 2) {
      lanes.dispatchEvent(new PointerEvent("pointermove", { clientX: x, clientY: y, bubbles: true }));
    }
  }
  const lineOfJob = job.getBoundingClientRect();
  seen.job = [job.textContent, lineOfJob.top >= 0 && lineOfJob.bottom <= window.innerHeight];
  window.scrollTo(0, 0);
  const claims = document.getElementById("claims");
  const [report, verdict] = Array.from(claims.querySelectorAll(".filters select"));
  const choose = (choice, value) => {
    choice.value = value;
    choice.dispatchEvent(new Event("change"));
  };
  const left = () => Array.from(claims.querySelectorAll("td[data-verdict]")).filter((cell) => cell.checkVisibility());
  const letters = () => Array.from(new Set(left().map((cell) => cell.closest("details").querySelector("summary").textContent)));
  seen.restored = [report.value, verdict.value];
  choose(verdict, "all");
  choose(report, "Report C");
  seen.ofReport = letters();
  choose(verdict, "context");
  seen.ofVerdict = Array.from(new Set(left().map((cell) => cell.dataset.verdict)));
  seen.filtered = [left().length, claims.querySelector("output").textContent];
  seen.address = window.location.hash;
  choose(report, "all");
  choose(verdict, "all");
  seen.unfiltered = [left().length, claims.querySelector("output").textContent];
  seen.addresses = ["tr[id^='claim-'] .copy", "#thread-scaling-speedup .copy"].map((copy) => {
    document.querySelector(copy).click();
    return document.getElementById(window.location.hash.slice(1)) === document.querySelector(copy).closest("tr, figure");
  });
  all("details").forEach((details) => { details.open = true; });
  seen.cutTables = all("details.wide").filter((table) => table.scrollWidth > table.clientWidth + 1).length;
  seen.background = getComputedStyle(document.body).backgroundColor;
  seen.cell = getComputedStyle(table.tBodies[0].rows[0].cells[1]).display;
  const told = document.createElement("script");
  told.type = "application/json";
  told.id = "seen";
  told.textContent = JSON.stringify(seen);
  document.body.append(told);
  if (window.parent !== window) window.parent.postMessage(told.textContent, "*");
});
"##;

/// Each experiment has a page in `pages`, whose links lead to files that are there, and a list names all.
#[test]
fn each_experiment_has_a_page_beside_the_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    fs::copy(folder.path().join("tiny.toml"), folder.path().join("other.toml")).unwrap();
    finish(pathmark(folder.path(), &["run", "other.toml", "--out", "out"])).with_code(0);
    let pages = folder.path().join("out/pages");
    fs::create_dir(&pages).unwrap();
    fs::write(pages.join("tiny.html"), "my own page").unwrap();
    let refused = finish(pathmark(folder.path(), &["report", "out", "--pages"])).with_code(2);
    assert!(refused.err.contains("tiny.html"), "{}", refused.err);
    assert_eq!(fs::read_to_string(pages.join("tiny.html")).unwrap(), "my own page");
    fs::remove_file(pages.join("tiny.html")).unwrap();
    for _ in 0..2 {
        let told = finish(pathmark(folder.path(), &["report", "out", "--pages"])).with_code(0);
        assert!(told.out.contains("index.html"), "{}", told.out);
    }
    let read = |name: &str| fs::read_to_string(pages.join(name)).unwrap();
    let links = |html: &str| -> Vec<String> {
        let links = html.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next());
        links.filter(|link| !link.starts_with('#')).map(str::to_string).collect()
    };
    for page in ["index.html", "tiny.html", "other.html"] {
        let found = links(&read(page));
        assert!(!found.is_empty(), "{page} has no link");
        for link in found {
            assert!(pages.join(&link).is_file(), "{page}: {link} leads nowhere");
        }
    }
    assert!(links(&read("index.html")).contains(&"other.html".to_string()));
    assert!(read("tiny.html").contains("id=\"tiny-speedup\"") && !read("tiny.html").contains("id=\"other-speedup\""));
    // The folder of an experiment has a page of its own, too, wherever one stands.
    let own = folder.path().join("out/tiny");
    for (from, name) in [(folder.path(), "out/tiny"), (own.as_path(), ".")] {
        finish(pathmark(from, &["report", name])).with_code(0);
        let html = fs::read_to_string(own.join("report.html")).unwrap();
        assert!(html.contains("id=\"tiny-speedup\""), "{name}");
        for link in links(&html) {
            assert!(own.join(&link).is_file(), "{name}: {link} leads nowhere");
        }
        fs::remove_file(own.join("report.html")).unwrap();
    }
}

fn browser() -> Option<&'static str> {
    let answers = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|out| out.status.success());
    BROWSERS.into_iter().find(answers)
}

/// Opens the page at an address in a window of `width` pixels and returns the findings of `LOOK`.
fn looked_at(browser: &str, page: &str, profile: &Path, width: u32, dark: bool) -> Value {
    let mut command = Command::new(browser);
    command.args(["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"]);
    command.args(["--virtual-time-budget=10000", "--dump-dom"]).arg(format!("--window-size={width},1000"));
    command.arg(format!("--user-data-dir={}", profile.display()));
    if dark {
        command.arg("--blink-settings=preferredColorScheme=0");
    }
    let output = command.arg(format!("file://{page}")).output().expect("a browser starts");
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
        .replace(
            "figures = [\"speedup\", \"schedules\"]",
            "figures = [\"contact-sheet\", \"timelines\"]\nkeep = [\"images\", \"traces\"]",
        )
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
    let mut colours = Vec::new();
    for (index, (width, dark)) in WIDTHS.into_iter().flat_map(|width| [(width, false), (width, true)]).enumerate() {
        let address = if dark { ADDRESS } else { "" };
        let mut opened = format!("{}{address}", page.display());
        if width == PHONE {
            let frame = folder.path().join("frame.html");
            fs::write(&frame, FRAME.replace("PAGE", &format!("watched.html{address}"))).unwrap();
            opened = frame.display().to_string();
        }
        let seen = looked_at(browser, &opened, &folder.path().join(format!("profile-{index}")), width.max(500), dark);
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
        check_first_screen(&seen);
        check_keys(&seen);
        check_viewer(&seen);
        check_replay(&seen);
        assert_eq!(seen["cell"], if width < 600 { "flex" } else { "table-cell" }, "{width} pixels: {seen}");
        assert_eq!(seen["otherAxes"], 0, "values without data: {seen}");
        let restored = if dark { ["Report C", "context"] } else { ["all", "all"] };
        assert_eq!(seen["restored"], serde_json::json!(restored), "{seen}");
        assert_eq!(seen["address"], ADDRESS, "{seen}");
        assert_eq!(seen["addresses"], serde_json::json!([true, true]), "{seen}");
        assert_eq!(seen["ofReport"], serde_json::json!(["Report C: claims and verdicts"]), "{seen}");
        assert_eq!(seen["ofVerdict"], serde_json::json!(["context"]), "{seen}");
        for (choice, at_least) in [("filtered", 1), ("unfiltered", claims)] {
            let left = seen[choice][0].as_u64().unwrap();
            assert!(left >= at_least && left <= claims, "{seen}");
            assert_eq!(seen[choice][1], serde_json::json!(format!("{left} of {claims} claims")), "{seen}");
        }
        assert_eq!(seen["tools"], serde_json::json!(["SVG", "PNG", "CSV", "logarithmic axes"]));
        colours.push([seen["background"].clone(), seen["figure"][0].clone(), seen["figure"][1].clone()]);
    }
    // Page, letters of figures and paper of figures.
    for pair in colours.chunks(2) {
        assert!(
            pair[0].iter().zip(&pair[1]).all(|(light, dark)| light != dark),
            "dark mode has other colours: {pair:?}"
        );
    }
}

/// The page begins with an answer that has a badge, a sentence and a figure.
fn check_first_screen(seen: &Value) {
    let [all, whole] = [0, 1].map(|at| seen["answers"][at].as_u64().unwrap());
    assert!(all >= 1 && whole == all, "{seen}");
    assert!(seen["first"].as_f64().unwrap() < 900.0, "the answers are on the first screen: {seen}");
}

/// Legends and marks by keyboard.
fn check_keys(seen: &Value) {
    assert_eq!(seen["focus"], true, "an entry of a legend takes the focus: {seen}");
    assert_eq!(seen["pressed"], "inline", "Enter shows the series again: {seen}");
    let told = |at: usize| seen["byKey"][at].as_str().unwrap();
    assert_eq!(seen["byKey"][0], false, "{seen}");
    assert!(told(1).contains("threads = ") && told(2).contains("threads = ") && told(1) != told(2), "{seen}");
}

/// Display value of a share of light, and back, by IEC 61966-2-1.
fn brighter(value: f64, stops: i32) -> f64 {
    let share = value / 255.0;
    let light = if share <= 0.04045 { share / 12.92 } else { libm::pow((share + 0.055) / 1.055, 2.4) };
    let light = light * f64::from(1 << stops);
    let share = if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
    (255.0 * share).min(255.0)
}

fn check_viewer(seen: &Value) {
    let (middle, after) = (numbers(&seen["middle"]), numbers(&seen["brighter"]));
    // Neighbours of a pixel differ a little in a JPEG.
    let under = numbers(&seen["under"]);
    assert!(under.len() == 3 && under.iter().zip(&middle).all(|(told, shown)| (told - shown).abs() <= 8.0), "{seen}");
    assert!(middle.iter().zip(&after).all(|(value, after)| (brighter(*value, 1) - after).abs() <= 1.0), "{seen}");
    assert!(middle != after, "{seen}");
    assert_eq!(seen["stops"], " +1 stops", "{seen}");
    for (what, expected) in [
        ("same", serde_json::json!(true)),
        ("zoomed", serde_json::json!([true, true])),
        ("wheeled", serde_json::json!([true, true])),
        ("moved", serde_json::json!([true, true])),
        ("back", serde_json::json!(true)),
        ("second", serde_json::json!([[true, true], "1"])),
        ("oneToOne", serde_json::json!(true)),
    ] {
        assert_eq!(seen[what], expected, "{what}: {seen}");
    }
}

/// At the start of a replay no job is done, at its end all are, and the pictures differ.
fn check_replay(seen: &Value) {
    let [start, end] = [1, 2].map(|at| seen["replay"][at].as_str().unwrap());
    assert_eq!(seen["replay"][0], true, "{seen}");
    assert!(start.contains(": 0 of 2 jobs") && end.contains(": 2 of 2 jobs"), "{seen}");
}
