//! Files that one verb writes and another reads.

use super::{json, names, record, run};
use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Both images have the same bits, so the difference is the format's rounding (and, in display formats, the clamp).
#[test]
fn every_format_is_read_back() {
    let folder = in_memory();
    record(folder.path(), "cornell", &["--seed", "3", "-o", "reference.pfm"]);
    for format in names("formats") {
        let image = format!("image.{format}");
        record(folder.path(), "cornell", &["--seed", "3", "-o", &image]);
        // A display image is compared with itself in another display format.
        let display = ["png", "ppm", "bmp"].contains(&format.as_str());
        if display {
            record(folder.path(), "cornell", &["--seed", "3", "-o", "display.png"]);
        }
        let reference = if display { "display.png" } else { "reference.pfm" };
        let metrics = json(&run(folder.path(), &["image", "compare", &image, reference, "--json"]).out);
        let rmse = metrics["rmse"].as_f64().unwrap();
        // The shared exponent of .hdr leaves 8 bits to each channel of values up to 12.
        let allowed = if format == "hdr" { 0.05 } else { 1e-6 };
        assert!(rmse <= allowed, "{format}: {rmse}");
    }
}

/// Automatic exposure is for viewing: it scales only display formats and leaves the record unchanged.
#[test]
fn automatic_exposure_changes_only_the_display() {
    let folder = in_memory();
    let render = |image: &str, options: &[&str]| {
        let options = [&["-o", image], options].concat();
        let mut record = record(folder.path(), "report-c", &options);
        let object = record.as_object_mut().unwrap();
        // Times and values that depend on the machine's state.
        object.retain(|name, _| !["_s", "_switches", "_mhz", "_utc"].iter().any(|ending| name.ends_with(ending)));
        object.retain(|name, _| !["warnings", "workers_used", "peak_rss_bytes", "migrations"].contains(&name.as_str()));
        record
    };
    let bytes = |image: &str| fs::read(folder.path().join(image)).unwrap();
    let linear = |image: &str| ::pathmark::image_io::read(&folder.path().join(image)).unwrap();
    for format in names("formats") {
        let (plain, exposed) = (format!("plain.{format}"), format!("exposed.{format}"));
        assert_eq!(render(&plain, &[]), render(&exposed, &["--auto-exposure"]), "{format}");
        let is_shown = ["png", "ppm", "bmp"].contains(&format.as_str());
        assert_eq!(bytes(&plain) != bytes(&exposed), is_shown, "{format}");
    }
    // The displayed image is the light divided by its largest channel, to the rounding of 8 bits.
    let (light, shown) = (linear("plain.pfm"), linear("exposed.png"));
    let largest = light.pixels.iter().flatten().copied().fold(0.0, f64::max);
    assert!(!(0.9..=1.1).contains(&largest), "no power: the brightest channel is {largest}");
    for (light, shown) in light.pixels.iter().flatten().zip(shown.pixels.iter().flatten()) {
        let display = ::pathmark::image_io::tone_map::display;
        assert!((display(light / largest) - display(*shown)).abs() <= 0.5001 / 255.0, "{light} is shown as {shown}");
    }
}

#[test]
fn a_reference_is_cached_and_a_heat_map_is_drawn() {
    let folder = in_memory();
    let reference = ["image", "reference", "cornell", "--size", "24x16", "--spp", "16", "--out", "films"];
    let first = run(folder.path(), &reference).out;
    let films: Vec<&str> = first.lines().take(2).collect();
    let bytes: Vec<_> = films.iter().map(|film| fs::read(folder.path().join(film)).unwrap()).collect();
    assert_ne!(bytes[0], bytes[1], "the halves are independent");
    let second = run(folder.path(), &reference);
    assert_eq!(second.out, first);
    assert!(!second.err.contains("reference 1 of 2"), "rendered again: {}", second.err);

    record(folder.path(), "cornell", &["--seed", "1", "-o", "a.pfm"]);
    record(folder.path(), "cornell", &["--seed", "2", "-o", "b.exr"]);
    let compared = run(folder.path(), &["image", "compare", "a.pfm", "b.exr", "--heatmap", "map.png"]).out;
    for metric in names("metrics") {
        assert!(compared.lines().any(|line| line.starts_with(&metric)), "{metric} is not in {compared}");
    }
    assert_png(&folder.path().join("map.png"));
    let same = json(&run(folder.path(), &["image", "compare", "a.pfm", "a.pfm", "--json"]).out);
    assert_eq!(same["rmse"], 0.0);
}

