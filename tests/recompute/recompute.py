#!/usr/bin/env python3
"""Recomputes the verdicts on claims from rows, without a line of the program's own code.

usage: recompute.py [--ledger FILE] CLAIMS.csv FOLDER...

CLAIMS.csv is what `pathmark claims FOLDER... --out DIR` wrote into DIR/claims/claims.csv, or with a ledger into
DIR/claims/LEDGER.csv. The queries are read from the ledger, or from experiments/claims/*.toml, and the numbers from
FOLDER/EXPERIMENT/records.csv or records.csv.gz. It needs Python 3.11 and nothing else: the
quantiles of Student's t come from the incomplete beta function, those of the median from binomial sums.

Values and ends of intervals must agree to nine digits, and verdicts must be the same. A difference ends with code 1.
Simulated forecasts, failed hard cases and the list of guards are counted and not recomputed: they are not statistics of
rows.
"""

import csv
import gzip
import math
import sys
import tomllib
from collections import defaultdict
from pathlib import Path
from statistics import fmean, median, variance
from typing import NamedTuple

csv.field_size_limit(1 << 24)

ROOT = Path(__file__).resolve().parents[2]

# Settings of a row: two rows are compared only if they agree in all of these that the claim does not name.
SETTINGS = """scene scene_hash effects width height spp seed estimator sampler kernel kernel_fallback precision simd
    accelerator max_depth roulette adaptive target_error time_limit_s clamp filter epsilon decomposition strategy output
    threads pin ranks rank_rule""".split()

# Settings that follow from another one.
FOLLOWERS = {
    "scene": ["scene_hash", "effects", "accelerator", "max_depth", "roulette"],
    "estimator": ["max_depth", "roulette", "effects", "kernel_fallback"],
    "kernel": ["kernel_fallback", "simd", "effects", "accelerator"],
    "precision": ["simd", "accelerator"],
    "sampler": ["kernel", "kernel_fallback", "simd", "effects"],
}

TOLERANCE = 1e-9


# Distributions.


def beta_tail(a, b, x):
    """The regularised incomplete beta function, by Lentz's continued fraction (Press et al. 2007, section 6.4)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):
        return 1 - beta_tail(b, a, 1 - x)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    c, d = 1.0, 1 / (1 - (a + b) * x / (a + 1))
    product = d
    for m in range(1, 500):
        for term in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1 / (1 + term * d)
            c = 1 + term / c
            product *= c * d
        if abs(c * d - 1) < 1e-15:
            break
    return front * product


def bisect(is_above, low, high):
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (low, middle) if is_above(middle) else (middle, high)
    return (low + high) / 2


def t_quantile(level, degrees):
    """Two-sided quantile of Student's t: P(|T| < t) = level."""
    outside = lambda t: beta_tail(degrees / 2, 0.5, degrees / (degrees + t * t))
    return bisect(lambda t: outside(t) < 1 - level, 0, 1e9)


def normal_quantile(level):
    return bisect(lambda z: math.erf(z / math.sqrt(2)) > level, 0, 40)


class Estimate(NamedTuple):
    value: float
    low: float | None  # as `high`, `None` for a single unit
    high: float | None
    judged: bool = True  # whether it has a verdict of its own; the mean of one or two units has none


def t_interval(values, level):
    error = math.sqrt(variance(values) / len(values))
    half = t_quantile(level, len(values) - 1) * error
    return fmean(values) - half, fmean(values) + half


