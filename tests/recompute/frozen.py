#!/usr/bin/env python3
"""Compares each claim with the commit that its `frozen` names: query, prediction and expected verdict must be the same there.

usage: frozen.py [claims.toml ...]

Words for readers may differ. A claim that differs is printed, and ends with code 1. Without the history of the repository nothing is compared.
"""

import subprocess
import sys
import tomllib
from pathlib import Path

WORDS = {"quote", "place", "reported", "claim", "reason", "changed", "note", "frozen"}


def git(*arguments):
    return subprocess.run(["git", *arguments], capture_output=True, text=True)


def claims(text):
    found = {}
    for claim in tomllib.loads(text)["claim"]:
        found[claim["id"]] = {key: value for key, value in claim.items() if key not in WORDS}
    return found


def main(files):
    compared, wrong, old = 0, 0, {}
    for file in files:
        text = Path(file).read_text()
        now = claims(text)
        for claim in tomllib.loads(text)["claim"]:
            name, (fixed, commit) = f"{file}: claim {claim['id']}", claim["frozen"].split()
            if (file, commit) not in old:
                shown = git("show", f"{commit}:{file}")
                old[file, commit] = claims(shown.stdout) if shown.returncode == 0 else None
            then = old[file, commit]
            if then is None:
                if git("rev-parse", "--is-shallow-repository").stdout.strip() == "false":
                    wrong += 1
                    print(f"{name} names a commit that does not have it: {commit}")
                continue
            compared += 1
            if then.get(claim["id"]) != now[claim["id"]]:
                wrong += 1
                print(f"{name} differs from that of commit {commit}, which fixed it at {fixed}")
    print(f"{compared} claims are compared with the commits that fixed them, {wrong} differ")
    return wrong


if __name__ == "__main__":
    default = [f"experiments/claims/{letter}.toml" for letter in "ABCD"]
    sys.exit(1 if main(sys.argv[1:] or default) else 0)
