//! `render --shard` and `merge`: one image from several machines.

use super::{json, run};
use crate::program::{finish, in_memory, pathmark};
use std::fs;
use std::path::Path;

const SIZE: [&str; 4] = ["render", "cornell", "--size", "70x40"];

fn part(folder: &Path, shard: &str, options: &[&str]) {
    let name = format!("part-{}.film", shard.replace('/', "-of-"));
    run(folder, &[SIZE.as_slice(), &["--shard", shard, "-o", &name], options].concat());
}

fn checksum(out: &str) -> String {
    json(out)["checksum"].as_str().unwrap().to_string()
}

#[test]
fn parts_are_merged_into_the_image() {
    let folder = in_memory();
    let expected = checksum(&run(folder.path(), &[SIZE.as_slice(), &["--spp", "48", "--json"]].concat()).out);
    for by in ["samples", "tiles"] {
        for shard in ["3/3", "1/3", "2/3"] {
            part(folder.path(), shard, &["--spp", "48", "--shard-by", by]);
        }
        let names = ["part-1-of-3.film", "part-2-of-3.film", "part-3-of-3.film"];
        let merged = run(folder.path(), &[&["merge"], names.as_slice(), &["-o", "whole.exr", "--json"]].concat());
        let merged = json(&merged.out);
        assert_eq!((merged["checksum"].as_str(), &merged["of"]), (Some(expected.as_str()), &3.into()));
        // The merged file equals the file of an image rendered at once, notes included.
        run(folder.path(), &[SIZE.as_slice(), &["--spp", "48", "-o", "at-once.exr"]].concat());
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert!(read("whole.exr") == read("at-once.exr"), "{by}");
        // A film can be compared and converted.
        run(folder.path(), &[&["merge"], names.as_slice(), &["-o", "whole.film"]].concat());
        run(folder.path(), &["image", "convert", "whole.film", "-o", "again.exr"]);
        assert!(read("again.exr") == read("at-once.exr"), "{by}");
        // A part cannot, and the message names the command for parts.
        let part = finish(pathmark(folder.path(), &["image", "compare", names[0], "whole.exr"])).with_code(2);
        assert!(part.err.contains("film = part-1-of-3.film") && part.err.contains("merge"), "{}", part.err);
        // One part is missing.
        let two = [&["merge"], &names[..2], &["-o", "two.png"]].concat();
        let finished = finish(pathmark(folder.path(), &two)).with_code(2);
        assert!(finished.err.contains("3/3") && !folder.path().join("two.png").exists(), "{}", finished.err);
        let finished = run(folder.path(), &[two.as_slice(), &["--partial"]].concat());
        assert!(
            finished.err.contains("3/3") && finished.out.contains("no checksum"),
            "{}{}",
            finished.err,
            finished.out
        );
        names.iter().chain(&["two.png"]).for_each(|name| fs::remove_file(folder.path().join(name)).unwrap());
    }
}

#[test]
fn invalid_shards_are_refused_before_any_work() {
    let folder = in_memory();
    let refused = |options: &[&str], said: &[&str]| {
        let finished = finish(pathmark(folder.path(), &[SIZE.as_slice(), options].concat())).with_code(2);
        assert!(said.iter().all(|text| finished.err.contains(text)), "{said:?} is not in {}", finished.err);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{options:?}");
    };
    for shard in ["0/4", "a/b"] {
        refused(&["--shard", shard, "-o", "part.film"], &["shard", shard]);
    }
    refused(&["--shard", "1/2", "-o", "part.png"], &["image", "part.png", "not a picture"]);
    refused(&["--shard", "1/2", "-o", "part.film", "--spp", "16"], &["shard", "blocks of 16", "at most 1"]);
    refused(&["--shard", "1/7", "--shard-by", "tiles", "-o", "part.film"], &["shard", "tiles of 32x32", "at most 6"]);
    refused(&["--shard", "1/2"], &["--image"]);
    refused(&["--shard-by", "tiles"], &["--shard"]);
    refused(&["--shard", "1/2", "-o", "p", "--clamp", "subpixel", "--spp", "32"], &["clamp"]);
    refused(&["--shard", "1/2", "-o", "p", "--sampler", "locked", "--spp", "32"], &["locked"]);
    for option in [["--target-error", "0.1"], ["--time-limit", "1"], ["--checkpoint", "c"], ["--trace", "t.csv"]] {
        refused(&[&["--shard", "1/2", "-o", "p"], option.as_slice()].concat(), &["--shard", option[0]]);
    }
    refused(&["--shard", "auto", "-o", "p"], &["shard", "SLURM_ARRAY_TASK_ID"]);
}

/// The variables as SLURM sets them for `--array=3-6`, and for an array with gaps.
#[test]
fn a_task_of_an_array_knows_its_shard() {
    let folder = in_memory();
    let task = |id: &str, count: &str, name: &str, code: i32| {
        let options = ["--spp", "64", "--shard", "auto", "-o", name, "--json"];
        let mut command = pathmark(folder.path(), &[SIZE.as_slice(), &options].concat());
        let array = [("ID", id), ("COUNT", count), ("MIN", "3"), ("MAX", "6")];
        command.envs(array.map(|(suffix, value)| (format!("SLURM_ARRAY_TASK_{suffix}"), value)));
        finish(command).with_code(code)
    };
    for (id, index) in [("3", 1), ("4", 2), ("5", 3), ("6", 4)] {
        let said = json(&task(id, "4", &format!("{index}.film"), 0).out);
        assert_eq!((&said["shard"], &said["shards"], &said["samples"]), (&index.into(), &4.into(), &16.into()));
    }
    run(folder.path(), &["merge", "1.film", "2.film", "3.film", "4.film", "-o", "whole.png"]);
    assert!(task("5", "2", "gap.film", 2).err.contains("gaps"));
    assert!(task("9", "4", "beyond.film", 2).err.contains("shard"));
}
