#!/usr/bin/env python3
"""Writes the rows of `hyperfine --export-json FILE` as CSV: from_hyperfine.py FILE > rows.csv

Columns: command, one for each parameter, repetition, seconds, started_utc. A run whose exit code is not 0 has empty
seconds, which means that it was not measured. Hyperfine runs one command after the other, so the same repetition of two
commands lies minutes apart, and drift of the machine is in every ratio.

Hyperfine keeps no times of day. `started_utc` is the time at which FILE was written, less all seconds in it. FILE does
not have the seconds of preparations and warm-ups, so the first run began no later than this. A copy of FILE may have
another time: convert FILE where it was measured, or copy it with `cp -p`.
"""

import csv
import json
import os
import sys
from datetime import datetime, timezone


def main(path):
    """Prints the rows."""
    with open(path, encoding="utf-8") as file:
        results = json.load(file)["results"]
    parameters = sorted({name for result in results for name in result.get("parameters", {})})
    began = os.stat(path).st_mtime - sum(sum(result["times"]) for result in results)
    began = datetime.fromtimestamp(began, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["command", *parameters, "repetition", "seconds", "started_utc"])
    for result in results:
        own = [result.get("parameters", {}).get(name, "") for name in parameters]
        times = result["times"]
        # Old versions write no codes; null is the code of a run that a signal ended.
        codes = result.get("exit_codes", [0] * len(times))
        if len(codes) != len(times):
            sys.exit(f"{path}: {result['command']}: {len(times)} times and {len(codes)} exit_codes")
        for repetition, (seconds, code) in enumerate(zip(times, codes)):
            rows.writerow([result["command"], *own, repetition, seconds if code == 0 else "", began])
        failed = sum(code != 0 for code in codes)
        if failed:
            problem = f"{failed} of {len(codes)} runs failed, so their seconds are empty"
            print(f"{path}: {result['command']}: {problem}", file=sys.stderr)


main(sys.argv[1])
