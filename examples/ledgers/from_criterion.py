#!/usr/bin/env python3
"""Writes the samples of criterion as CSV: from_criterion.py target/criterion > rows.csv

Columns: group, function, parameter, repetition, seconds (of one iteration), started_utc. Each sample is a repetition.
Criterion runs one function after the other, so drift of the machine is in every ratio.

Criterion keeps no times of day. `started_utc` is the time at which the samples of a function were written, less their
seconds. The warm-up is not among them, so the function began no later than this. Convert the files where they were
measured, or copy them with `cp -p`.

A folder with `estimates.json` alone has one row: the slope, or the mean if samples had the same number of iterations. It
counts as one repetition, and nothing tells when it began.
"""

import csv
import json
import sys
from datetime import datetime, timezone
from pathlib import Path


def main(folder):
    """Prints the rows."""
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["group", "function", "parameter", "repetition", "seconds", "started_utc"])
    for path in sorted(Path(folder).rglob("new/benchmark.json")):
        names = json.loads(path.read_text(encoding="utf-8"))
        own = [names[key] or "" for key in ("group_id", "function_id", "value_str")]
        path = path.with_name("sample.json")
        if not path.is_file():
            estimates = json.loads(path.with_name("estimates.json").read_text(encoding="utf-8"))
            best = estimates.get("slope") or estimates["mean"]
            rows.writerow([*own, 0, best["point_estimate"] / 1e9, ""])
            continue
        sample = json.loads(path.read_text(encoding="utf-8"))
        began = path.stat().st_mtime - sum(sample["times"]) * 1e-9
        began = datetime.fromtimestamp(began, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        for repetition, (iterations, nanoseconds) in enumerate(zip(sample["iters"], sample["times"])):
            rows.writerow([*own, repetition, nanoseconds / iterations * 1e-9, began])


main(sys.argv[1])
