//! Speedup against `serial`, efficiency, and the serial fraction by Karp and Flatt, which explains the missing speedup.

use crate::analysis::scaling_law::{Check, Fit, Fitted, Law, fit};
use crate::analysis::speedup::{Evidence, Oddity, cause, efficiency, oddity, serial_fraction_within};
use crate::measure::TimingConcerns;
use crate::prelude::*;
use crate::schedule::is_of_ranks;
use crate::serial::Serial;
use crate::words::{hollow, with_interval};

/// A chart with more lines than this is unreadable, so strategies become named rows instead.
const MOST_LINES: usize = 8;

/// The mark of schedules that are not told apart from the fastest one.
const OPEN: &str = "≈";

/// The threads axis is linear up to this many threads.
const FEW_THREADS: f64 = 16.0;

/// The speedups and the data to explain them.
struct Speedups<'a> {
    results: &'a Results,
    /// The subtitle of all figures.
    workload: String,
    serial: Serial<'a>,
    all: Vec<(&'a Schedule, Ratio)>,
    /// The requested numbers of threads. A strategy with a thread for each job ignores them, so it has no position on
    /// the axis.
    asked: BTreeSet<usize>,
    processors: usize,
    /// The images of each schedule, without seeds. Schedules of other images are not ranked together.
    images: BTreeMap<&'a Schedule, BTreeSet<ImageKey>>,
    /// The images that most schedules rendered.
    usual: BTreeSet<ImageKey>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let serial = results.serial()?;
    let asked = results.rows().filter(|row| row.threads != row.jobs).map(|row| row.threads).collect();
    let all = serial.speedups();
    let images = |schedule: &Schedule| -> BTreeSet<ImageKey> {
        serial.rows(schedule).iter().map(|row| row.image.without_seed()).collect()
    };
    let images: BTreeMap<_, _> = all.iter().map(|(schedule, _)| (*schedule, images(schedule))).collect();
    let peers = gathered(images.iter().map(|(schedule, own)| (own, schedule))).into_iter();
    let usual = peers.max_by_key(|(_, schedules)| schedules.len()).map(|(own, _)| own.clone()).unwrap_or_default();
    let (processors, workload) = (results.run.machine.processors, results.workload());
    let found = Speedups { results, workload, serial, all, asked, processors, images, usual };
    let contest = found.contest()?;
    let mut blocks = found.figures(contest.as_ref());
    blocks.extend(contest.iter().flat_map(|contest| [contest.answer(), contest.finding(found.processors)]));
    blocks.extend(found.thread_per_row());
    blocks.push(found.table());
    blocks.extend(contest.as_ref().and_then(|contest| contest.table(found.processors)));
    Ok(blocks)
}