def median_ends(values, level):
    """The narrowest symmetric pair of order statistics with at least that confidence."""
    n, ordered, found = len(values), sorted(values), None
    for rank in range(1, n // 2 + 1):
        below = sum(math.comb(n, k) for k in range(rank)) / 2**n
        if 1 - 2 * below >= level:
            found = ordered[rank - 1], ordered[n - rank]
    return found


def of_pairs(values, level):
    """The geometric mean of processes; from sixteen on without the eighth at either end (Tukey and McLaughlin 1963)."""
    ordered = sorted(map(math.log, values))
    n = len(ordered)
    cut = n // 8 if n >= 16 else 0
    kept = ordered[cut : n - cut]
    winsorized = [min(max(value, kept[0]), kept[-1]) for value in ordered]
    error = math.sqrt(variance(winsorized) * (n - 1) / len(kept) / (len(kept) - 1))
    value, half = fmean(kept), t_quantile(level, len(kept) - 1) * error
    return Estimate(math.exp(value), math.exp(value - half), math.exp(value + half))


def typical(values, level, is_ratio, in_pairs=False):
    """Ratios of adjacent pairs: as figures have them. Others: from six units on the median, below the (geometric) mean."""
    if not values:
        return None
    if len(values) > 1 and len(set(values)) == 1:
        return Estimate(values[0], values[0], values[0])
    if in_pairs and len(values) >= 3:
        return of_pairs(values, level)
    if len(values) >= 6 and (ends := median_ends(values, level)):
        return Estimate(median(values), *ends)
    to, back = (math.log, math.exp) if is_ratio else (float, float)
    scaled = [to(value) for value in values]
    if len(values) == 1:
        return Estimate(back(fmean(scaled)), None, None, False)
    low, high = t_interval(scaled, level)
    return Estimate(back(fmean(scaled)), back(low), back(high), len(values) > 2)


def line(points, level=None):
    """The slope of log y against log x, with Student's interval if a level is given."""
    xs, ys = [math.log(x) for x, _ in points], [math.log(y) for _, y in points]
    x, y, n = fmean(xs), fmean(ys), len(points)
    squares = sum((a - x) ** 2 for a in xs)
    if squares == 0:
        return None
    slope = sum((a - x) * (b - y) for a, b in zip(xs, ys)) / squares
    if level is None:
        return slope
    rest = sum((b - y - slope * (a - x)) ** 2 for a, b in zip(xs, ys))
    half = t_quantile(level, n - 2) * math.sqrt(rest / (n - 2) / squares)
    return Estimate(slope, slope - half, slope + half)


# Rows.


def number(row, column):
    try:
        return float(row[column])
    except (KeyError, ValueError):
        return None


def admits(row, conditions):
    def one(column, wanted):
        if isinstance(wanted, str) and wanted[:2] in (">=", "<="):
            own = number(row, column)
            return own is not None and (own >= float(wanted[2:]) if wanted[0] == ">" else own <= float(wanted[2:]))
        wanted = str(wanted).lower() if isinstance(wanted, bool) else str(wanted)
        return row[column] == wanted or (number(row, column) is not None and str(number(row, column)) == wanted)

    listed = {column: wanted if isinstance(wanted, list) else [wanted] for column, wanted in conditions.items()}
    return all(any(one(column, value) for value in wanted) for column, wanted in listed.items())


def read(folder, experiment):
    path = folder / experiment / "records.csv"
    packed = path.with_name("records.csv.gz")
    if not path.is_file() and not packed.is_file():
        return []
    with path.open(newline="") if path.is_file() else gzip.open(packed, "rt", newline="") as file:
        rows = [row for row in csv.DictReader(file) if not row["error"] and row["makespan_s"]]
    number_turns([row for row in rows if row.get("pair")])
    return rows


def number_turns(rows):
    """Rows of one turn ran one after another: every group of compared cells counts its pairs, and their places, from 0."""
    rows.sort(key=lambda row: (int(row["repetition"]), int(row["run_order"])))
    turn, last = 0, None
    for row in rows:
        own = [int(row[name]) for name in ("repetition", "pair", "place")]
        turn += last is not None and (own[:2] != last[:2] or own[2] <= last[2])
        row["turn"], last = str(turn), own


def unit_of(unit, run, row):
    return {"repetition": (run, row["seed"], row["repetition"]), "seed": row["seed"], "scene": row["scene"]}[unit]


def of_units(values, unit, level, is_ratio, in_pairs=False):
    """`values`: (run, row, value). Median over the pairs of a cell, mean over cells, typical over units."""
    units = defaultdict(lambda: defaultdict(list))
    for run, row, value in values:
        units[unit_of(unit, run, row)][(run if unit == "repetition" else 0, row["cell"])].append(value)
    to, back = (math.log, math.exp) if is_ratio else (float, float)
    means = {key: back(fmean([to(median(pairs)) for pairs in cells.values()])) for key, cells in units.items()}
    runs = {key[0] for key in means} if unit == "repetition" else set()
    if len(runs) >= 6:
        means = {run: back(fmean([to(v) for key, v in means.items() if key[0] == run])) for run in runs}
    return typical(list(means.values()), level, is_ratio, in_pairs and unit == "repetition" and len(runs) < 6)


def ratios(rows, over, named, column):
    """Ratios of rows and their partners, and whether these are of adjacent pairs."""
    free = set(named).union(*(FOLLOWERS.get(name, []) for name in named))
    kept = [name for name in SETTINGS if name not in free]
    for keeps_pairs in (True, False):

        def keyed(rows):
            found = defaultdict(list)
            for run, row in rows:
                if (value := number(row, column)) is not None:
                    pair = row.get("turn", "") if keeps_pairs else ""
                    settings = tuple(row.get(name, "") for name in kept)
                    found[run, settings, row["repetition"], pair, row["cell"]].append((row, value))
            return {key: (all[0][0], median([value for _, value in all])) for key, all in found.items()}

        below = {key[:4]: value for key, (_, value) in keyed(over).items()}
        found = [(key[0], row, value / below[key[:4]]) for key, (row, value) in keyed(rows).items() if key[:4] in below]
        if found:
            break
    in_pairs = keeps_pairs and any(row.get("pair", "") for _, row, _ in found)
    return [(run, row, ratio) for run, row, ratio in found if 0 < ratio < math.inf], in_pairs


def per_seed(rows, column):
    """The mean over images of each seed; an image that a seed lacks is left out for all."""
    images = defaultdict(dict)
    for _, row in rows:
        if (value := number(row, column)) is not None:
            image = tuple(row.get(name, "") for name in IMAGE if name != "seed")
            images[image].setdefault(row["seed"], value)
    seeds = {seed for values in images.values() for seed in values}
    whole = [values for values in images.values() if len(values) == len(seeds)]
    return {seed: fmean([values[seed] for values in whole]) for seed in seeds} if whole else {}


# What belongs to the image, not to the schedule.
IMAGE = [name for name in SETTINGS if name not in "decomposition strategy output threads pin ranks rank_rule".split()]


def jackknife(items, statistic, level):
    n, whole = len(items), statistic(items)
    pseudo = [n * whole - (n - 1) * statistic(items[:i] + items[i + 1 :]) for i in range(n)]
    return Estimate(fmean(pseudo), *t_interval(pseudo, level))


def rmse_slope(rows, level):
    by_spp = defaultdict(list)
    for item in rows:
        by_spp[float(item[1]["spp"])].append(item)
    errors = {spp: per_seed(own, "mse") for spp, own in by_spp.items()}
    seeds = sorted({row["seed"] for _, row in rows})
    whole = {spp: own for spp, own in errors.items() if len(own) == len(seeds) and min(own.values()) > 0}
    slope = lambda kept: line([(spp, fmean([own[seed] for seed in kept])) for spp, own in sorted(whole.items())]) / 2
    return jackknife(seeds, slope, level)


def mean_ratio(rows, over, column, level):
    sides = [list(per_seed(side, column).values()) for side in (rows, over)]
    errors = [variance(side) / len(side) / fmean(side) ** 2 for side in sides]
    degrees = sum(errors) ** 2 / sum(e * e / (len(s) - 1) for e, s in zip(errors, sides))
    value, factor = fmean(sides[0]) / fmean(sides[1]), math.exp(t_quantile(level, degrees) * math.sqrt(sum(errors)))
    return Estimate(value, value / factor, value * factor)


def ranks(values):
    below, equal = (lambda v: sum(other < v for other in values)), (lambda v: values.count(v))
    return [below(value) + (equal(value) + 1) / 2 for value in values]


def rank_correlation(rows, claim, level):
    groups = defaultdict(list)
    for _, row in rows:
        point = number(row, claim["x"]), number(row, claim["y"])
        if None not in point:
            groups[row[claim["by"]]].append(point)
    a, b = (ranks([fmean([point[i] for point in own]) for own in groups.values()]) for i in (0, 1))
    x, y, n = fmean(a), fmean(b), len(a)
    spread = lambda v, m: math.sqrt(sum((own - m) ** 2 for own in v))
    rho = sum((p - x) * (q - y) for p, q in zip(a, b)) / spread(a, x) / spread(b, y)
    centre = math.atanh(max(-0.999999, min(0.999999, rho)))
    half = normal_quantile(level) * math.sqrt(1.06 / (n - 3))
    return Estimate(rho, math.tanh(centre - half), math.tanh(centre + half))


# Claims.


def measure(claim, runs, comparable, level):
    """The statistic of the rows of some runs, or `None`. `runs`: the rows of each."""
    wanted, kind = claim.get("rows", {}), claim["statistic"]
    everything = [(run, row) for run, rows in enumerate(runs) for row in rows]
    rows = [(run, row) for run, row in everything if admits(row, wanted) and admits(row, comparable)]
    over = [(run, row) for run, row in everything if "over" in claim and admits(row, claim["over"])]
    unit, column = claim.get("unit", "repetition"), claim.get("column")
    if kind == "value":
        sums = [column, *([claim["plus"]] if "plus" in claim else [])]
        below = (lambda row: number(row, claim["per"])) if "per" in claim else (lambda row: 1.0)
        parts = [(run, row, [number(row, name) for name in sums], below(row)) for run, row in rows]
        values = [(run, row, sum(above) / per) for run, row, above, per in parts if None not in above and per]
        return of_units(values, unit, level, False)
    if kind == "count":
        values = [number(row, column) for _, row in rows if number(row, column) is not None]
        return Estimate(*(sum(values),) * 3) if values else None
    if kind in ("paired-ratio", "speedup"):
        named = [*wanted, *claim["over"]]
        found, in_pairs = ratios(rows, over, named, column or "makespan_s")
        if kind == "speedup":
            found = [(run, row, 1 / ratio) for run, row, ratio in found]
        return of_units(found, unit, level, True, in_pairs)
    if kind == "exponent":
        return exponent(rows, claim["x"], claim["y"], unit, level)
    if kind == "checksum":
        images = defaultdict(list)
        for run, row in rows:
            if row["checksum"]:
                images[run, tuple(row.get(name, "") for name in IMAGE)].append(row["checksum"])
        most = max((len(set(sums)) for sums in images.values() if len(sums) > 1), default=None)
        return None if most is None else Estimate(*(most,) * 3)
    if not rows:
        return None
    if kind == "rmse-slope":
        return rmse_slope(rows, level)
    if kind == "mean-ratio":
        return mean_ratio(rows, over, column, level)
    return rank_correlation(rows, claim, level)


def exponent(rows, x, y, unit, level):
    cells = defaultdict(list)
    for run, row in rows:
        if (number(row, x) or 0) > 0 and number(row, y) is not None:
            cells[run, row["cell"], row["repetition"]].append((row, number(row, y)))
    points = [(run, own[0][0], number(own[0][0], x), median([v for _, v in own])) for (run, *_), own in cells.items()]
    points = [point for point in points if point[3] > 0]
    if unit == "repetition":
        return line([point[2:] for point in points], level) if len(points) > 2 else None
    lines = defaultdict(list)
    for run, row, *point in points:
        lines[unit_of(unit, run, row)].append(point)
    slopes = [slope for own in lines.values() if (slope := line(own)) is not None]
    return typical(slopes, level, False)


def predicted(claim):
    low, high = claim.get("within", [claim.get("at-least", -math.inf), claim.get("at-most", math.inf)])
    return low, high


def verdict(found, claim):
    (low, high), (_, own_low, own_high, _) = predicted(claim), found
    if own_low is None:
        return "open"
    if low <= own_low and own_high <= high:
        return "confirmed"
    return "refuted" if own_high < low or high < own_low else "open"


def judge(claim, folders):
    """Verdict and estimate of a claim; the verdict alone if nothing is measured."""
    level, comparable = claim["level"], claim.get("comparable-if", {})
    parts = []
    for folder in folders:
        rows = read(folder, claim["experiment"])
        for conditions in (comparable, {}):
            if found := measure(claim, [rows], conditions, level):
                parts.append((conditions == comparable, found, rows))
                break
    if not parts:
        return "not-answered", None
    best = any(is_comparable for is_comparable, *_ in parts)
    parts = [part for part in parts if part[0] == best]
    together = parts[0][1]
    if len(parts) > 1:
        together = measure(claim, [rows for *_, rows in parts], comparable if best else {}, level)
    if not best and not claim.get("a-fortiori"):
        return "not-comparable", together
    if not {"within", "at-least", "at-most"} & set(claim):
        return "measured", together
    told = verdict(together, claim)
    alone = [found for _, found, _ in parts if found.judged]
    return told if all(verdict(found, claim) == told for found in alone) else "open", together


def main(*arguments):
    ledgers = sorted(ROOT.glob("experiments/claims/*.toml"))
    if arguments[0] == "--ledger":
        ledgers, arguments = [Path(arguments[1])], arguments[2:]
    listing, *folders = arguments
    folders = sorted(Path(folder).resolve() for folder in folders)
    with open(listing, newline="") as file:
        told = {row["claim"]: row for row in csv.DictReader(file)}
    claims = [claim for path in ledgers for claim in tomllib.loads(path.read_text())["claim"]]
    counts, failures = defaultdict(int), []
    for claim in claims:
        row, kind = told[str(claim["id"])], claim.get("statistic", "none")
        if kind in ("none", "forecast", "case", "guard"):
            counts[kind] += 1
            continue
        own_verdict, found = judge(claim, folders)
        counts["rows"] += 1
        counts["measured"] += found is not None
        printed = [float(row[name]) if row[name] else None for name in ("measured", "low", "high")]
        is_same = lambda a, b: a is b or None not in (a, b) and math.isclose(a, b, rel_tol=TOLERANCE, abs_tol=1e-12)
        pairs = zip(found or (None,) * 3, printed)
        if own_verdict != row["verdict"].replace(" ", "-") or not all(is_same(a, b) for a, b in pairs):
            failures.append(f"claim {claim['id']}: {own_verdict} {found}, and printed {row['verdict']} {printed}")
    others = ", ".join(f"{n} {kind}" for kind, n in counts.items() if kind not in ("rows", "measured"))
    print(f"recomputed {counts['rows']} claims, {counts['measured']} of them with a value; not of rows: {others}")
    print("\n".join(failures) if failures else "all agree")
    return 1 if failures or not counts["rows"] else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
