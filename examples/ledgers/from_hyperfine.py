#!/usr/bin/env python3
"""Writes the rows of `hyperfine --export-json FILE` as CSV: from_hyperfine.py FILE > rows.csv

Columns: command, one for each parameter, repetition, seconds. Hyperfine runs one command after the other, so the same
repetition of two commands lies minutes apart, and drift of the machine is in every ratio.
"""

import csv
import json
import sys

results = json.load(open(sys.argv[1]))["results"]
parameters = sorted({name for result in results for name in result.get("parameters", {})})
rows = csv.writer(sys.stdout, lineterminator="\n")
rows.writerow(["command", *parameters, "repetition", "seconds"])
for result in results:
    own = [result.get("parameters", {}).get(name, "") for name in parameters]
    for repetition, seconds in enumerate(result["times"]):
        rows.writerow([result["command"], *own, repetition, seconds])
