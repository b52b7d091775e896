//! F02: every step of every writer fails in every way. The exit code is the system's (3), the message names the file,
//! and the old file stays unchanged. Short and interrupted writes give the same bytes.

use pathmark::disk::{Step, with_faults};
use pathmark::error::Result;
use pathmark::experiment::RecordsFile;
use pathmark::film::Film;
use pathmark::film_file::write_film;
use pathmark::image_io::{self, FORMATS, Image};
use pathmark::kernel::Spec;
use pathmark::measure::{Checkpoint, Position, Record, Rounds, Settings, Setup, TraceFile};
use pathmark::{atomic_file, measure};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// A function that creates or replaces the file at a path.
type Writer = Box<dyn Fn(&Path) -> Result<()>>;

fn setup() -> Setup {
    let spec = Spec { width: 12, height: 9, ..Spec::default() };
    Setup::prepare(Settings { spp: 16, spec, decomposition: "tiles:4x4".into(), ..Settings::default() }).unwrap()
}

fn record(repetition: u32) -> Record {
    // Fixed, so that equal calls give equal records.
    let started_utc = "2000-01-01T00:00:00Z".to_string();
    Record { cell: "a cell, quoted".into(), repetition, started_utc, ..measure::failure(&Settings::default(), "") }
}

/// A writer for every kind of file, with a file name. [`the_rows_of_a_sweep`] tests the writers that append to an old
/// file.
fn writers() -> Vec<(String, Writer)> {
    let image = Image { width: 2, height: 2, pixels: vec![[0.25, 0.5, 1.0]; 4] };
    let mut writers: Vec<(String, Writer)> = Vec::new();
    for format in FORMATS {
        let image = image.clone();
        writers.push((format!("image.{}", format.name), Box::new(move |path| image_io::write(path, &image))));
    }
    let mut rounds = Rounds::new(setup()).unwrap();
    rounds.extend_to(16, None).unwrap();
    let (key, film) = (rounds.film_key(), rounds.film());
    writers.push(("half.film".into(), Box::new(move |path| write_film(path, &key, &film))));
    let save = move |path: &Path| {
        let (checkpoint, _) = Checkpoint::open(path, &rounds, None)?;
        checkpoint.save(&rounds, Position { rendering_s: 1.0, look: 16 })
    };
    writers.push(("render.checkpoint".into(), Box::new(save)));
    let outcome = setup().run(None).unwrap();
    let trace = TraceFile::new(&setup(), &outcome);
    writers.push(("trace.csv".into(), Box::new(move |path| trace.write(path))));
    let long = vec![b'x'; 100_000];
    writers.push(("report.html".into(), Box::new(move |path| atomic_file::write(path, |out| out.write_all(&long)))));
    writers
}

/// The contents of a folder's files by path. A checkpoint's lock file exists only during the write.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.map(|path| (path.clone(), fs::read(&path).unwrap())).collect()
}

/// The steps of an undisturbed write.
fn steps_of(body: impl FnOnce() -> Result<()>) -> Vec<Step> {
    let steps = Rc::new(std::cell::RefCell::new(Vec::new()));
    let noted = Rc::clone(&steps);
    let note = move |step| {
        noted.borrow_mut().push(step);
        Ok(usize::MAX)
    };
    with_faults(note, body).unwrap();
    steps.take()
}

/// Errors of the system at one step: no space, no quota, a broken disk, a read-only file system.
const REFUSALS: [fn() -> io::Error; 4] = [
    || ErrorKind::StorageFull.into(),
    || ErrorKind::QuotaExceeded.into(),
    || io::Error::from_raw_os_error(5),
    || ErrorKind::ReadOnlyFilesystem.into(),
];

/// A disk that works until step `at`. It takes `taken` bytes of that step if it is a write, and refuses all later
/// steps.
fn refuses_from(at: usize, taken: usize, refusal: fn() -> io::Error) -> impl FnMut(Step) -> io::Result<usize> {
    let mut steps = 0..;
    move |step| match steps.next().unwrap_or(at) {
        now if now < at => Ok(usize::MAX),
        now if now == at && taken > 0 && matches!(step, Step::Write(_)) => Ok(taken),
        _ => Err(refusal()),
    }
}

