//! Pathmark's own files in a state that no complete run leaves: after a crash, a full disk or a second run.

use super::experiment::{TINY, write_tiny};
use super::program::{finish, in_memory, pathmark};
use super::refused;
use pathmark::experiment::experiments;
use pathmark::measure::SCHEMA;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const RUN: [&str; 4] = ["run", "tiny.toml", "--out", "out"];
const RESUME: [&str; 5] = ["run", "tiny.toml", "--out", "out", "--resume"];

/// A folder with `tiny.toml` and a run's results in `out`, and the path of the rows.
fn after_a_run() -> (tempfile::TempDir, PathBuf) {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    let records = folder.path().join("out/tiny/records.csv");
    (folder, records)
}

fn films(folder: &Path) -> Vec<PathBuf> {
    let mut films: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    films.sort();
    films
}

#[test]
fn a_damaged_reference_is_refused_and_kept() {
    let folder = in_memory();
    let text = TINY.replace("[quick]\n", "[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 40\n");
    write_tiny(folder.path(), &text);
    let reference = ["image", "reference", "cornell", "--size", "24x16", "--spp", "40", "--out", "out/references"];
    finish(pathmark(folder.path(), &reference)).with_code(0);
    let films = films(&folder.path().join("out/references"));
    assert_eq!(films.len(), 2);
    for film in films {
        let whole = fs::read(&film).unwrap();
        let name = film.file_name().unwrap().to_str().unwrap();
        let mut damaged: Vec<Vec<u8>> =
            [0, 1, 15, 16, 31, 40, 200, 1000, whole.len() / 2, whole.len() - 33, whole.len() - 1]
                .map(|length| whole[..length].to_vec())
                .into();
        damaged.push([&whole, b"x".as_slice()].concat());
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        damaged.push(flipped);
        for bytes in damaged {
            println!("{name}: {} of {} bytes", bytes.len(), whole.len());
            fs::write(&film, &bytes).unwrap();
            refused(folder.path(), &reference, 2, &["film", name]);
            refused(folder.path(), &RUN, 2, &["film", name]);
        }
        fs::write(&film, &whole).unwrap();
    }
    // Undamaged, the films are used.
    finish(pathmark(folder.path(), &RUN)).with_code(0);
}

#[test]
fn rows_are_never_overwritten() {
    let (folder, _) = after_a_run();
    refused(folder.path(), &RUN, 2, &["records", "records.csv", "--resume"]);
}

#[test]
fn a_half_written_row_is_refused_by_report_and_dropped_by_resume() {
    let (folder, records) = after_a_run();
    let whole = fs::read_to_string(&records).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let last = lines.len();
    let keep = whole.len() - lines[last - 1].len() - 1;
    for length in [keep + 1, keep + lines[last - 1].len() / 2, whole.len() - 1] {
        fs::write(&records, &whole[..length]).unwrap();
        let place = format!("records.csv:{last}:");
        refused(folder.path(), &["report", "out"], 2, &[&place, "half written", "--resume"]);
    }
    finish(pathmark(folder.path(), &RESUME)).with_code(0);
    let resumed = fs::read_to_string(&records).unwrap();
    assert_eq!(resumed.lines().count(), last);
    assert_eq!(resumed.lines().take(last - 1).collect::<Vec<_>>(), lines[..last - 1]);
}

#[test]
fn rows_that_are_none_are_refused_with_their_line() {
    let (folder, records) = after_a_run();
    let whole = fs::read_to_string(&records).unwrap();
    let mut lines: Vec<&str> = whole.lines().collect();
    let row = lines[2];
    let (first, rest) = row.split_once(',').unwrap();
    let version = format!("99,{rest}");
    let wordy = format!("one,{rest}");
    let longer = format!("{first},{rest},surplus");
    let cut: String = row.chars().take(row.len() / 2).collect();
    for (junk, said) in [
        ("junk", "cannot be read"),
        (",,,,", "cannot be read"),
        (cut.as_str(), "cannot be read"),
        (longer.as_str(), "cannot be read"),
        (wordy.as_str(), "schema"),
        (version.as_str(), "another version"),
        ("\0\0\0\0", "cannot be read"),
        (lines[1], "twice"),
    ] {
        println!("{junk:.60}");
        lines[2] = junk;
        fs::write(&records, lines.join("\n") + "\n").unwrap();
        refused(folder.path(), &["report", "out"], 2, &["records.csv:3:", said]);
        refused(folder.path(), &RESUME, 2, &["records.csv:3:", said]);
    }
}