/// Means over a pixel that is no number are none either: the command prints them, names the pixel and fails.
#[test]
fn a_pixel_that_is_no_colour_is_named() {
    let folder = in_memory();
    // Rows are stored from the bottom up, so the third value is in the lower left.
    let write = |name: &str, odd: &[(usize, f32)]| {
        let mut values = [1.0_f32; 12];
        for (at, value) in odd {
            values[*at] = *value;
        }
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        let file: Vec<u8> = b"PF\n2 2\n-1.0\n".iter().copied().chain(bytes).collect();
        fs::write(folder.path().join(name), file).unwrap();
    };
    write("one.pfm", &[]);
    write("nan.pfm", &[(2, f32::NAN)]);
    write("inf.pfm", &[(3, f32::INFINITY), (9, f32::NAN)]);
    let cases: [(&[&str], &str); 4] = [
        (&["nan.pfm", "one.pfm"], "nan.pfm: pixel (0, 1) = (1, 1, NaN) is not finite\n"),
        (&["one.pfm", "nan.pfm"], "nan.pfm: pixel (0, 1) = (1, 1, NaN) is not finite\n"),
        (
            &["one.pfm", "one.pfm", "inf.pfm"],
            "inf.pfm: pixel (1, 0) = (NaN, 1, 1) is not finite, and 1 pixel like it\n",
        ),
        (&["inf.pfm", "one.pfm", "--json"], "inf.pfm: pixel (1, 0) = (NaN, 1, 1) is not finite, and 1 pixel like it\n"),
    ];
    for (arguments, said) in cases {
        let finished = finish(pathmark(folder.path(), &[&["image", "compare"], arguments].concat())).with_code(1);
        assert!(finished.out.contains("mse") && finished.out.contains("NaN"), "{}", finished.out);
        assert!(finished.err.ends_with(said), "{arguments:?}: {}", finished.err);
        if arguments.len() == 2 {
            let percentile = finished.out.lines().find(|line| line.starts_with("error-50")).unwrap();
            // Of the other pixels, which are equal.
            assert_eq!(percentile.split_whitespace().nth(1), Some("0.000000"), "{percentile}");
        }
    }
}

/// From a reference to a comparison: the two films of `reference` against an image that shares no sample with them.
#[test]
fn an_image_is_compared_with_both_halves_of_a_reference() {
    let folder = in_memory();
    let reference = ["image", "reference", "cornell", "--size", "24x16", "--spp", "64", "--out", "films"];
    let told = run(folder.path(), &reference).out;
    let films: Vec<&str> = told.lines().take(2).collect();
    record(folder.path(), "cornell", &["-o", "a.pfm"]);
    let compared = json(&run(folder.path(), &["image", "compare", "a.pfm", films[0], films[1], "--json"]).out);
    let number = |name: &str| compared[name].as_f64().unwrap();
    let read = |name: &str| ::pathmark::image_io::read(&folder.path().join(name)).unwrap();
    for (film, image) in films.iter().zip(["first.pfm", "second.pfm"]) {
        run(folder.path(), &["image", "convert", film, "-o", image]);
    }
    let [image, first, second] = ["a.pfm", "first.pfm", "second.pfm"].map(read);
    // A picture file has fewer digits than a film.
    let expected = ::pathmark::metric::cross_mse(&image, &first, &second).unwrap();
    assert!((number("mse") / expected - 1.0).abs() < 1e-5, "{compared} beside {expected}");
    assert!(number("mse_low") < number("mse") && number("mse") < number("mse_high"));
    for end in ["", "_low", "_high"] {
        let (root, square) = (number(&format!("rmse{end}")), number(&format!("mse{end}")));
        assert!((root * root / square - 1.0).abs() < 1e-9, "{compared}");
    }
    // The plain form includes the noise of the reference; the cross form does not.
    let plain = json(&run(folder.path(), &["image", "compare", "a.pfm", films[0], "--json"]).out);
    assert!(plain["mse"].as_f64().unwrap() > number("mse"), "{plain}");
    let same = finish(pathmark(folder.path(), &["image", "compare", "a.pfm", films[0], films[0]])).with_code(2);
    assert!(same.err.contains("seed of both"), "{}", same.err);
}

