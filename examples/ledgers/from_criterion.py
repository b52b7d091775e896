#!/usr/bin/env python3
"""Writes the samples of criterion as CSV: from_criterion.py target/criterion > rows.csv

Columns: group, function, parameter, repetition, seconds (of one iteration). Each sample is a repetition. Criterion runs
one function after the other, so drift of the machine is in every ratio.
"""

import csv
import json
import sys
from pathlib import Path

rows = csv.writer(sys.stdout, lineterminator="\n")
rows.writerow(["group", "function", "parameter", "repetition", "seconds"])
for path in sorted(Path(sys.argv[1]).rglob("new/sample.json")):
    sample = json.loads(path.read_text())
    names = json.loads(path.with_name("benchmark.json").read_text())
    own = [names[key] or "" for key in ("group_id", "function_id", "value_str")]
    for repetition, (iterations, nanoseconds) in enumerate(zip(sample["iters"], sample["times"])):
        rows.writerow([*own, repetition, nanoseconds / iterations * 1e-9])
