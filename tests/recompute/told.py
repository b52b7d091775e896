#!/usr/bin/env python3
"""Computes numbers in sentences of results/README.md from verdicts and tables beside it.

usage: told.py [README.md]

Each sentence must stand in the README as it is computed. One that does not is printed, and ends with code 1.
"""

import csv
import re
import statistics
import sys
from collections import Counter
from pathlib import Path


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def widths(table, column):
    """Widths of the intervals of a column, relative to the values."""
    known = [row for row in table if row[column]]
    return [(float(row[column + ": high"]) - float(row[column + ": low"])) / float(row[column]) for row in known]


def claims(folder):
    decided = [row for row in rows(folder / "claims/claims.csv") if row["verdict"] in ("confirmed", "refuted")]
    runs = Counter()
    for row in decided:
        same = re.match(r"in (\d) of (\d) runs?", row["runs"])
        assert not same or same[1] == same[2], row["claim"]
        runs["together" if not same else "single" if same[1] == "1" else "each"] += 1
    yield (
        f"Of the {len(decided)} claims that are confirmed or refuted, {runs['each']} have this verdict in each of three or "
        f"four runs, {runs['single']} in a single run, and {runs['together']} only in the rows of three runs together."
    )


def accuracy(folder):
    figures = folder / "reports/accuracy-cost/figures"
    points = rows(figures / "rmse-against-time.csv")
    seconds, errors = widths(points, "seconds"), widths(points, "RMSE, linear")
    narrow = [sum(width <= 0.05 for width in all) for all in (seconds, errors)]
    yield f"{narrow[0]} of {len(points)} intervals of seconds are at most 5 % wide, and the widest has {max(seconds):.0%}"
    yield f"Of the errors, {narrow[1]} are known to 5 %"
    prices = rows(figures / "accuracy-prices.csv")
    own = widths(prices, "seconds")
    unknown = Counter(row["measured"].split(": ")[1].split(" ")[0] for row in prices if not row["seconds"])
    yield (
        f"Of {len(prices)} seconds for a goal of RMSE, {unknown['not']} are unknown because no line reaches the goal, and "
        f"{unknown['reached']} because the least samples reach it. Of the other {len(own)}, "
        f"{sum(width <= 0.05 for width in own)} are known to 5 %; the median width is {statistics.median(own):.0%}"
    )


def effects(folder):
    figures, known = folder / "xeon/effects/figures", []
    tables = {
        "effects-table": {"ratio unused / absent": 0.01, "ratio used / absent": 0.02},
        "effects-in-lanes-table": {"ratio used / absent": 0.02},
        "effect-steps": {"time, scalar": 0.02, "time, lanes": 0.02},
        "profiles-table": {"ratio": 0.01},
    }
    for name, columns in tables.items():
        table = rows(figures / f"{name}.csv")
        for column, goal in columns.items():
            # Several effects share a kernel in which they are unused.
            own = {(row[column + ": low"], row[column + ": high"]): row for row in table if row[column]}
            known += [(width / 2, goal) for width in widths(own.values(), column)]
    yield (
        f"Of its {len(known)} ratios {sum(half <= goal for half, goal in known)} are known to 1 % (an effect that is not "
        f"used) or 2 % (one that is used) to either side, and the widest to {max(half for half, _ in known):.1%}."
    )


def main(readme):
    text = " ".join(readme.read_text().split())
    folder = readme.parent
    sentences = [re.sub(r"(\d)%", r"\1 %", told) for told in [*claims(folder), *accuracy(folder), *effects(folder)]]
    wrong = [told for told in sentences if told not in text]
    for told in wrong:
        print(f"{readme}: does not say: {told}")
    if not wrong:
        print(f"{readme}: {len(sentences)} sentences agree with verdicts and tables")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/README.md")))