/// The same errors on a wider scale are darker.
#[test]
fn a_heat_map_has_the_scale_that_was_asked_for() {
    let folder = in_memory();
    record(folder.path(), "cornell", &["--seed", "1", "-o", "a.pfm"]);
    record(folder.path(), "cornell", &["--seed", "2", "-o", "b.pfm"]);
    let light = |scale: &str| {
        let map = ["image", "compare", "a.pfm", "b.pfm", "--heatmap", "map.png", "--scale", scale];
        assert!(run(folder.path(), &map).out.contains(&format!("from 0 (dark) to {scale}000 (light)")));
        let image = ::pathmark::image_io::read(&folder.path().join("map.png")).unwrap();
        image.pixels.as_flattened().iter().sum::<f64>()
    };
    assert!(light("0.5") > light("9.5"));
}

fn assert_png(path: &Path) {
    let bytes = fs::read(path).unwrap();
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.len() > 100, "{}", path.display());
}

/// Checks an SVG without a parser: each closing tag must match the last open element.
fn assert_svg(path: &Path) {
    let text = fs::read_to_string(path).unwrap();
    let mut open = Vec::new();
    for tag in text.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap_or_else(|| panic!("{}: no end of {tag:.40}", path.display()));
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap();
        match tag {
            _ if tag.starts_with(['?', '!']) || tag.ends_with('/') => {}
            _ if tag.starts_with('/') => assert_eq!(open.pop(), Some(name), "{}", path.display()),
            _ => open.push(name),
        }
    }
    assert!(open.is_empty() && text.contains("<svg") && !text.contains("NaN"), "{}: {open:?}", path.display());
}

#[test]
fn a_run_leaves_rows_figures_and_a_page_that_report_draws_again() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    run(folder.path(), &["run", "tiny.toml", "--out", "out"]);
    let out = folder.path().join("out");
    let figures = out.join("tiny/figures");
    let listed = |folder: &Path| {
        let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect::<BTreeSet<_>>()
    };
    let (first, page) = (listed(&figures), fs::read_to_string(out.join("report.html")).unwrap());
    fs::remove_dir_all(&figures).unwrap();
    fs::remove_file(out.join("report.html")).unwrap();
    run(folder.path(), &["report", "out"]);
    assert_eq!(listed(&figures), first);
    assert_eq!(fs::read_to_string(out.join("report.html")).unwrap(), page, "the page follows from the rows alone");

    let svgs: Vec<_> = first.iter().filter_map(|name| name.strip_suffix(".svg")).collect();
    assert!(!svgs.is_empty(), "{first:?}");
    for stem in svgs {
        assert_svg(&figures.join(format!("{stem}.svg")));
        assert_png(&figures.join(format!("{stem}.png")));
    }
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("</html>") && page.contains("Does it run?"));
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"), "the page needs a network");
}

#[test]
fn pictures_name_their_scene_and_settings() {
    let folder = in_memory();
    for (seed, output) in [("1", "a.png"), ("1", "b.exr"), ("2", "c.png")] {
        run(folder.path(), &["render", "cornell", "--size", "16x12", "--spp", "4", "--seed", seed, "-o", output]);
    }
    let shared = "seed 1 is the seed of both";
    assert!(run(folder.path(), &["image", "compare", "a.png", "b.exr"]).out.contains(shared));
    assert!(!run(folder.path(), &["image", "compare", "a.png", "c.png"]).out.contains("is the seed of both"));
    for (other, shares) in [("b.exr", true), ("c.png", false)] {
        assert_eq!(
            json(&run(folder.path(), &["image", "compare", "a.png", other, "--json"]).out)["shares_samples"],
            shares
        );
    }
    // A converted image keeps its notes, unless its format has none.
    run(folder.path(), &["image", "convert", "a.png", "-o", "d.exr"]);
    assert!(run(folder.path(), &["image", "compare", "d.exr", "b.exr"]).out.contains(shared));
    run(folder.path(), &["image", "convert", "a.png", "-o", "e.ppm"]);
    assert!(!run(folder.path(), &["image", "compare", "e.ppm", "b.exr"]).out.contains("is the seed of both"));
    let notes = std::fs::read(folder.path().join("a.png")).unwrap();
    let text = String::from_utf8_lossy(&notes);
    for part in ["pathmark.film", "\"scene\":\"cornell\"", "\"spp\":4", "pathmark.checksum", "Software"] {
        assert!(text.contains(part), "{part}");
    }
    let flip = run(folder.path(), &["image", "compare", "a.png", "c.png", "--flip", "flip.png"]).out;
    assert!(flip.contains("flip.png: from 0 (dark) to 1.0000 (light)"), "{flip}");
    assert!(folder.path().join("flip.png").is_file());
}
