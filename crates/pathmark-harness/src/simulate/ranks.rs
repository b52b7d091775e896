//! Replays of ranks: processes share jobs of known costs by a rule, and the threads of each share its jobs by a
//! strategy.
//!
//! Each chunk of a rank is replayed as a separate run ([`Contender::replay`]). As in `crate::cluster`, the threads of a
//! rank therefore wait for the last of them before the next chunk. Messages cost the times measured between two
//! processes ([`Messages`]). Waiting takes no processor here, so each thread of each rank must have one.

use super::contender::Contender;
use super::hardware::Hardware;
use crate::lab::{Distribution, LOOK, Master, is_small};
use crate::strategy::{ChunkRule, LearnedRule, Ledger, Seen};
use serde::Serialize;
use std::ops::Range;

/// The costs of messages that bring jobs to ranks and pieces back, in seconds. The default costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Messages {
    /// A request to rank 0 and its answer, while rank 0 waits for it.
    pub request_s: f64,
    /// A fetch-and-op in the memory of rank 0, while rank 0 waits.
    pub fetch_s: f64,
    /// How far a fetch depends on rank 0: 1 if it waits until rank 0 looks after MPI, 0 if it does not.
    pub needs_rank_0: f64,
    pub gathered_byte_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Crew {
    pub ranks: usize,
    pub threads: usize,
}

pub struct Cluster<'a> {
    pub crew: Crew,
    pub within: &'a Contender,
    pub messages: Messages,
    /// The processors of each rank. One slow core stands for a slow rank 0.
    pub hardware: Hardware,
}

#[derive(Debug, Clone, Copy)]
struct Rank {
    /// When it asks for its next chunk, and the earliest time at which it can begin that chunk.
    asks_s: f64,
    free_s: f64,
    seen: Seen,
}

