#!/usr/bin/env bash
# Applies named faults one by one to a scratch copy of the commit, and prints the case or test that notices each fault.
#
#   tests/mutants/run.sh            all faults: hours
#   tests/mutants/run.sh roots ties only faults whose names contain one of the words
cd "$(dirname "$0")/../.." || exit
PATHMARK_MUTANTS="$*" exec cargo test --quiet --test mutants -- --ignored --nocapture