/// Asserts that `body` fails as the system's fault on the file `path`, wherever the disk fails, and leaves `folder`
/// unchanged.
fn fails_everywhere(folder: &Path, path: &Path, steps: &[Step], body: impl Fn() -> Result<()>) {
    let before = files(folder);
    for (at, step) in steps.iter().enumerate() {
        let lengths = if let Step::Write(length) = step { vec![0, 1, length / 2, length - 1] } else { vec![0] };
        for (&taken, refusal) in lengths.iter().flat_map(|taken| REFUSALS.map(|refusal| (taken, refusal))) {
            let what = format!("{}: {step:?}, step {at}, {taken} bytes, {}", path.display(), refusal());
            let error = with_faults(refuses_from(at, taken, refusal), &body).expect_err(&what);
            assert_eq!(error.exit_code(), 3, "{what}: {error}");
            assert!(error.to_string().contains(path.to_str().unwrap()), "{what}: {error}");
            assert!(error.to_string().contains(&refusal().to_string()), "{what}: {error}");
            assert!(files(folder) == before, "{what}: a file has changed");
        }
    }
}

#[test]
fn every_step_of_every_writer_may_fail() {
    for (name, write) in writers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(&name);
        let steps = steps_of(|| write(&path));
        assert!(matches!(steps[..], [Step::Create, Step::Write(_), .., Step::Sync, Step::Rename]), "{name}: {steps:?}");
        // Over an existing file, then without one.
        fails_everywhere(folder.path(), &path, &steps, || write(&path));
        fs::remove_file(&path).unwrap();
        fails_everywhere(folder.path(), &path, &steps, || write(&path));
    }
}

#[test]
fn short_and_interrupted_writes_change_no_byte() {
    for (name, write) in writers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(&name);
        write(&path).unwrap();
        let expected = fs::read(&path).unwrap();
        let calls = Rc::new(Cell::new(0_usize));
        let counted = Rc::clone(&calls);
        let slow = move |step| {
            counted.set(counted.get() + 1);
            match step {
                Step::Write(_) if counted.get().is_multiple_of(3) => Err(ErrorKind::Interrupted.into()),
                _ => Ok(7),
            }
        };
        with_faults(slow, || write(&path)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), expected, "{name}");
        assert!(calls.get() > expected.len() / 7, "{name}: {} calls", calls.get());
    }
}

/// Rows are appended: a failed write leaves the earlier rows, and the same row can follow when there is space again.
#[test]
fn the_rows_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("records.csv");
    let mut file = RecordsFile::create(&path).unwrap();
    for repetition in 0..3 {
        let row = record(repetition);
        let steps = {
            // In a copy, so that `path` does not get the row.
            let copy = folder.path().join("copy.csv");
            fs::copy(&path, &copy).unwrap();
            let (mut file, _) = RecordsFile::resume(&copy).unwrap();
            let steps = steps_of(|| file.append(&row));
            fs::remove_file(&copy).unwrap();
            steps
        };
        assert!(matches!(steps[..], [Step::Write(_), Step::Sync]), "{steps:?}");
        let file = std::cell::RefCell::new(&mut file);
        fails_everywhere(folder.path(), &path, &steps, || file.borrow_mut().append(&row));
        file.borrow_mut().append(&row).unwrap();
        let rows = pathmark::experiment::read_records(&path).unwrap();
        assert_eq!(rows, (0..=repetition).map(record).collect::<Vec<_>>());
    }
    drop(file);

    // A resumed sweep rewrites the file without its torn row; until then, the old file stays.
    let whole = fs::read(&path).unwrap();
    let torn = [&whole[..], &whole[whole.len() - 20..whole.len() - 1]].concat();
    fs::write(&path, &torn).unwrap();
    let resume = || RecordsFile::resume(&path).map(|_| ());
    let steps = steps_of(resume);
    assert_eq!(fs::read(&path).unwrap(), whole);
    fs::write(&path, &torn).unwrap();
    fails_everywhere(folder.path(), &path, &steps, resume);

    let other = folder.path().join("other.csv");
    fails_everywhere(folder.path(), &other, &[Step::Create], || RecordsFile::create(&other).map(|_| ()));
}