impl Cluster<'_> {
    pub fn makespan_s(&self, costs: &[f64], distribution: Distribution) -> f64 {
        let ranks = self.crew.ranks;
        match distribution {
            Distribution::Static(deal) => {
                let jobs = |rank| deal(rank, ranks, costs.len()).map(|job| costs[job]).collect::<Vec<f64>>();
                (0..ranks).map(|rank| self.chunk(rank, &jobs(rank)).0).fold(0.0, f64::max)
            }
            Distribution::SharedCounter(rule) => self.counted(costs, rule),
            Distribution::Master(Master::Only, rule) => self.with_a_master(costs, rule),
            Distribution::Master(Master::Working, rule) => self.with_a_working_master(costs, rule),
            Distribution::Adaptive(rule) => self.told(costs, rule),
        }
    }

    /// Seconds to gather a film of so many bytes, of which each rank holds an equal share.
    pub fn gather_s(&self, bytes: f64) -> f64 {
        let ranks = self.crew.ranks as f64;
        bytes * (ranks - 1.0) / ranks * self.messages.gathered_byte_s
    }

    /// The seconds that a rank takes for jobs of these costs, and the job durations that it observes.
    fn chunk(&self, rank: usize, costs: &[f64]) -> (f64, Seen) {
        let (speed, hardware) = match self.hardware {
            Hardware::OneSlow(_) => (self.hardware.speed(rank), Hardware::Identical),
            _ => (1.0, self.hardware),
        };
        if costs.is_empty() {
            return (0.0, Seen::default());
        }
        let replayed = self.within.replay(costs, self.crew.threads, &hardware);
        let seconds = replayed.makespan_s / speed;
        let durations = || replayed.trace.jobs.iter().map(crate::measure::JobSpan::duration_s);
        let busy_s: f64 = durations().sum();
        let seen =
            if busy_s > 0.0 { durations().map(|job_s| job_s * seconds / busy_s).collect() } else { Seen::default() };
        (seconds, seen)
    }

    fn ranks(&self) -> Vec<Option<Rank>> {
        vec![Some(Rank { asks_s: 0.0, free_s: 0.0, seen: Seen::default() }); self.crew.ranks]
    }

    /// A rank asks while it renders a small chunk, and otherwise when it has none; chunks are numbered in the order of
    /// the requests. Rank 0 looks after requests after each of its chunks and every [`LOOK`]; a request waits half of
    /// the time between two looks on average.
    fn counted(&self, costs: &[f64], rule: ChunkRule) -> f64 {
        let Messages { fetch_s, needs_rank_0, .. } = self.messages;
        let mut chunks = rule.chunks(costs.len(), self.crew.ranks);
        let (mut ranks, mut last_s, mut look_s) = (self.ranks(), 0.0_f64, LOOK.as_secs_f64());
        while let Some((number, rank)) = first(&ranks) {
            let waits_s = if number == 0 { 0.0 } else { fetch_s + needs_rank_0 * look_s / 2.0 };
            let answered_s = rank.asks_s + waits_s;
            let begin_s = rank.free_s.max(answered_s);
            ranks[number] = chunks.next().map(|chunk| {
                let asks_early = number > 0 && is_small(chunk.len(), costs.len(), self.crew.ranks);
                let seconds = self.chunk(number, &costs[chunk]).0;
                if number == 0 {
                    look_s = LOOK.as_secs_f64().min(seconds);
                }
                let free_s = begin_s + seconds;
                Rank { asks_s: if asks_early { begin_s } else { free_s }, free_s, seen: rank.seen }
            });
            last_s = last_s.max(ranks[number].map_or(begin_s, |rank| rank.free_s));
        }
        last_s
    }

    /// Rank 0 answers one request after the other; each answer occupies it for half of the request's round trip.
    fn with_a_master(&self, costs: &[f64], rule: ChunkRule) -> f64 {
        let mut chunks = rule.chunks(costs.len(), self.crew.ranks.saturating_sub(1).max(1));
        let (mut ranks, mut master_free_s, mut last_s) = (self.ranks(), 0.0_f64, 0.0_f64);
        ranks[0] = None;
        while let Some((number, rank)) = first(&ranks) {
            let begin_s = rank.asks_s.max(master_free_s);
            master_free_s = begin_s + self.messages.request_s / 2.0;
            let answered_s = begin_s + self.messages.request_s;
            ranks[number] = chunks.next().map(|chunk| self.with_chunk(number, &costs[chunk], answered_s));
            last_s = last_s.max(ranks[number].map_or(answered_s, |rank| rank.free_s));
        }
        last_s
    }

    fn with_a_working_master(&self, costs: &[f64], rule: ChunkRule) -> f64 {
        let mut chunks = rule.chunks(costs.len(), self.crew.ranks);
        let (mut ranks, mut now_s, mut last_s) = (self.ranks(), 0.0_f64, 0.0_f64);
        ranks[0] = None;
        let mut is_working = true;
        while is_working || ranks.iter().any(Option::is_some) {
            if let Some((number, rank)) = first(&ranks).filter(|(_, rank)| rank.asks_s <= now_s || !is_working) {
                now_s = now_s.max(rank.asks_s) + self.messages.request_s / 2.0;
                let answered_s = now_s + self.messages.request_s / 2.0;
                ranks[number] = chunks.next().map(|chunk| self.with_chunk(number, &costs[chunk], answered_s));
                last_s = last_s.max(ranks[number].map_or(answered_s, |rank| rank.free_s));
            } else if let Some(chunk) = chunks.next() {
                now_s += self.chunk(0, &costs[chunk]).0;
                last_s = last_s.max(now_s);
            } else {
                is_working = false;
            }
        }
        last_s
    }

    /// Rank 0 looks after requests while it renders; a request waits half of the time between two looks on average.
    fn told(&self, costs: &[f64], rule: LearnedRule) -> f64 {
        let mut ledger = Ledger::new(costs.len(), self.crew.ranks, rule.weights);
        let (mut ranks, mut last_s) = (self.ranks(), 0.0_f64);
        while let Some((number, rank)) = first(&ranks) {
            ledger.note(number, rank.seen);
            let waits_s = if number == 0 { 0.0 } else { self.messages.request_s + LOOK.as_secs_f64() / 2.0 };
            let answered_s = rank.asks_s + waits_s;
            let chunk: Option<Range<usize>> = rule.next(&mut ledger, number);
            ranks[number] = chunk.map(|chunk| self.with_chunk(number, &costs[chunk], answered_s));
            last_s = last_s.max(ranks[number].map_or(answered_s, |rank| rank.free_s));
        }
        last_s
    }

    /// Returns the state of a rank that begins a chunk at `begin_s` and asks again at its end.
    fn with_chunk(&self, rank: usize, costs: &[f64], begin_s: f64) -> Rank {
        let (seconds, seen) = self.chunk(rank, costs);
        Rank { asks_s: begin_s + seconds, free_s: begin_s + seconds, seen }
    }
}

