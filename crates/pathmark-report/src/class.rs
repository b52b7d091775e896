//! Classes: a folder with a folder for each student, which is either an experiment's folder under the student's name or a
//! folder of results. Machines differ, so the class is compared by speedups.

use crate::error::{Error, InputError};
use crate::experiment::{Chapter, MACHINE, has_records, read_run_file};
use crate::files::entries;
use crate::page::Section;
use crate::prelude::*;
use crate::schedule::crew;
use crate::{PAGES, bursts, cases_file, claims, guard_prices};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Folders beside experiments in which a sweep leaves the rows of another build.
const OTHER_BUILDS: [&str; 2] = ["baseline", "against"];

/// Folders that Pathmark writes beside experiments, which are no student's.
const NO_STUDENTS: [&str; 7] =
    ["figures", PAGES, "references", guard_prices::FOLDER, cases_file::FOLDER, bursts::FOLDER, claims::FOLDER];

/// How many levels below a student's folder rows are looked for, to say where they are.
const DEEPEST: usize = 3;

/// An experiment's folder on the page.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Member {
    pub(crate) folder: PathBuf,
    /// The name of the student's folder; `None` if the folder has the name of its experiment.
    pub(crate) student: Option<String>,
}

/// The experiments of a page, sorted by their folders: the folder itself if it has rows, otherwise those in it, or those of
/// a class. A folder is a class if none in it has the name of its experiment, and there is more than one, or one with
/// experiments in it.
pub(crate) fn members(out: &Path) -> Result<Vec<Member>> {
    if has_records(out) {
        return Ok(vec![Member { folder: out.to_path_buf(), student: None }]);
    }
    let (with_rows, others): (Vec<PathBuf>, Vec<PathBuf>) =
        folders(out)?.into_iter().partition(|path| has_records(path));
    let mut found = with_rows.into_iter().map(member).collect::<Vec<Member>>();
    // A folder of results may have others in it, such as those of earlier versions.
    if found.iter().all(|member| member.student.is_some()) {
        for student in others.into_iter().filter(|folder| !OTHER_BUILDS.contains(&name_of(folder).as_str())) {
            let own = folders(&student)?.into_iter().filter(|path| has_records(path));
            found.extend(own.map(|folder| Member { folder, student: Some(name_of(&student)) }));
        }
    }
    let is_alone = found.len() == 1 && found[0].folder.parent() == Some(out);
    if is_alone || found.iter().any(|member| member.student.is_none()) {
        for member in &mut found {
            member.student = None;
        }
    }
    found.sort_by(|a, b| a.folder.cmp(&b.folder));
    Ok(found)
}

