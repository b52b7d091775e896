//! Resource usage of this process: CPU time and context switches (getrusage), peak memory and the load of other programs
//! (/proc). Facts that the system does not report are missing, and the row says which (`unmeasured`).

use super::available_threads;
use nix::sys::resource::{Usage as Counted, UsageWho, getrusage};
use nix::sys::time::TimeValLike;
use std::fmt;
use std::time::Instant;

/// Totals since the process started, over all its threads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Usage {
    pub(super) user_s: f64,
    pub(super) system_s: f64,
    pub(super) voluntary_switches: i64,
    pub(super) involuntary_switches: i64,
    pub(super) peak_rss_bytes: Option<i64>,
    /// CPU seconds of other programs on this machine.
    pub(super) foreign_s: Option<f64>,
    /// CPU seconds that a virtual machine's host gave to others while this machine had work for them (steal time).
    pub(super) steal_s: Option<f64>,
}

struct ProcessorTime {
    busy_s: f64,
    steal_s: f64,
}

/// The machine's processor time from the text of /proc/stat (proc(5): user, nice, system, idle, iowait, irq, softirq,
/// steal; user already includes guests). The kernel reports hundredths of a second to programs, whatever its own tick
/// is.
fn processor_time(stat: &str) -> Option<ProcessorTime> {
    let fields = stat.lines().next()?.split_whitespace().skip(1);
    let ticks: Vec<f64> = fields.filter_map(|field| field.parse().ok()).collect();
    let [user, nice, system, _, _, irq, softirq, steal, ..] = ticks[..] else { return None };
    Some(ProcessorTime { busy_s: (user + nice + system + irq + softirq) * 1e-2, steal_s: steal * 1e-2 })
}

/// Peak memory of this program. On Linux getrusage's figure is not used: it survives exec and so includes the parent's.
/// Apple's systems have no /proc, and their figure is in bytes.
fn peak_rss_bytes(counted: &Counted) -> Option<i64> {
    if cfg!(target_vendor = "apple") {
        return Some(counted.max_rss());
    }
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<i64>().ok()? * 1024)
}

/// CPU seconds of this process so far. It reads nothing else, so that gaps of microseconds are not filled with reading.
pub(super) fn cpu_s() -> Option<f64> {
    let counted = getrusage(UsageWho::RUSAGE_SELF).ok()?;
    Some((counted.user_time().num_microseconds() + counted.system_time().num_microseconds()) as f64 * 1e-6)
}

/// CPU seconds of the processes that this one started, as far as it has waited for their end.
fn children_s() -> f64 {
    let counted = getrusage(UsageWho::RUSAGE_CHILDREN);
    let seconds = |counted: Counted| counted.user_time().num_microseconds() + counted.system_time().num_microseconds();
    counted.map_or(0.0, |counted| seconds(counted) as f64 * 1e-6)
}

impl Usage {
    /// Reads the totals; `None` if the system does not report them.
    pub(super) fn now() -> Option<Self> {
        let counted: Counted = getrusage(UsageWho::RUSAGE_SELF).ok()?;
        let user_s = counted.user_time().num_microseconds() as f64 * 1e-6;
        let system_s = counted.system_time().num_microseconds() as f64 * 1e-6;
        let machine = std::fs::read_to_string("/proc/stat").ok().and_then(|text| processor_time(&text));
        Some(Self {
            user_s,
            system_s,
            foreign_s: machine.as_ref().map(|machine| machine.busy_s - user_s - system_s),
            steal_s: machine.map(|machine| machine.steal_s),
            voluntary_switches: counted.voluntary_context_switches(),
            involuntary_switches: counted.involuntary_context_switches(),
            peak_rss_bytes: peak_rss_bytes(&counted),
        })
    }

    /// The facts that the system did not report.
    pub(super) fn missing(usage: Option<&Self>) -> Vec<&'static str> {
        let facts = [
            ("processor time", usage.is_some()),
            ("load of other programs", usage.is_some_and(|usage| usage.foreign_s.is_some())),
            ("peak memory", usage.is_some_and(|usage| usage.peak_rss_bytes.is_some())),
        ];
        facts.into_iter().filter(|(_, is_there)| !is_there).map(|(fact, _)| fact).collect()
    }

    /// The sum of two periods; the peak is the larger one.
    pub(super) fn plus(&self, later: &Self) -> Self {
        Self {
            user_s: self.user_s + later.user_s,
            system_s: self.system_s + later.system_s,
            voluntary_switches: self.voluntary_switches + later.voluntary_switches,
            involuntary_switches: self.involuntary_switches + later.involuntary_switches,
            peak_rss_bytes: self.peak_rss_bytes.max(later.peak_rss_bytes),
            foreign_s: self.foreign_s.zip(later.foreign_s).map(|(a, b)| a + b),
            steal_s: self.steal_s.zip(later.steal_s).map(|(a, b)| a + b),
        }
    }

    /// The increase since `before`; peak memory is a total.
    pub(super) fn since(&self, before: &Self) -> Self {
        Self {
            user_s: self.user_s - before.user_s,
            system_s: self.system_s - before.system_s,
            voluntary_switches: self.voluntary_switches - before.voluntary_switches,
            involuntary_switches: self.involuntary_switches - before.involuntary_switches,
            peak_rss_bytes: self.peak_rss_bytes,
            foreign_s: self.foreign_s.zip(before.foreign_s).map(|(after, before)| (after - before).max(0.0)),
            steal_s: self.steal_s.zip(before.steal_s).map(|(after, before)| (after - before).max(0.0)),
        }
    }
}

