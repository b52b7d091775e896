//! Shards: parts of an image that are rendered apart and merged give the bits of the whole image, or are refused.

use pathmark::film::{Shard, ShardCut};
use pathmark::kernel::Spec;
use pathmark::measure::{Checkpoint, Position, Rounds, Settings, Setup, merge};
use std::fs;
use std::path::{Path, PathBuf};
use std::slice::from_ref;

type Change = fn(&mut Settings);

const CUTS: [ShardCut; 2] = [ShardCut::Samples, ShardCut::Tiles];

fn settings(spp: u32, precision: &str) -> Settings {
    let spec = Spec { width: 97, height: 40, estimator: "mis".into(), ..Spec::default() };
    let spec = Spec { precision: precision.into(), ..spec };
    Settings { spp, spec, threads: 2, decomposition: "tiles:16x16".into(), ..Settings::default() }
}

fn shard(index: u32, count: u32, cut: ShardCut) -> Shard {
    Shard::new(index, count, cut).unwrap()
}

/// Renders a part in rounds that end at `steps`, and keeps it in a file.
fn render(folder: &Path, settings: Settings, shard: Shard, steps: &[u32]) -> PathBuf {
    let path = folder.join(format!("{}-{}-{}", shard.index(), shard.count(), shard.cut()));
    let end = shard.samples(settings.spp).end;
    let mut rounds = Rounds::of(Setup::prepare(settings).unwrap(), Some(shard)).unwrap();
    let (checkpoint, _) = Checkpoint::open(&path, &rounds, None).unwrap();
    for step in steps.iter().copied().filter(|step| *step < end).chain([end]) {
        rounds.extend_to(step, None).unwrap();
        checkpoint.save(&rounds, Position { rendering_s: 1.0, look: end }).unwrap();
    }
    path
}

/// Every cut into 1, 2, 3, 5 and 7 parts, with different kernels, strategies and decompositions, in several rounds,
/// merged in any order.
#[test]
fn merged_parts_have_the_bits_of_the_whole() {
    for precision in ["f64", "f32"] {
        // 7 blocks of samples, the last one unfinished.
        let whole = settings(104, precision);
        let expected = Setup::prepare(whole.clone()).unwrap().run(None).unwrap().film.checksum();
        for cut in CUTS {
            for count in [1, 3, 7] {
                let folder = tempfile::tempdir().unwrap();
                let mut parts: Vec<PathBuf> = (1..=count)
                    .map(|index| {
                        let by = [
                            ("work-stealing", "tiles:16x16"),
                            ("static-blocks", "rows"),
                            ("serial", "samples:16:40x24"),
                        ];
                        let (strategy, decomposition) = by[index as usize % by.len()];
                        let mut settings = Settings {
                            strategy: strategy.into(),
                            decomposition: decomposition.into(),
                            ..whole.clone()
                        };
                        if precision == "f64" && index % 2 == 0 {
                            settings.spec.kernel = "scalar".into();
                        }
                        let steps: &[u32] = if index % 2 == 0 { &[48, 64, 100] } else { &[] };
                        let start = shard(index, count, cut).samples(whole.spp).start;
                        let steps: Vec<u32> = steps.iter().copied().filter(|step| *step > start).collect();
                        render(folder.path(), settings, shard(index, count, cut), &steps)
                    })
                    .collect();
                let middle = parts.len() / 2;
                parts.rotate_left(middle);
                let merged = merge(&parts, false).unwrap();
                assert_eq!(merged.film.checksum(), expected, "{precision}, {count} parts by {cut}");
                assert_eq!((merged.key.spp, merged.count, merged.missing.len()), (104, count, 0));
            }
        }
    }
}

fn refused(parts: &[PathBuf], said: &[&str]) {
    let Err(error) = merge(parts, false) else { panic!("{said:?} was expected of {parts:?}") };
    assert_eq!(error.exit_code(), 2);
    let text = error.to_string();
    assert!(said.iter().all(|words| text.contains(words)), "{said:?} is not in {text}");
}