/// The fastest schedule of the usual image with a thread for each processor, and how many times as long others take.
struct Contest<'a> {
    best: &'a Schedule,
    speedup: Ratio,
    slower: Vec<(&'a Schedule, Ratio)>,
    /// Those that are not told apart from the best.
    open: Vec<(&'a Schedule, Ratio)>,
}

impl<'a> Contest<'a> {
    fn finding(&self, processors: usize) -> Block {
        let (slower, open) = (self.slower.len(), self.open.len());
        let others = match self.slowest() {
            Some((slowest, ratio)) => format!(
                " Paired with it, {slower} of {} others take longer, {} the longest: {} times as long. Not told apart from it by this run: {open}.",
                slower + open,
                slowest.name,
                with_interval(ratio.value, &ratio.interval, 3),
            ),
            None if open == 0 => String::new(),
            None if open == 1 => " The other schedule is not told apart from it by this run.".to_string(),
            None => format!(" None of {open} others is told apart from it by this run."),
        };
        Block::finding(format!(
            "With {processors} threads on {processors} processors the highest speedup is that of {}: {:.3} times serial, {}, an \
             efficiency of {:.3}.{others}",
            self.best.name,
            self.speedup.value,
            with_level(&self.speedup.interval, 3),
            self.speedup.value / processors as f64,
        ))
    }

    fn slowest(&self) -> Option<&(&Schedule, Ratio)> {
        self.slower.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value))
    }

    /// The result in a line.
    fn result(&self, processors: usize) -> Option<String> {
        let (best, ties) = (&self.best.name, self.open.len() + 1);
        let speedup = titles::told(self.speedup)?;
        let interval = self.speedup.interval;
        Some(match self.slowest() {
            Some((slowest, ratio)) => {
                let first = if ties == 1 {
                    format!("{best} is the fastest, {speedup} times serial")
                } else {
                    format!("{} schedules tie at {speedup} times serial", titles::spelled(ties))
                };
                format!("{first}; {} takes {}", slowest.name, titles::longer(ratio.value))
            }
            None if ties > 1 => {
                format!("This machine cannot tell {ties} schedules apart: {best} is {speedup} times as fast as serial")
            }
            None if interval.high < 1.0 => format!("{best} is slower than serial"),
            None if interval.low <= 1.0 => format!("This machine cannot tell {best} from serial"),
            None => format!("{best} is {speedup} times as fast as serial on {}", counted(processors, "processor")),
        })
    }

    /// The times of all schedules over the best one's; `None` without another one.
    fn table(&self, processors: usize) -> Option<Block> {
        let of = |list: &[(&'a Schedule, Ratio)], order: &'static str| {
            let mut list = list.to_vec();
            list.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
            list.into_iter().map(move |(schedule, ratio)| (schedule, Some(ratio), order))
        };
        let best = (self.best, None, "the highest speedup");
        let (open, slower) = (of(&self.open, "not told apart"), of(&self.slower, "slower"));
        let rows: Vec<(&Schedule, Option<Ratio>, &str)> = [best].into_iter().chain(open).chain(slower).collect();
        if rows.len() == 1 {
            return None;
        }
        let title = format!("Schedules with {processors} threads beside the one of the highest speedup");
        let table = Block::table("beside-the-fastest", title, rows)
            .column("strategy", |(schedule, ..)| schedule.name.clone())
            .column("pieces", |(schedule, ..)| schedule.key.decomposition.clone())
            .estimated(format!("time / time of {}", self.best.name), Decimals(3), |(_, ratio, _)| {
                ratio.map(Estimated::from)
            })
            .column("order", |(.., order)| (*order).to_string())
            .end();
        Some(table)
    }

    fn answer(&self) -> Block {
        let told = |ratio: &Ratio| with_interval(ratio.value, &ratio.interval, 2);
        let others = self.slower.len() + self.open.len();
        let ties = format!("{} is {} times as fast as serial", self.best.name, told(&self.speedup));
        let slowest = self.slowest();
        let text = match slowest {
            None if others == 0 => format!("{ties}."),
            None if others == 1 => format!("{ties}; the other schedule is not told apart from it."),
            None => format!("{ties}; none of {others} others is told apart from it."),
            Some((slowest, ratio)) => format!(
                "{ties}, and {} of {others} others tie with it. The slowest, {}, takes {} times as long.",
                self.open.len(),
                slowest.name,
                told(ratio),
            ),
        };
        let is_told = slowest.is_some() || (others == 0 && !self.speedup.interval.contains(1.0));
        Block::Answer { text, stem: "speedup", is_told }
    }

    fn is_open(&self, schedule: &Schedule) -> bool {
        std::iter::once(self.best).chain(self.open.iter().map(|(other, _)| *other)).any(|other| other == schedule)
    }
}

impl Speedups<'_> {
    /// Workers that can run at the same time.
    fn in_use(&self, threads: usize) -> usize {
        threads.min(self.processors)
    }

    fn has_a_thread_per_job(&self, schedule: &Schedule) -> bool {
        !self.asked.is_empty() && !self.asked.contains(&schedule.key.threads)
    }

    fn figures(&self, contest: Option<&Contest<'_>>) -> Vec<Block> {
        let per_processor = |speedup: f64, threads: usize| speedup / self.results.weight_in_use(threads);
        let strategies: BTreeSet<&str> = self.all.iter().map(|(schedule, _)| schedule.name.as_str()).collect();
        // Schedules with a thread for each job have no place on an axis of threads.
        let has_axis = !self.all.iter().all(|(schedule, _)| self.has_a_thread_per_job(schedule)) || self.all.is_empty();
        if strategies.len() <= MOST_LINES && has_axis {
            let (speedup, efficiency) = (self.speedup_chart(contest), self.efficiency_chart(&per_processor, contest));
            return vec![Block::figure("speedup", speedup), Block::figure("efficiency", efficiency)];
        }
        let speedups = |title: Title, is_usual: bool| {
            let plot = self.dots(title, "speedup against serial", &|speedup, _| speedup, is_usual, contest)?;
            let processors = (self.processors as f64, counted(self.processors, "processor"));
            Some(DotPlot { guides: vec![(1.0, "serial".to_string()), processors], ..plot })
        };
        let title = Title::new("Efficiency by strategy").with_result(self.efficiency_result(contest));
        let efficiency =
            self.dots(title, "speedup per processor in use", &per_processor, true, contest).map(|mut plot| {
                plot.guides = vec![(1.0, "ideal".to_string())];
                plot.caption += self.results.weights_in_words();
                plot
            });
        let plots = [
            ("speedup", speedups(self.speedup_title("Speedup by strategy", contest), true)),
            ("speedup-others", speedups("Speedup by strategy, other images".into(), false)),
            ("efficiency", efficiency),
        ];
        plots.into_iter().filter_map(|(stem, plot)| Some(Block::figure(stem, plot?))).collect()
    }

    fn speedup_title(&self, description: &str, contest: Option<&Contest<'_>>) -> Title {
        Title::new(description).with_result(contest.and_then(|contest| contest.result(self.processors)))
    }

    /// The share of the processors that the highest speedup uses, in a line.
    fn efficiency_result(&self, contest: Option<&Contest<'_>>) -> Option<String> {
        let Contest { best, speedup, .. } = contest?;
        let share = Estimated::from(*speedup).times(100.0 / self.results.weight_in_use(self.processors));
        let processors = counted(self.processors, "processor");
        Some(format!("{} turns {} % of {processors} into speedup", best.name, titles::told(share)?))
    }

    fn table(&self) -> Block {
        // Only a serial run on the same pieces differs from the schedule in nothing else.
        let fraction = |(schedule, speedup): &(&Schedule, Ratio), workers: usize| {
            let is_on_pieces = self.serial.pairs(schedule).iter().next().is_some();
            serial_fraction_within(&speedup.estimate(), workers).filter(|_| is_on_pieces).map(Estimated::from)
        };
        let work_inflation = self.serial.work_inflation();
        let used = |schedule: &Schedule| self.in_use(schedule.key.threads);
        let title = "Speedup against serial, efficiency and Karp-Flatt serial fraction";
        Block::table("karp-flatt", title, &self.all)
            .column("strategy", |(schedule, _)| schedule.name.clone())
            .column("pieces", |(schedule, _)| schedule.key.decomposition.clone())
            .column("threads", |(schedule, _)| schedule.key.threads.to_string())
            .estimated("speedup", Decimals(3), |(_, speedup)| Estimated::from(*speedup))
            .number("efficiency per thread", Decimals(3), |(s, speedup)| efficiency(speedup.value, s.key.threads))
            .number("efficiency per processor in use", Decimals(3), |(s, speedup)| {
                Some(speedup.value / self.results.weight_in_use(s.key.threads)).filter(|value| value.is_finite())
            })
            .number("work inflation", Decimals(3), |(schedule, _)| work_inflation.get(schedule).copied())
            .estimated("e, p = threads", Decimals(3), |own| fraction(own, own.0.key.threads))
            .estimated("e, p = processors in use", Decimals(3), |own| fraction(own, used(own.0)))
            .column("remark", |(schedule, speedup)| self.remark(schedule, speedup))
            .end()
    }

    fn remark(&self, schedule: &Schedule, speedup: &Ratio) -> String {
        let partial = if speedup.is_partial { "fewer repetitions than others: not comparable" } else { "" };
        joined([self.oddity(schedule, speedup), partial.to_string()])
    }

    fn oddity(&self, schedule: &Schedule, speedup: &Ratio) -> String {
        let threads = schedule.key.threads;
        match oddity(&speedup.interval, self.in_use(threads)) {
            Some(Oddity::Superlinear) => format!("superlinear; {}", cause(&self.evidence(schedule))),
            Some(Oddity::Slowdown) if threads > 1 => "slower than serial".to_string(),
            _ if threads == 1 => "relative speedup: the strategy's own cost at one worker".to_string(),
            _ => String::new(),
        }
    }

    /// The evidence for the cause of a superlinear speedup.
    fn evidence(&self, schedule: &Schedule) -> Evidence {
        let mut alone = schedule.clone();
        alone.key.threads = 1;
        let at_one_worker =
            || self.serial.pairs(&alone).gains(|row| row.makespan_s).median(self.results.stopping())?.interval;
        // The baseline's doubts count as well: a serial run that was delayed makes all others look fast.
        let pairs = self.serial.pairs(schedule);
        let baselines = pairs.iter().map(|(_, serial)| serial);
        let concerned = self.serial.rows(schedule).iter().copied().chain(baselines);
        let machine = &self.results.run.machine;
        Evidence {
            at_one_worker: (schedule.key.threads > 1).then(at_one_worker).flatten(),
            warnings: concerned.filter(|row| TimingConcerns::concern(&row.warnings)).count(),
            processors: Some(machine.processors),
            physical_cores: Some(machine.physical_cores).filter(|cores| *cores > 0),
        }
    }

    /// The sentences of a caption about bars and hollow marks.
    fn bars(&self) -> String {
        bars(self.all.iter().map(|(_, speedup)| *speedup))
    }

    fn is_usual(&self, schedule: &Schedule) -> bool {
        self.images.get(schedule) == Some(&self.usual)
    }

    /// A row for each strategy with a dot for each number of threads, of the usual image or of the others; `None` without
    /// one. A strategy with a thread for each job has one dot.
    fn dots(
        &self,
        title: Title,
        axis: &str,
        value: &dyn Fn(f64, usize) -> f64,
        is_usual: bool,
        contest: Option<&Contest<'_>>,
    ) -> Option<DotPlot> {
        let own: Vec<&(&Schedule, Ratio)> =
            self.all.iter().filter(|(schedule, _)| self.is_usual(schedule) == is_usual).collect();
        let threads: BTreeSet<usize> =
            own.iter().filter(|(s, _)| !self.has_a_thread_per_job(s)).map(|(s, _)| s.key.threads).collect();
        let is_open = |schedule: &Schedule| contest.is_some_and(|contest| contest.is_open(schedule));
        let open: BTreeSet<String> = own
            .iter()
            .filter(|(schedule, _)| is_open(schedule))
            .map(|(schedule, _)| self.serial.line(schedule))
            .collect();
        let mut rows: BTreeMap<String, Vec<Option<_>>> = BTreeMap::new();
        for (schedule, speedup) in &own {
            let dots = rows.entry(self.serial.line(schedule)).or_insert_with(|| vec![None; threads.len() + 1]);
            let place = threads.iter().position(|threads| *threads == schedule.key.threads).unwrap_or(threads.len());
            dots[place] = Some(Estimated::from(*speedup).times(value(1.0, schedule.key.threads)));
        }
        if rows.is_empty() {
            return None;
        }
        // Sorted by the value at the most threads, because readers look for it first. Partial values are not ranked.
        let at_most = |dots: &[Option<Estimated>]| {
            let mut all = dots.iter().flatten();
            let ranked = all.clone().rfind(|told| !told.is_partial);
            ranked.or_else(|| all.next_back()).map(|told| (told.is_partial, -told.value)).unwrap_or_default()
        };
        let mut rows: Vec<_> = rows.into_iter().collect();
        rows.sort_by(|(_, first), (_, second)| {
            let ((first_partial, first), (second_partial, second)) = (at_most(first), at_most(second));
            first_partial.cmp(&second_partial).then(first.total_cmp(&second))
        });
        let dots = |dots: Vec<Option<Estimated>>| dots.into_iter().map(|told| Some(told?.dot())).collect();
        let marked = |name: String| if open.contains(&name) { format!("{OPEN} {name}") } else { name };
        let rows: Vec<DotRow> = rows.into_iter().map(|(name, own)| DotRow::new(marked(name), dots(own))).collect();
        let workers = if self.all.iter().any(|(schedule, _)| is_of_ranks(&schedule.name)) {
            ["worker", "workers"]
        } else {
            ["thread", "threads"]
        };
        let name = |threads: &usize| format!("{threads} {}", workers[usize::from(*threads != 1)]);
        let mut names: Vec<String> = threads.iter().map(name).collect();
        if rows.iter().any(|row| row.dots[threads.len()].is_some()) {
            names.push("a thread per job".to_string());
        }
        // Speedups of one number of threads are read without those of the others.
        let mut plot = DotPlot::new(title, Axis::linear(axis), rows).in_areas(names);
        plot.axis = plot.axis.including(Some(0.9).filter(|_| !plot.side_by_side));
        let rows = own.iter().flat_map(|(schedule, _)| self.serial.rows(schedule).iter().copied());
        plot.subtitle = self.results.workload_of(&rows.collect::<Vec<&Row>>());
        plot.caption = ratio_bars(own.iter().map(|(_, speedup)| *speedup));
        if !open.is_empty() {
            let processors = self.processors;
            let mark = format!(" {OPEN}: with {processors} threads not told apart from the fastest by this run.");
            plot.caption.push_str(&mark);
        }
        Some(plot)
    }

    /// A series for each strategy, except those with a thread for each job.
    fn series(&self, value: &dyn Fn(f64, usize) -> f64) -> Vec<Series> {
        let mut lines: BTreeMap<String, Vec<_>> = BTreeMap::new();
        for (schedule, speedup) in self.all.iter().filter(|(schedule, _)| !self.has_a_thread_per_job(schedule)) {
            let threads = schedule.key.threads;
            let point = Estimated::from(*speedup).times(value(1.0, threads)).above(threads as f64);
            lines.entry(self.serial.line(schedule)).or_default().push(point);
        }
        Series::by_name(lines)
    }

    fn chart(&self, title: Title, y: Axis, series: Vec<Series>, caption: &str) -> LineChart {
        let ticks: Vec<f64> = series.iter().flat_map(|series| &series.points).map(|point| point.x).collect();
        // On linear axes, a speedup in proportion to the threads is a straight line. Many threads do not fit on them.
        let few = ticks.iter().all(|threads| *threads <= FEW_THREADS);
        let x = if few { Axis::linear("threads") } else { Axis::log("threads") }.ticks_at(ticks);
        let mut chart = LineChart::new(title, x, y, series);
        chart.subtitle.clone_from(&self.workload);
        chart.caption = caption.to_string();
        chart.dodge = 5.0;
        chart
    }

    fn speedup_chart(&self, contest: Option<&Contest<'_>>) -> LineChart {
        let processors = self.processors as f64;
        let y = Axis::linear("speedup against serial").including([0.0, processors.max(1.0) * 1.25]);
        let has_level = self.all.iter().any(|(schedule, _)| self.has_a_thread_per_job(schedule));
        let level = if has_level { " Level: a thread for each job, whatever is asked for." } else { "" };
        let (bars, hollow) = (self.bars(), hollow(self.all.iter().map(|(_, speedup)| Estimated::from(*speedup))));
        let bars = bars.trim_end_matches(hollow);
        let caption = &format!("Ratios within a repetition. {bars}{level}{hollow}");
        let title = self.speedup_title("Speedup against threads", contest);
        let mut chart = self.chart(title, y, self.series(&|speedup, _| speedup), caption);
        let ticks: BTreeSet<usize> =
            chart.series.iter().flat_map(|series| &series.points).map(|point| point.x as usize).collect();
        for (schedule, speedup) in self.all.iter().filter(|(schedule, _)| self.has_a_thread_per_job(schedule)) {
            let points = ticks.iter().map(|threads| Estimated::from(*speedup).above(*threads as f64)).collect();
            let name = format!("{}: always {}", schedule.name, schedule.key.threads);
            chart.series.push(Series::new(name, crate::plot::style::Look::nth(chart.series.len()), points));
        }
        chart.overlays = vec![
            Overlay::guide(format!("{processors} processors"), Curve::Line { intercept: processors, slope: 0.0 }),
            Overlay::guide("ideal: one per thread", Curve::Line { intercept: 0.0, slope: 1.0 }),
        ];
        chart.overlays.extend(self.fits(&chart.series));
        chart
    }

    /// Amdahl's law where the fit passes its check, in the colours of the strategies' lines.
    fn fits(&self, series: &[Series]) -> Vec<Overlay> {
        let overlay = |(name, points): (String, Vec<_>)| {
            let Fit::Found(Fitted { parameters, check: Check::Passed { .. }, .. }) = fit(Law::Amdahl, &points, LEVEL)
            else {
                return None;
            };
            let serial_share = parameters.first()?.estimate.value;
            let line = series.iter().position(|series| series.name == name)?;
            Some(Overlay::fit(format!("{name}: Amdahl, s = {serial_share:.3}"), Curve::Amdahl { serial_share }, line))
        };
        self.serial.lines(self.processors).into_iter().filter_map(overlay).collect()
    }

    fn efficiency_chart(&self, per_processor: &dyn Fn(f64, usize) -> f64, contest: Option<&Contest<'_>>) -> LineChart {
        let y = Axis::linear("speedup per processor in use").including([0.5, 1.05]);
        let weights = self.results.weights_in_words();
        let caption = &format!("Processors in use: the smaller of threads and processors.{weights} {}", self.bars());
        let title = Title::new("Efficiency against threads").with_result(self.efficiency_result(contest));
        let mut chart = self.chart(title, y, self.series(per_processor), caption);
        chart.overlays = vec![Overlay::guide("ideal: 1", Curve::Line { intercept: 1.0, slope: 0.0 })];
        chart
    }

    fn contest(&self) -> Result<Option<Contest<'_>>> {
        let processors = self.processors;
        let is_candidate = |schedule: &Schedule| schedule.key.threads == processors && self.is_usual(schedule);
        let candidates = || self.all.iter().filter(|(schedule, _)| processors > 1 && is_candidate(schedule));
        let whole = candidates().filter(|(_, speedup)| !speedup.is_partial);
        let Some(&(best, speedup)) = whole.max_by(|a, b| a.1.value.total_cmp(&b.1.value)) else { return Ok(None) };
        let mut contest = Contest { best, speedup, slower: Vec::new(), open: Vec::new() };
        for &(other, _) in candidates().filter(|(other, _)| *other != best) {
            let rows = |schedule: &Schedule| self.serial.rows(schedule).iter().copied();
            if let Some(ratio) = time_ratio(rows(other), rows(best), any_schedule, self.results.stopping())? {
                let list = if ratio.interval.low > 1.0 { &mut contest.slower } else { &mut contest.open };
                list.push((other, ratio));
            }
        }
        Ok(Some(contest))
    }

    fn thread_per_row(&self) -> Option<Block> {
        let (schedule, speedup) = self.all.iter().find(|(schedule, _)| schedule.is_thread_per_row())?;
        let rows = schedule.key.threads;
        let verdict = if speedup.interval.high < rows as f64 { "is refuted" } else { "is not refuted" };
        Some(Block::finding(format!(
            "A thread for each of {rows} rows is {:.3} times as fast as serial, {}. That a thread per row divides the time by the number of \
             rows {verdict} by this run.",
            speedup.value,
            with_level(&speedup.interval, 3),
        )))
    }
}