/// F01, a model of a power cut: the log of rows ends at any of its bytes. Resuming keeps exactly the whole rows before
/// that byte, and the following rows restore the log. Fields contain any text: a line end within a field ends no row.
#[test]
fn a_log_that_ends_at_any_byte_keeps_its_whole_rows() {
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap();
    let path = folder.path().join("records.csv");
    for cell in ["a cell, quoted", "two\nlines", "\n", "\"\n\"\"\n", "\r\n,\"\n,", "it said:\n\n\"no\",\n"] {
        let rows: Vec<Record> = (0..3).map(|repetition| Record { cell: cell.into(), ..record(repetition) }).collect();
        fs::remove_file(&path).ok();
        let mut file = RecordsFile::create(&path).unwrap();
        let mut ends = Vec::new();
        for row in &rows {
            file.append(row).unwrap();
            ends.push(fs::metadata(&path).unwrap().len());
        }
        drop(file);
        let whole = fs::read(&path).unwrap();
        for end in 0..whole.len() {
            fs::write(&path, &whole[..end]).unwrap();
            let finished = ends.iter().filter(|row| **row <= end as u64).count();
            assert_eq!(RecordsFile::has_rows(&path).unwrap(), finished > 0, "{cell:?}, {end} bytes");
            let (mut file, kept) = RecordsFile::resume(&path).unwrap();
            assert!(kept == rows[..finished], "{cell:?}, {end} bytes: {} rows instead of {finished}", kept.len());
            for row in &rows[finished..] {
                file.append(row).unwrap();
            }
            assert!(fs::read(&path).unwrap() == whole, "{cell:?}, {end} bytes: another log");
        }
        // A power cut may leave bytes that are no text.
        for tail in [[0; 100], [0xff; 100]] {
            fs::write(&path, [whole.as_slice(), &tail].concat()).unwrap();
            assert!(RecordsFile::resume(&path).unwrap().1 == rows, "{cell:?}");
            assert!(fs::read(&path).unwrap() == whole, "{cell:?}: the tail is still there");
        }
        // An open quote before whole rows is damage, not a torn row: nothing after it is dropped.
        let mut damaged = whole.clone();
        damaged[ends[0] as usize] = b'"';
        fs::write(&path, &damaged).unwrap();
        let error = RecordsFile::resume(&path).err().expect("a refusal");
        assert_eq!(error.exit_code(), 2, "{error}");
        assert_eq!(fs::read(&path).unwrap(), damaged);
    }
}

/// Another program ignores the lock and changes the file under a running sweep: no further row is written.
#[test]
fn a_log_that_was_replaced_or_changed_takes_no_row() {
    type Deed = fn(&Path);
    let deeds: [(&str, Deed); 7] = [
        ("removed", |path| fs::remove_file(path).unwrap()),
        ("moved away", |path| fs::rename(path, path.with_extension("old")).unwrap()),
        ("its folder moved away", |path| {
            let folder = path.parent().unwrap();
            fs::rename(folder, folder.with_extension("old")).unwrap();
        }),
        ("replaced by a copy", |path| {
            let copy = path.with_extension("copy");
            fs::copy(path, &copy).unwrap();
            fs::rename(&copy, path).unwrap();
        }),
        ("cut off", |path| fs::File::options().write(true).open(path).unwrap().set_len(100).unwrap()),
        ("emptied", |path| drop(fs::File::create(path).unwrap())),
        ("made longer", |path| {
            io::Write::write_all(&mut fs::File::options().append(true).open(path).unwrap(), b"x").unwrap();
        }),
    ];
    for (what, deed) in deeds {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sweep/records.csv");
        fs::create_dir(path.parent().unwrap()).unwrap();
        let mut file = RecordsFile::create(&path).unwrap();
        file.append(&record(0)).unwrap();
        file.check_own().unwrap();
        deed(&path);
        let before = fs::read(&path).ok();
        for refused in [file.append(&record(1)), file.check_own()] {
            let error = refused.expect_err(what);
            assert!(error.exit_code() == 2 && error.to_string().contains("records.csv"), "{what}: {error}");
        }
        assert!(fs::read(&path).ok() == before, "{what}");
    }
}

/// The files written above can be read back, so the tested writers write real contents.
#[test]
fn written_files_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, write) in writers() {
        write(&folder.path().join(name)).unwrap();
    }
    let at = |name: &str| folder.path().join(name);
    let (_, film): (_, Film) = pathmark::film_file::read_film(&at("half.film")).unwrap();
    assert_eq!(film.checksum(), setup().run(None).unwrap().film.checksum());
    let (_, saved) = Checkpoint::open(&at("render.checkpoint"), &Rounds::new(setup()).unwrap(), None).unwrap();
    assert_eq!(saved.unwrap().film.film(), film);
    assert_eq!(TraceFile::read(&at("trace.csv")).unwrap().rows.len(), 3 * 3);
    for format in FORMATS {
        let image = image_io::read(&at(&format!("image.{}", format.name))).unwrap();
        assert_eq!((image.width, image.height), (2, 2));
    }
}
