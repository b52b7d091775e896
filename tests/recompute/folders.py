#!/usr/bin/env python3
"""Counts the rows of the folders in the table of results/README.md, and compares them with what it says.

usage: folders.py [README.md]

A line of the table begins with a folder in backquotes; `*/` stands for the experiments beside the README that have no
line of their own. Its columns are folder, command, rows, rows in doubt and commit. A difference ends with code 1.
"""

import csv
import gzip
import re
import sys
import tomllib
from pathlib import Path

csv.field_size_limit(1 << 24)

# Warnings that put a row's time in doubt (`pathmark list warnings`).
DOUBTS = {"foreign-load", "steal", "slowed", "drift", "too-short"}


def counted(folder, pattern, others=()):
    """Rows, rows in doubt, and the commits of the sweeps of a folder, without those of other lines."""
    rows, doubted, commits = 0, 0, set()
    for path in sorted(path for path in folder.glob(pattern) if path.parent.name not in others):
        with gzip.open(path, "rt", newline="") if path.suffix == ".gz" else path.open(newline="") as file:
            warnings = [{word.split("(")[0] for word in row["warnings"].split(";")} for row in csv.DictReader(file)]
        run = [own for own in warnings if not own & {"no-program", "no-device"}]
        rows += len(run)
        doubted += sum(bool(own & DOUBTS) for own in run)
        commits.add(tomllib.loads((path.parent / "machine.toml").read_text())["machine"]["commit"])
    return rows, doubted, commits


def main(readme):
    form = re.compile(r"\| `([^`]+)/` \| [^|]+ \| (\d+) \| (\d+) \| (\w+) \|$")
    lines = [found for line in readme.read_text().splitlines() if (found := form.match(line))]
    names, differences = {found[1] for found in lines}, []
    for found in lines:
        name, rows, doubted, commit = found[1], int(found[2]), int(found[3]), found[4]
        folder = readme.parent if name == "*" else readme.parent / name
        has_several = any(folder.glob("*/records.csv*"))
        own = counted(folder, "*/records.csv*", names) if has_several else counted(folder, "records.csv*")
        if own != (rows, doubted, {commit}):
            differences.append(f"{name}: {own}, and the table says {(rows, doubted, {commit})}")
    print(f"{len(lines)} folders counted")
    print("\n".join(differences) if differences else "all agree")
    return 1 if differences or not lines else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2] / "results/README.md")))