/// Above this share of the processors' time, others count as a disturbance of the measurement.
pub(super) const FOREIGN_SHARE: f64 = 0.05;

#[derive(Debug, Clone, Copy)]
pub struct ForeignLoad {
    begun: Instant,
    before: Option<Usage>,
    children_s: f64,
}

/// The shares of the processors' time that others took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForeignShares {
    pub programs: f64,
    /// The share that the host of a virtual machine gave to others while this machine had work.
    pub host: f64,
    pub seconds: f64,
}

impl ForeignLoad {
    pub fn begin() -> Self {
        Self { begun: Instant::now(), before: Usage::now(), children_s: children_s() }
    }

    /// The shares since; `None` if the system does not report them.
    pub fn shares(&self) -> Option<ForeignShares> {
        let seconds = self.begun.elapsed().as_secs_f64();
        let taken = Usage::now()?.since(&self.before?);
        let capacity_s = seconds * available_threads() as f64;
        // Processes that this one started and waited for are no others.
        let programs = (taken.foreign_s? - (children_s() - self.children_s)).max(0.0) / capacity_s;
        Some(ForeignShares { programs, host: taken.steal_s? / capacity_s, seconds })
    }

    /// A warning, if others took so much that they disturbed the measurement.
    pub fn warning(&self) -> Option<String> {
        let shares = self.shares().filter(|shares| shares.programs.max(shares.host) > FOREIGN_SHARE)?;
        Some(format!("warning: {shares}"))
    }
}

impl fmt::Display for ForeignShares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [programs, host] = [self.programs, self.host].map(|share| 100.0 * share);
        let digits = usize::from(self.seconds < 10.0);
        write!(f, "other programs took {programs:.1} % of the processors in these {:.digits$} s", self.seconds)?;
        if host < 0.05 { Ok(()) } else { write!(f, ", and the host of this virtual machine {host:.1} %") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steal_is_apart_from_the_time_of_programs() {
        let time = processor_time("cpu  100 20 30 400 50 6 7 89 0 0\ncpu0 1 2 3\n").unwrap();
        assert!((time.busy_s - 1.63).abs() < 1e-12 && (time.steal_s - 0.89).abs() < 1e-12);
        assert!(processor_time("cpu 1 2 3").is_none() && processor_time("").is_none());
    }

    /// Where the system reports everything, a fact is missing only if it was taken away.
    #[test]
    fn missing_facts_are_named() {
        let all = Usage {
            user_s: 1.0,
            system_s: 0.0,
            voluntary_switches: 0,
            involuntary_switches: 0,
            peak_rss_bytes: Some(1),
            foreign_s: Some(0.0),
            steal_s: Some(0.0),
        };
        assert!(Usage::missing(Some(&all)).is_empty());
        let without_load = Usage { foreign_s: None, ..all };
        assert_eq!(Usage::missing(Some(&without_load)), ["load of other programs"]);
        let without_peak = Usage { peak_rss_bytes: None, ..without_load };
        assert_eq!(Usage::missing(Some(&without_peak)), ["load of other programs", "peak memory"]);
        assert_eq!(Usage::missing(None), ["processor time", "load of other programs", "peak memory"]);
    }

    /// The load itself is unknown; the test only checks that it is a share.
    #[test]
    fn foreign_load_is_a_share() {
        let load = ForeignLoad::begin();
        while load.begun.elapsed().as_secs_f64() < 0.05 {
            std::hint::spin_loop();
        }
        if let Some(shares) = load.shares() {
            assert!(shares.programs >= 0.0 && shares.host >= 0.0 && shares.seconds >= 0.05, "{shares:?}");
        }
    }

    /// The load of others is unknown, but it cannot contain the time of a child that has ended. The load with the child is
    /// read last, because others may go on meanwhile.
    #[test]
    fn children_are_no_other_programs() {
        let (load, own_s) = (ForeignLoad::begin(), children_s());
        let busy = "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done";
        for _ in 0..200 {
            assert!(std::process::Command::new("sh").args(["-c", busy]).status().unwrap().success());
            if children_s() - own_s >= 0.3 {
                break;
            }
        }
        let (child_s, shares) = (children_s() - own_s, load.shares());
        assert!(child_s >= 0.3, "{child_s}");
        let with_child = load.before.zip(Usage::now()).and_then(|(before, now)| now.since(&before).foreign_s);
        let Some((shares, with_child_s)) = shares.zip(with_child) else { return };
        let others_s = shares.programs * shares.seconds * available_threads() as f64;
        assert!(
            others_s <= (with_child_s - 0.5 * child_s).max(0.0) + 0.05,
            "{others_s} s, {with_child_s} s with the child"
        );
    }

    #[test]
    fn the_host_is_told_apart_from_programs() {
        let shares = ForeignShares { programs: 0.031, host: 0.12, seconds: 4.2 };
        let told = "other programs took 3.1 % of the processors in these 4.2 s";
        assert_eq!(shares.to_string(), format!("{told}, and the host of this virtual machine 12.0 %"));
        assert_eq!(ForeignShares { host: 0.0, ..shares }.to_string(), told);
    }
}