/// The rank that asks first; of several, the one with the lowest number.
fn first(ranks: &[Option<Rank>]) -> Option<(usize, Rank)> {
    let asking = ranks.iter().enumerate().filter_map(|(number, rank)| Some((number, (*rank)?)));
    asking.min_by(|(_, a), (_, b)| a.asks_s.total_cmp(&b.asks_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Lab;
    use crate::simulate::{Order, Overheads};
    use crate::strategy::Discipline;

    fn within(name: &str) -> Contender {
        let discipline = crate::strategy::find(name).unwrap().discipline;
        let (name, overheads) = (name.to_owned(), Overheads::default());
        Contender { name, discipline, order: Order::ByIndex, overheads, calibrations: Vec::new() }
    }

    fn makespan_s(rule: &str, ranks: usize, threads: usize, messages: Messages, costs: &[f64]) -> f64 {
        let strategy = within(if threads == 1 { "serial" } else { "shared-counter" });
        let crew = Crew { ranks, threads };
        let distribution = Lab::new().rank_rule("ranks", rule).unwrap().distribution();
        let hardware = Hardware::default();
        Cluster { crew, within: &strategy, messages, hardware }.makespan_s(costs, distribution)
    }

    /// If messages cost nothing, ranks of one thread behave as the threads of one process in the simulator for threads.
    #[test]
    fn ranks_of_one_thread_are_threads() {
        let costs: Vec<f64> = (0..200).map(|job| 1.0 + f64::from(job * 37 % 101)).collect();
        for rule in ["static-blocks", "static-cyclic", "guided", "factoring", "trapezoid", "awf-b", "awf-c"] {
            for ranks in [1, 2, 3, 8] {
                let threads = within(rule).replay(&costs, ranks, &Hardware::default()).makespan_s;
                let found = makespan_s(rule, ranks, 1, Messages::default(), &costs);
                // Rank 0 does not wait; each other rank waits for half a look.
                let waits = if rule.starts_with("awf") { 1.0 } else { 1e-9 };
                // A rank that asks early may get a chunk that would have gone to another rank.
                let tolerance = if ranks > 1 { waits + 102.0 } else { waits };
                assert!((found - threads).abs() <= tolerance, "{rule}, {ranks} ranks: {found} and {threads}");
                assert!(found >= costs.iter().sum::<f64>() / ranks as f64 - 1e-9, "{rule}");
            }
        }
        // Without early requests the makespans are equal.
        for rule in ["guided", "dynamic:50"] {
            let chunky = |ranks| makespan_s(rule, ranks, 1, Messages::default(), &costs[..20]);
            let (name, parameter) = rule.split_once(':').map_or((rule, None), |(name, size)| (name, Some(size)));
            let discipline = crate::strategy::find(name).unwrap().discipline(parameter).unwrap();
            let alone = Contender { discipline, ..within("guided") };
            assert_eq!(chunky(3), alone.replay(&costs[..20], 3, &Hardware::default()).makespan_s, "{rule}");
        }
    }

    #[test]
    fn messages_by_hand() {
        let costs = [1.0; 8];
        let messages = Messages { request_s: 0.5, fetch_s: 0.25, needs_rank_0: 0.0, gathered_byte_s: 1e-3 };
        // Chunks of four jobs: rank 0 has the first at once, rank 1 the second after 0.25 s. After 0.25 s more it
        // learns that none is left.
        assert_eq!(makespan_s("dynamic:4", 2, 1, messages, &costs), 4.5);
        // Rank 1 learns that none is left long before rank 0 has done all.
        assert_eq!(makespan_s("dynamic:8", 2, 1, messages, &costs), 8.0);
        // If the library needs rank 0, which looks every millisecond, each request takes half a millisecond longer.
        let needy = Messages { needs_rank_0: 1.0, ..messages };
        let found = makespan_s("dynamic:4", 2, 1, needy, &costs);
        assert!((found - 4.5 - LOOK.as_secs_f64()).abs() < 1e-9, "{found}");
        // A master and two workers: each waits for an answer, the second for 0.25 s longer, and for one more answer at
        // the end.
        assert_eq!(makespan_s("master-worker:4", 3, 1, messages, &costs), 0.25 + 0.5 + 4.0 + 0.5);
        // The master answers first, for 0.25 s, and then runs its own four; rank 1 waits until then to learn that none
        // is left.
        assert_eq!(makespan_s("working-master:4", 2, 1, messages, &costs), 0.5 + 4.0 + 0.5);
        // The two threads of each rank share its jobs and halve its time.
        assert_eq!(makespan_s("static-blocks", 2, 2, messages, &costs), 2.0);
        let strategy = within("serial");
        let crew = Crew { ranks: 4, threads: 1 };
        let cluster = Cluster { crew, within: &strategy, messages, hardware: Hardware::default() };
        assert_eq!(cluster.gather_s(4000.0), 3.0);
    }

    /// A rank of half the speed gets half as many jobs as the other if chunks are small, and half of all jobs if they
    /// are dealt.
    #[test]
    fn a_slow_rank_gets_less_where_it_asks() {
        let costs = [1.0; 300];
        let strategy = within("serial");
        let hardware = Hardware::OneSlow(0.5);
        let crew = Crew { ranks: 2, threads: 1 };
        let cluster = Cluster { crew, within: &strategy, messages: Messages::default(), hardware };
        let at = |rule: &str| cluster.makespan_s(&costs, Lab::new().rank_rule("ranks", rule).unwrap().distribution());
        assert_eq!(at("static-blocks"), 300.0);
        assert!((200.0..=202.0).contains(&at("dynamic:1")), "{}", at("dynamic:1"));
        assert!((200.0..=205.0).contains(&at("awf-c")), "{}", at("awf-c"));
    }

    #[test]
    fn no_jobs_take_no_time() {
        for rule in ["static-cyclic", "guided", "master-worker", "working-master", "awf-b"] {
            let found = makespan_s(rule, 2, 2, Messages::default(), &[]);
            assert!(found <= LOOK.as_secs_f64(), "{rule}: {found}");
        }
        assert!(matches!(within("serial").discipline, Discipline::InOrder));
    }
}
