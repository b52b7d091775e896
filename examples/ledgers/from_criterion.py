#!/usr/bin/env python3
"""Writes the samples of criterion as CSV: from_criterion.py target/criterion > rows.csv

Columns: group, function, parameter, repetition, seconds (of one iteration), started_utc. Each sample is a repetition.
Criterion runs one function after the other, so drift of the machine is in every ratio.

Criterion keeps no times of day. `started_utc` is the time at which the samples of a function were written, less their
seconds. The warm-up is not among them, so the function began no later than this. Convert the files where they were
measured, or copy them with `cp -p`.
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
    for path in sorted(Path(folder).rglob("new/sample.json")):
        sample = json.loads(path.read_text(encoding="utf-8"))
        names = json.loads(path.with_name("benchmark.json").read_text(encoding="utf-8"))
        own = [names[key] or "" for key in ("group_id", "function_id", "value_str")]
        began = path.stat().st_mtime - sum(sample["times"]) * 1e-9
        began = datetime.fromtimestamp(began, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        for repetition, (iterations, nanoseconds) in enumerate(zip(sample["iters"], sample["times"])):
            rows.writerow([*own, repetition, nanoseconds / iterations * 1e-9, began])


main(sys.argv[1])