/// Times that no clock shows are damage. A comparison would take their cells for absent.
#[test]
fn times_that_no_clock_shows_are_refused_with_their_line() {
    let (folder, records) = after_a_run();
    let mut reader = csv::Reader::from_path(&records).unwrap();
    let heads = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let with = |column: &str, value: &str, error: &str| {
        let mut writer = csv::Writer::from_path(&records).unwrap();
        writer.write_record(&heads).unwrap();
        for (index, row) in rows.iter().enumerate() {
            let field = |(head, old)| match head {
                _ if index != 1 => old,
                head if head == column => value,
                "error" => error,
                _ => old,
            };
            writer.write_record(heads.iter().zip(row).map(field)).unwrap();
        }
        writer.flush().unwrap();
    };
    for (column, values) in [
        ("makespan_s", &["NaN", "inf", "-inf", "0", "-0.0", "-1.5", "1e999"][..]),
        ("strategy_setup_s", &["NaN", "inf", "-1e-9"]),
        ("idle_between_jobs_s", &["NaN", "-inf"]),
    ] {
        for value in values {
            with(column, value, "");
            let said = ["records.csv:3:", column, value];
            refused(folder.path(), &["report", "out"], 2, &said);
            refused(folder.path(), &["diff", "out", "out"], 2, &said);
            refused(folder.path(), &["diff", "out/tiny", "out/tiny", "--counts"], 2, &said);
            refused(folder.path(), &["rank", "out/tiny"], 2, &said);
            refused(folder.path(), &RESUME, 2, &said);
        }
    }
    // Rounding may leave a difference of times below 0, and a failed row has no time.
    for (column, value, error) in
        [("idle_between_jobs_s", "-1e-9", ""), ("strategy_setup_s", "0", ""), ("makespan_s", "0", "it broke")]
    {
        with(column, value, error);
        finish(pathmark(folder.path(), &["rank", "out/tiny"])).with_code(0);
    }
}

/// A header may say any size: 65536x1024 pixels take 3.5 GB, and a refusal takes little memory. The length of the file
/// shows that the pixels are not there.
#[test]
fn a_part_with_a_forged_size_takes_no_memory() {
    const MERGE: [&str; 5] = ["merge", "part.film", "--partial", "-o", "image.pfm"];
    let size = "\"width\":33,\"height\":17";
    for by in ["tiles", "samples"] {
        let folder = in_memory();
        let options = ["render", "cornell", "--size", "33x17", "--spp", "32", "--shard", "1/2", "--shard-by", by];
        finish(pathmark(folder.path(), &[&options[..], &["-o", "part.film"]].concat())).with_code(0);
        let whole = fs::read(folder.path().join("part.film")).unwrap();
        finish(pathmark(folder.path(), &MERGE)).with_code(0);
        let mut lines = whole.splitn(3, |byte| *byte == b'\n');
        let [magic, header] = [(); 2].map(|()| String::from_utf8(lines.next().unwrap().to_vec()).unwrap());
        let body = lines.next().unwrap();
        let large = header.replace(size, "\"width\":65536,\"height\":1024");
        assert_ne!(large, header);
        // Without samples, no pixels are expected.
        let mut empty: serde_json::Value = serde_json::from_str(&large).unwrap();
        empty["film"]["spp"] = 0.into();
        let impossible = header.replace(size, "\"width\":4294967295,\"height\":4294967295");
        for (forged, body, said) in [
            (large, body, "pixels"),
            (empty.to_string(), &body[body.len() - 32..], "no samples"),
            (impossible, body, "4294967295x4294967295"),
        ] {
            let bytes = [format!("{magic}\n{forged}\n").as_bytes(), body].concat();
            fs::write(folder.path().join("part.film"), bytes).unwrap();
            refused(folder.path(), &MERGE, 2, &["part.film", said]);
        }
    }
}

/// Rows of another version have other columns, so the message must name the version.
#[test]
fn rows_of_another_version_are_told_as_such() {
    let (folder, records) = after_a_run();
    let whole = fs::read_to_string(&records).unwrap();
    let (header, rows) = whole.split_once('\n').unwrap();
    let rows: Vec<&str> = rows.lines().map(|row| row.split_once(',').unwrap().1).collect();
    let newer = (SCHEMA + 1).to_string();
    for (columns, version) in [("a_column_that_was", "6"), ("two,columns", &newer), ("mse", "")] {
        // Columns that no longer exist, in place of the second.
        let header = header.replacen("experiment", columns, 1);
        let value = if columns.contains(',') { "1,2" } else { "1" };
        let rest = rows.iter().map(|row| row.split_once(',').unwrap().1);
        let lines: Vec<String> = rest.map(|rest| format!("{version},{value},{rest}")).collect();
        fs::write(&records, format!("{header}\n{}\n", lines.join("\n"))).unwrap();
        let said = ["records.csv:2:", "schema", "another version"];
        refused(folder.path(), &["report", "out"], 2, &said);
        refused(folder.path(), &RESUME, 2, &said);
    }
}