fn name_of(folder: &Path) -> String {
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The folders in that of a class that have neither rows nor experiments, each in a sentence; none for results of one's own.
pub(crate) fn without_rows(out: &Path, members: &[Member]) -> Result<Vec<String>> {
    // A student alone is on a page like any experiment's.
    let is_student = |own: &Member| {
        own.student.is_some() || (own.folder.parent() == Some(out) && member(own.folder.clone()).student.is_some())
    };
    if members.is_empty() || !members.iter().all(is_student) {
        return Ok(Vec::new());
    }
    let mut told = Vec::new();
    for folder in folders(out)? {
        let name = name_of(&folder);
        let is_own =
            name.starts_with('.') || OTHER_BUILDS.contains(&name.as_str()) || NO_STUDENTS.contains(&name.as_str());
        if is_own || members.iter().any(|member| member.folder.starts_with(&folder)) {
            continue;
        }
        let deeper = rows_below(&folder, DEEPEST);
        let place = deeper.and_then(|found| Some(found.strip_prefix(out).ok()?.display().to_string()));
        let place = place.map_or_else(String::new, |place| format!("; there is one in {place}, which is too deep"));
        told.push(format!("{name} is left out: neither it nor a folder in it has a records.csv{place}"));
    }
    Ok(told)
}

/// The first folder with rows below another one, at most so many levels deep.
fn rows_below(folder: &Path, levels: usize) -> Option<PathBuf> {
    let of_inner = |inner: PathBuf| {
        let deeper = || if levels > 1 { rows_below(&inner, levels - 1) } else { None };
        if has_records(&inner) { Some(inner) } else { deeper() }
    };
    folders(folder).ok()?.into_iter().find_map(of_inner)
}

/// A folder that does not have the name of the experiment that was run has that of a student. So has one whose file about
/// the run cannot be read, which the page tells.
fn member(folder: PathBuf) -> Member {
    let (path, own) = (folder.join(MACHINE), name_of(&folder));
    let is_other = path.is_file()
        && read_run_file(&path).map_or(true, |run| {
            Path::new(&run.experiment).file_stem().is_some_and(|stem| stem.to_string_lossy() != own)
        });
    Member { student: is_other.then_some(own), folder }
}

fn folders(out: &Path) -> Result<Vec<PathBuf>> {
    let mut found = entries(out).map_err(|error| match &error {
        Error::System { source, .. } if [ErrorKind::NotFound, ErrorKind::NotADirectory].contains(&source.kind()) => {
            InputError::new("folder", out.display().to_string(), "there is no such folder").into()
        }
        _ => error,
    })?;
    found.retain(|path| path.is_dir());
    Ok(found)
}

/// The section of an experiment; if it is a student's, the heading begins with the folder's name, and it is no answer of
/// the page, which is about all of them.
pub(crate) fn of_student(student: Option<&str>, mut section: Section) -> Section {
    let Some(student) = student else { return section };
    let name = if section.name == student { section.name } else { format!("{student}-{}", section.name) };
    section.blocks.retain(|block| !matches!(block, Block::Answer { .. }));
    Section { name, title: format!("{student}: {}", section.title), in_short: None, ..section }
}

/// A schedule in a student's folder.
struct Line {
    student: String,
    schedule: String,
    speedup: Ratio,
    processors: usize,
    processor: String,
}

/// The speedups of a class.
#[derive(Default)]
pub(crate) struct Class {
    students: BTreeSet<String>,
    machines: BTreeSet<String>,
    /// The first chapter of their experiments.
    chapter: Option<Chapter>,
    lines: Vec<Line>,
}

impl Class {
    pub(crate) fn add(&mut self, student: &str, results: &Results) -> Result<()> {
        let serial = results.serial()?;
        let machine = &results.run.machine;
        self.students.insert(student.to_string());
        self.machines.insert(machine.line());
        let own = results.definition.chapter;
        self.chapter = Some(self.chapter.map_or(own, |first| first.min(own)));
        self.lines.extend(serial.speedups().into_iter().map(|(schedule, speedup)| Line {
            student: student.to_string(),
            schedule: crew(&serial.line(schedule), schedule.key.threads),
            speedup,
            processors: machine.processors,
            processor: machine.cpu.clone(),
        }));
        Ok(())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.students.is_empty()
    }

    /// The section before those of the students, for the page of the folder `out`; `None` without any.
    pub(crate) fn section(&self, out: &Path) -> Option<Section> {
        let folders = counted(self.students.len(), "folder");
        let found = format!(
            "{folders}, {} of machine.{} Each speedup is a ratio of times within one folder, so folders compare although \
             machines differ. Seconds would not.",
            counted(self.machines.len(), "kind"),
            self.range().unwrap_or_default()
        );
        let all = Block::table("class", "Speedups of the class, against serial in the same folder", &self.lines)
            .column("folder", |line| line.student.clone())
            .column("schedule", |line| line.schedule.clone())
            .estimated("speedup", Decimals(2), |line| Estimated::from(line.speedup))
            .column("processors", |line| line.processors.to_string())
            .column("processor", |line| line.processor.clone())
            .end();
        let name = out.canonicalize().map(|folder| name_of(&folder)).unwrap_or_default();
        Some(Section {
            name: "the-class".to_string(),
            title: "The class".to_string(),
            page_title: Some(joined([name, format!("speedups of {folders}")])),
            question: "How many times as fast as serial is each schedule, in each folder?".to_string(),
            chapter: Some(self.chapter?),
            in_short: Some(found.clone()),
            blocks: vec![Block::finding(found), self.by_schedule(), Block::figure("class", self.plot()), all],
            ..Section::default()
        })
    }

    /// The highest speedup of each folder, the highest first.
    fn highest(&self) -> Vec<&Line> {
        let of_folders = gathered(self.lines.iter().map(|line| (&line.student, line))).into_values();
        let mut lines: Vec<&Line> =
            of_folders.filter_map(|own| own.into_iter().min_by(|a, b| a.speedup.falling(&b.speedup))).collect();
        lines.sort_by(|a, b| a.speedup.falling(&b.speedup));
        lines
    }

    /// A sentence about the highest speedups; `None` if no folder has one that is ranked.
    fn range(&self) -> Option<String> {
        let highest = self.highest().into_iter().map(|line| line.speedup).filter(|speedup| !speedup.is_partial);
        let speedups: Vec<f64> = highest.map(|speedup| speedup.value).collect();
        let (most, least) = (speedups.first()?, speedups.last()?);
        Some(format!(
            " The highest speedup of a folder is between {least:.2} and {most:.2}, with the median {:.2}.",
            median(&speedups)?
        ))
    }

    fn plot(&self) -> DotPlot {
        let row = |line: &Line| {
            let dot = Estimated::from(line.speedup).dot();
            DotRow::new(format!("{}: {}", line.student, line.schedule), vec![Some(dot)])
        };
        let rows = self.highest().into_iter().map(row).collect();
        let axis = Axis::linear("speedup against serial in the same folder").including([1.0]);
        let mut plot = DotPlot::new(Title::new("The highest speedup of each folder"), axis, rows);
        plot.guides = vec![(1.0, "serial".to_string())];
        plot.subtitle = counted(self.machines.len(), "kind") + " of machine";
        plot.caption = ratio_bars(self.highest().into_iter().map(|line| line.speedup));
        plot
    }

    /// The speedups of each schedule over the folders.
    fn by_schedule(&self) -> Block {
        let kinds = gathered(self.lines.iter().map(|line| (line.schedule.as_str(), line)));
        let kinds = kinds.into_iter().map(|(schedule, mut own)| {
            own.sort_by(|a, b| a.speedup.rising(&b.speedup));
            // Partial ones follow all others.
            own.retain(|line| !line.speedup.is_partial);
            (schedule, own)
        });
        let speedup = |line: Option<&&Line>| line.map(|line| line.speedup.value);
        let folder = |line: Option<&&Line>| line.map_or_else(String::new, |line| line.student.clone());
        Block::table("class-schedules", "Speedups of each schedule over the folders", kinds)
            .column("schedule", |(schedule, _)| (*schedule).to_string())
            .number("folders", Decimals(0), |(_, own)| own.len() as f64)
            .number("median", Decimals(2), |(_, own)| {
                median(&own.iter().map(|line| line.speedup.value).collect::<Vec<f64>>())
            })
            .number("lowest", Decimals(2), |(_, own)| speedup(own.first()))
            .column("in folder", |(_, own)| folder(own.first()))
            .number("highest", Decimals(2), |(_, own)| speedup(own.last()))
            .column("of folder", |(_, own)| folder(own.last()))
            .end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::RunFile;
    use crate::lab::Lab;
    use crate::measure::Record;
    use crate::tests::{folder_of, row};
    use std::fs;

    /// Six repetitions of serial and of a pool that is twice as fast, on a machine that takes `factor` times as long.
    fn rows(factor: f64) -> Vec<Record> {
        let of = |repetition: u32| {
            let seconds = factor * (1.0 + 0.1 * f64::from(repetition));
            let pool = Record { strategy: "pool".to_string(), threads: 2, makespan_s: Some(0.5 * seconds), ..row() };
            [Record { makespan_s: Some(seconds), ..row() }, pool].map(|row| Record { repetition, ..row })
        };
        (0..6).flat_map(of).collect()
    }

    /// A student's experiment under the student's name, and another student's folder of results.
    fn class() -> tempfile::TempDir {
        let class = tempfile::tempdir().unwrap();
        let [anna, bert] = [1.0, 7.0].map(|factor| folder_of(&["speedup"], "", rows(factor)));
        for (from, to) in [(anna.path().join("an-experiment"), "anna"), (bert.path().to_path_buf(), "bert b")] {
            copy(&from, &class.path().join(to));
        }
        let run =
            RunFile { experiment: "lab.toml".to_string(), ..RunFile::of_now("pathmark run lab.toml".to_string()) };
        run.write(&class.path().join("anna/machine.toml")).unwrap();
        class
    }

    fn copy(from: &Path, to: &Path) {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
            let to = to.join(entry.file_name().unwrap());
            if entry.is_dir() { copy(&entry, &to) } else { _ = fs::copy(&entry, &to).unwrap() }
        }
    }

    #[test]
    fn a_class_has_a_heading_for_each_folder_and_a_table_of_ratios() {
        let class = class();
        let page = fs::read_to_string(crate::write(&Lab::built_in(), class.path()).unwrap()).unwrap();
        let headings = ["<h3>The class</h3>", "<h3>anna: </h3>", "<h3>bert b: </h3>"];
        let places = headings.map(|heading| page.find(heading).unwrap_or_else(|| panic!("{heading}: {page}")));
        assert!(places.is_sorted());
        assert!(page.contains("id=\"bert-b-an-experiment\"") && page.contains("bert b/an-experiment/records.csv"));
        let mut found = Class::default();
        for Member { folder, student } in members(class.path()).unwrap() {
            let results = Results::open(&Lab::built_in(), &folder).unwrap();
            found.add(&student.unwrap(), &results).unwrap();
        }
        let section = found.section(class.path()).unwrap();
        let Some(Block::Table { table, .. }) = section.blocks.last() else { panic!("a table of all") };
        let shown: Vec<[String; 3]> = table.rows().map(|row| [&row[0], &row[1], &row[2]].map(Clone::clone)).collect();
        // The machine of one student takes seven times as long.
        let told = "2.00, 2.00 to 2.00 (96.8 %)";
        assert_eq!(shown, [["anna", "pool, 2 threads", told], ["bert b", "pool, 2 threads", told]]);
    }

    #[test]
    fn names_of_folders_break_no_link() {
        let class = class();
        fs::rename(class.path().join("anna"), class.path().join("a #1 50%")).unwrap();
        let index = crate::write_pages("--pages", &Lab::built_in(), class.path()).unwrap().path;
        let page = fs::read_to_string(class.path().join("report.html")).unwrap();
        let links =
            ["a%20%231%2050%25/records.csv", "bert%20b/an-experiment/machine.toml", "#a--1-50-", "#a--1-50--again"];
        for link in links {
            assert!(page.contains(&format!("href=\"{link}\"")), "{link}: {page}");
        }
        assert!(page.contains("<section id=\"a--1-50-\""), "{page}");
        let index = fs::read_to_string(index).unwrap();
        assert!(index.contains("href=\"a%20%231%2050%25.html\""), "{index}");
        assert!(class.path().join("pages/a #1 50%.html").is_file());
    }

    /// A student's rows lie too deep, one's are damaged, and one has none; the others' page tells so.
    #[test]
    fn students_without_rows_or_with_damaged_ones_are_named() {
        let class = class();
        let inside = |name: &str| class.path().join(name);
        copy(&inside("bert b"), &inside("emil/out"));
        copy(&inside("anna"), &inside("dora"));
        fs::write(inside("dora/records.csv"), "nonsense\n1\n").unwrap();
        for name in ["frida", ".git", "references"] {
            fs::create_dir(inside(name)).unwrap();
        }
        let written = crate::write_told(&Lab::built_in(), class.path()).unwrap();
        let [emil, frida, dora] = &written.left_out[..] else { panic!("{:?}", written.left_out) };
        let deep = "; there is one in emil/out/an-experiment, which is too deep";
        assert!(emil.starts_with("emil is left out: neither ") && emil.ends_with(deep), "{emil}");
        assert!(frida.starts_with("frida is left out: neither ") && frida.ends_with(" a records.csv"), "{frida}");
        assert!(dora.starts_with("dora is left out: ") && dora.contains("records.csv"), "{dora}");
        let page = fs::read_to_string(written.path).unwrap();
        for name in ["emil", "frida", "dora"] {
            assert!(page.contains(&format!("{name} is left out: ")), "{name}");
        }
        assert!(page.contains("speedups of 2 folders") && page.contains("<h3>bert b: </h3>"), "{page}");
        // Of damaged students alone there is no page.
        fs::write(inside("anna/records.csv"), "nonsense\n1\n").unwrap();
        fs::remove_dir_all(inside("bert b")).unwrap();
        assert!(crate::write_told(&Lab::built_in(), class.path()).is_err());
    }

    /// Forty folders of forty machines, which differ in speed by up to forty times and whose pools are 1.1 to 5 times as fast
    /// as serial.
    #[test]
    fn forty_folders_make_one_page_of_ratios() {
        let class = tempfile::tempdir().unwrap();
        let out = class.path().join("autumn 2026");
        for student in 1..=40_u32 {
            let mut rows = rows(f64::from(student));
            for row in rows.iter_mut().filter(|row| row.threads == 2) {
                row.makespan_s = row.makespan_s.map(|seconds| 2.0 * seconds / (1.0 + 0.1 * f64::from(student)));
            }
            let own = folder_of(&["speedup"], "", rows);
            let folder = out.join(format!("student-{student:02}"));
            copy(&own.path().join("an-experiment"), &folder);
            let mut run = RunFile {
                experiment: "lab.toml".to_string(),
                started_utc: "2026-11-28T08:00:00Z".to_string(),
                ..RunFile::of_now("pathmark run lab.toml".to_string())
            };
            run.machine.cpu = format!("processor of student {student}");
            run.write(&folder.join(MACHINE)).unwrap();
        }
        let page = fs::read_to_string(crate::write(&Lab::built_in(), &out).unwrap()).unwrap();
        assert!(page.len() < 4_000_000, "{} bytes", page.len());
        // Figures of the students are files, to which the page links.
        assert!(page.matches("<svg").count() == 1 && page.contains("href=\"student-07/figures/speedup.svg\""));
        assert!(out.join("student-07/figures/speedup.svg").is_file());
        assert!(page.contains("<title>autumn 2026, speedups of 40 folders</title>"));
        assert!(
            page.contains("<h1>autumn 2026, speedups of 40 folders</h1><p class=\"facts\">2026-11-28, 40 machines")
        );
        assert_eq!(page.matches("<h3>student-").count(), 40);
        let seen = page.split_once("<main>").unwrap().1.split_once("<script>").unwrap().0;
        assert!(!seen.to_lowercase().contains("report a") && !seen.contains("reports"), "no word of the reports");
        let begin = seen.split_once("<h3>The class</h3>").unwrap().1.split_once("<h3>student-01").unwrap().0;
        let found = "40 folders, 40 kinds of machine. The highest speedup of a folder is between 1.10 and 5.00, with the median 3.05.";
        assert!(begin.contains(found), "{begin}");
        // A table of all folders is open where a class needs it: by schedule.
        let tables: Vec<&str> = begin.split("<details ").skip(1).collect();
        assert_eq!(tables.len(), 2, "{begin}");
        assert!(tables[0].starts_with("class=\"wide\" open>") && !tables[1].starts_with("class=\"wide\" open>"));
        let row = ["pool, 2 threads", "40", "3.05", "1.10", "student-01", "5.00", "student-40"];
        let cells = row.map(|cell| format!("<td>{cell}</td>")).concat();
        assert!(tables[0].contains(&cells), "{}", tables[0]);
        let rows = tables[1].split_once("<tbody>").unwrap().1.matches("<tr>").count();
        assert_eq!(rows, 40, "{}", tables[1]);
        assert!(tables[1].contains("processor of student 7") && !tables.concat().contains("seconds"));
    }

    #[test]
    fn a_folder_of_results_is_no_class() {
        let class = class();
        let students = |folder: &Path| {
            let found = members(folder).unwrap().into_iter().map(|member| (name_of(&member.folder), member.student));
            found.collect::<Vec<_>>()
        };
        let own = |name: &str| (name.to_string(), None);
        // Alone, under another name, as after `mv`.
        fs::rename(class.path().join("bert b"), class.path().join("baseline")).unwrap();
        assert_eq!(students(class.path()), [own("anna")]);
        assert_eq!(students(&class.path().join("baseline")), [own("an-experiment")]);
        // Beside an experiment of its own name, as in a folder of results with those of earlier versions.
        fs::rename(class.path().join("baseline"), class.path().join("earlier")).unwrap();
        fs::rename(class.path().join("earlier/an-experiment"), class.path().join("lab")).unwrap();
        assert_eq!(students(class.path()), [own("anna"), own("lab")]);
    }
}
