#!/usr/bin/env python3
"""Looks for the numbers with intervals of README.md in results/FINDINGS.md and results/CLAIMS.md.

usage: cited.py [README.md]

A number is `1.94 (1.91 to 2.07)`, and must occur there exactly so; `18.2 % (17.7 to 20.0)` more stands for the ratio
`1.182 (1.177 to 1.200)`. A number that is not there, or a README without numbers, ends with code 1.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NUMBER = re.compile(r"(\d[\d.]*)( %)? \((\d[\d.]*) to (\d[\d.]*)\)")


def ratio(percent):
    """The ratio of a price in percent, with as many digits: 18.2 is 1.182."""
    digits = len(percent.partition(".")[2])
    return f"{1 + float(percent) / 100:.{digits + 2}f}"


def main(readme):
    lists = ("results/FINDINGS.md", "results/CLAIMS.md")
    rows = " ".join(" ".join((ROOT / name).read_text().split()) for name in lists)
    numbers = list(NUMBER.finditer(" ".join(readme.read_text().split())))
    missing = []
    for found in numbers:
        value, low, high = (ratio(own) if found[2] else own for own in found.group(1, 3, 4))
        if f" {value} ({low} to {high})" not in rows:
            missing.append(f"{found[0]} is neither in {' nor in '.join(lists)}")
    print(f"{len(numbers)} numbers looked up")
    print("\n".join(missing) if missing else "all agree")
    return 1 if missing or not numbers else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "README.md")))