/// Rows of version 7 lack two columns that may be empty. They are read, but no rows with other columns are appended. The
/// refusal names the columns on either side.
#[test]
fn rows_of_the_version_before_are_read_and_not_added_to() {
    let (folder, records) = after_a_run();
    let mut reader = csv::Reader::from_path(&records).unwrap();
    let heads = reader.headers().unwrap().clone();
    let is_old = |column: usize| !heads[column].starts_with("device_");
    let mut writer = csv::Writer::from_writer(Vec::new());
    let kept = |row: &csv::StringRecord| -> Vec<String> {
        (0..row.len()).filter(|column| is_old(*column)).map(|column| row[column].to_string()).collect()
    };
    writer.write_record(kept(&heads)).unwrap();
    for row in reader.records() {
        let row = kept(&row.unwrap());
        writer.write_record(std::iter::once("7").chain(row[1..].iter().map(String::as_str))).unwrap();
    }
    fs::write(&records, writer.into_inner().unwrap()).unwrap();
    finish(pathmark(folder.path(), &["report", "out"])).with_code(0);
    refused(
        folder.path(),
        &RESUME,
        2,
        &["records.csv:1:", "it lacks device_compile_s, device_copy_s", "other columns", "another --out"],
    );
    // Its own name for a column of today.
    let text = fs::read_to_string(&records).unwrap().replacen("idle_tail_s", "tail_sum_s", 1);
    fs::write(&records, text).unwrap();
    refused(folder.path(), &RESUME, 2, &["device_copy_s, idle_tail_s; it has tail_sum_s", "that wrote the file"]);
}

#[test]
fn a_file_that_is_no_text_is_refused() {
    let (folder, records) = after_a_run();
    let mut bytes = fs::read(&records).unwrap();
    let end = bytes.len();
    bytes[end - 20] = 0xff;
    fs::write(&records, &bytes).unwrap();
    refused(folder.path(), &["report", "out"], 2, &["records.csv"]);
    refused(folder.path(), &RESUME, 2, &["records.csv"]);
}

#[test]
fn a_damaged_machine_or_definition_is_refused_at_its_place() {
    for name in ["machine.toml", "experiment.toml"] {
        let (folder, records) = after_a_run();
        let path = records.with_file_name(name);
        fs::write(&path, "title = [\n").unwrap();
        refused(folder.path(), &["report", "out"], 2, &[&format!("{name}:")]);
        fs::remove_file(&path).unwrap();
        refused(folder.path(), &["report", "out"], 2, &[name, "no such file"]);
    }
}

/// Waits until a running sweep has its records file, and asserts that the `second` commands are refused.
fn second_is_refused(first: &[&str], second: &[&[&str]], records: &str, said: &str) {
    let folder = in_memory();
    write_tiny(folder.path(), &TINY.replace("spp = [4]", "spp = [4000]"));
    let mut sweep = pathmark(folder.path(), first).spawn().unwrap();
    let records = folder.path().join(records);
    let start = Instant::now();
    let mut folder_is_ready = || {
        let ended = sweep.try_wait().unwrap().is_some();
        assert!(!ended && start.elapsed() < Duration::from_mins(10), "the sweep has not begun");
        records.is_file() && records.with_file_name("experiment.toml").exists()
    };
    while !folder_is_ready() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let refusals: Vec<_> = second
        .iter()
        .map(|arguments| std::panic::catch_unwind(|| finish(pathmark(folder.path(), arguments)).with_code(2).err))
        .collect();
    let is_there = records.is_file();
    sweep.kill().unwrap();
    sweep.wait().unwrap();
    assert!(is_there, "{} was moved away", records.display());
    for refusal in refusals {
        let message = refusal.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn two_sweeps_at_once_do_not_share_a_folder() {
    second_is_refused(&RUN, &[&RUN, &RESUME], "out/tiny/records.csv", "records.csv");
}

#[test]
fn a_second_reproduction_leaves_the_first_ones_folder() {
    let reproduce: [&str; 3] = ["reproduce", "--out", "out"];
    // Experiments run in the order of their names.
    let (first, _) = experiments().first().unwrap();
    let records = format!("out/{first}/records.csv");
    second_is_refused(&reproduce, &[&reproduce], &records, "out = out: is being written by another process");
}