#[test]
fn parts_that_do_not_make_an_image_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let image = || Settings { strategy: "serial".into(), ..settings(64, "f64") };
    for cut in CUTS {
        let [one, two, three] = [1, 2, 3].map(|index| render(folder.path(), image(), shard(index, 3, cut), &[]));
        refused(&[], &["no parts"]);
        refused(&[one.clone(), three.clone()], &["2/3"]);
        refused(from_ref(&two), &["1/3", "3/3"]);
        let copy = folder.path().join("copy");
        fs::copy(&two, &copy).unwrap();
        refused(&[one.clone(), two.clone(), copy.clone(), three.clone()], &["2/3", "copy"]);
        // Each field in which images differ, and the cut itself.
        let other = tempfile::tempdir().unwrap();
        let with = |change: Change| {
            let mut settings = image();
            change(&mut settings);
            render(other.path(), settings, shard(2, 3, cut), &[])
        };
        let changes: [(&str, Change); 6] = [
            ("seed is 2", |settings| settings.spec.seed = 2),
            ("spp", |settings| settings.spp = 80),
            ("estimator", |settings| settings.spec.estimator = "bsdf".into()),
            ("width", |settings| settings.spec.width = 100),
            ("scene", |settings| settings.scene = "cornell-mirror".into()),
            ("precision", |settings| settings.spec.precision = "f32".into()),
        ];
        for (said, change) in changes {
            let changed = with(change);
            refused(&[one.clone(), changed.clone(), three.clone()], &[said, "belong"]);
            fs::remove_file(changed).unwrap();
        }
        let quarter = render(other.path(), image(), shard(2, 4, cut), &[]);
        refused(&[one.clone(), quarter, three.clone()], &["shard", "belong"]);
        // A missing or changed byte, in the header and in the sums.
        let bytes = fs::read(&two).unwrap();
        for damaged in [bytes[..bytes.len() - 1].to_vec(), bytes[..100].to_vec(), Vec::new()] {
            fs::write(&copy, damaged).unwrap();
            assert_eq!(merge(&[one.clone(), copy.clone(), three.clone()], true).err().unwrap().exit_code(), 2);
        }
        for place in [3, 40, 200, bytes.len() / 2, bytes.len() - 3] {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            fs::write(&copy, damaged).unwrap();
            assert_eq!(
                merge(&[one.clone(), copy.clone(), three.clone()], true).err().unwrap().exit_code(),
                2,
                "{place}"
            );
        }
        fs::remove_file(copy).unwrap();
    }
}

/// A partial image contains the available parts: missing tiles are black, and missing samples do not enter the mean.
#[test]
fn a_partial_image_is_of_the_parts_that_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let image = || Settings { strategy: "serial".into(), ..settings(64, "f64") };
    let whole = Setup::prepare(image()).unwrap().run(None).unwrap().film;
    for cut in CUTS {
        let parts = [1, 3].map(|index| render(folder.path(), image(), shard(index, 4, cut), &[]));
        let merged = merge(&parts, true).unwrap();
        assert_eq!(merged.missing, ["2/4", "4/4"]);
        for (index, (pixel, whole)) in merged.film.pixels().iter().zip(whole.pixels()).enumerate() {
            let (x, y) = (index as u32 % 97, index as u32 / 97);
            let owned = [1, 3].iter().any(|part| shard(*part, 4, cut).owns(x, y));
            match cut {
                ShardCut::Tiles if owned => assert_eq!(pixel, whole),
                ShardCut::Tiles => assert_eq!(pixel.count, 0),
                ShardCut::Samples => assert_eq!(pixel.count, 32),
            }
        }
    }
}

#[test]
fn a_part_that_is_not_finished_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    for cut in CUTS {
        let first = render(folder.path(), settings(128, "f64"), shard(1, 2, cut), &[]);
        let path = folder.path().join("begun");
        let second = shard(2, 2, cut);
        let start = second.samples(128).start;
        let mut rounds = Rounds::of(Setup::prepare(settings(128, "f64")).unwrap(), Some(second)).unwrap();
        let (checkpoint, _) = Checkpoint::open(&path, &rounds, None).unwrap();
        rounds.extend_to(start + 32, None).unwrap();
        checkpoint.save(&rounds, Position { rendering_s: 1.0, look: 128 }).unwrap();
        let want = format!("2/2: 32 of {} samples", 128 - start);
        refused(&[first.clone(), path.clone()], &[&want, "begun"]);
        assert_eq!(merge(&[first, path.clone()], true).unwrap().missing.len(), 1);
        drop(checkpoint);
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn a_part_goes_on_as_itself_alone() {
    let folder = tempfile::tempdir().unwrap();
    for cut in CUTS {
        let path = render(folder.path(), settings(64, "f64"), shard(2, 3, cut), &[]);
        let open = |shard, spp| {
            let rounds = Rounds::of(Setup::prepare(settings(spp, "f64")).unwrap(), shard).unwrap();
            Checkpoint::open(&path, &rounds, None).map(|(_, saved)| saved.is_some())
        };
        assert!(open(Some(shard(2, 3, cut)), 64).unwrap());
        for (shard, spp) in
            [(Some(shard(1, 3, cut)), 64), (Some(shard(2, 4, cut)), 64), (None, 64), (Some(shard(2, 3, cut)), 80)]
        {
            assert_eq!(open(shard, spp).unwrap_err().exit_code(), 2, "{shard:?} of {spp}");
        }
    }
}

#[test]
fn more_shards_than_there_is_work_are_refused() {
    for (cut, most) in [(ShardCut::Samples, 4), (ShardCut::Tiles, 8)] {
        let of = |count| Rounds::of(Setup::prepare(settings(64, "f64")).unwrap(), Some(shard(1, count, cut)));
        assert!(of(most).is_ok());
        let error = of(most + 1).err().unwrap();
        assert!(error.exit_code() == 2 && error.to_string().contains(&format!("at most {most}")), "{error}");
    }
}
