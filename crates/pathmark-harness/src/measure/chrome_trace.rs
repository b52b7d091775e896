//! A trace as a file for Perfetto and `chrome://tracing`: one row per worker, one box per job.
//!
//! The JSON object format of the "Trace Event Format" (N. Duffy and D. Sinclair, Google, 2016): complete events (`"ph": "X"`) with
//! start `ts` and length `dur` in microseconds, and metadata events (`"ph": "M"`) that name the process and its threads.

use serde_json::{Value, json};

use super::trace::Trace;

/// The one process of a trace; some viewers take 0 for the idle process.
const PROCESS: u32 = 1;

/// The events of `trace`. The process is called `process`, and job number i is called `name(i)`. Events are ordered by
/// their starts, after the names; `args.job` holds the job's index.
pub fn chrome_trace(trace: &Trace, process: &str, name: impl Fn(usize) -> String) -> Value {
    let metadata = |what: &str, thread: u32, name: &str| json!({ "ph": "M", "name": what, "pid": PROCESS, "tid": thread, "args": { "name": name } });
    let workers = trace.jobs.iter().map(|job| job.worker + 1).max().unwrap_or(0);
    let mut events = vec![metadata("process_name", 0, process)];
    events.extend((0..workers).map(|worker| metadata("thread_name", worker, &format!("worker {worker}"))));
    let mut order: Vec<usize> = (0..trace.jobs.len()).collect();
    order.sort_by(|&a, &b| trace.jobs[a].start_s.total_cmp(&trace.jobs[b].start_s));
    events.extend(order.into_iter().map(|index| {
        let job = &trace.jobs[index];
        json!({
            "ph": "X",
            "name": name(index),
            "cat": "job",
            "pid": PROCESS,
            "tid": job.worker,
            "ts": microseconds(job.start_s),
            "dur": microseconds(job.duration_s()).max(0.0),
            "args": { "job": index },
        })
    }));
    json!({ "traceEvents": events, "displayTimeUnit": "ms" })
}

/// Microseconds, rounded to nanoseconds: finer digits are noise of the clock and double the file.
fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::trace::JobSpan;

    fn parsed(trace: &Trace) -> Value {
        let text = chrome_trace(trace, "cornell \"128\"", |job| format!("piece {job}")).to_string();
        serde_json::from_str(&text).unwrap()
    }

    fn of_phase<'a>(trace: &'a Value, phase: &str) -> Vec<&'a Value> {
        trace["traceEvents"].as_array().unwrap().iter().filter(|event| event["ph"] == phase).collect()
    }

    #[test]
    fn events_have_all_fields_of_the_format() {
        let span = |worker, start_s, stop_s| JobSpan { worker, start_s, stop_s };
        let trace =
            Trace { jobs: vec![span(0, 0.5, 1.5), span(1, 0.25, 0.25), span(0, 0.0, 0.5), span(1, 0.25, 1.25)] };
        let parsed = parsed(&trace);
        assert_eq!(parsed["displayTimeUnit"], "ms");
        let events = of_phase(&parsed, "X");
        assert_eq!(events.len(), 4);
        for event in &events {
            assert!(event["name"].is_string() && event["cat"].is_string() && event["pid"].is_u64());
            assert!(event["ts"].as_f64().unwrap() >= 0.0 && event["dur"].as_f64().unwrap() >= 0.0);
            let job = &trace.jobs[event["args"]["job"].as_u64().unwrap() as usize];
            assert_eq!(event["tid"], job.worker);
            assert_eq!(event["ts"].as_f64().unwrap(), job.start_s * 1e6);
            assert_eq!(event["dur"].as_f64().unwrap(), job.duration_s() * 1e6);
        }
        let order: Vec<u64> = events.iter().map(|event| event["args"]["job"].as_u64().unwrap()).collect();
        assert_eq!(order, [2, 1, 3, 0]);
        assert_eq!(events[0]["name"], "piece 2");
    }

    #[test]
    fn process_and_workers_are_named_before_the_events() {
        let trace = Trace { jobs: (0..3).map(|worker| JobSpan { worker, ..JobSpan::default() }).collect() };
        let parsed = parsed(&trace);
        let names = of_phase(&parsed, "M");
        assert_eq!(names.len(), 4);
        assert_eq!((&names[0]["name"], &names[0]["args"]["name"]), (&json!("process_name"), &json!("cornell \"128\"")));
        for (worker, event) in names[1..].iter().enumerate() {
            assert_eq!(
                (&event["name"], &event["tid"], &event["pid"]),
                (&json!("thread_name"), &json!(worker), &json!(PROCESS))
            );
            assert_eq!(event["args"]["name"], format!("worker {worker}"));
        }
        assert_eq!(parsed["traceEvents"][3]["ph"], "M");
        assert_eq!(of_phase(&super::chrome_trace(&Trace::default(), "empty", |_| String::new()), "X").len(), 0);
    }
}
