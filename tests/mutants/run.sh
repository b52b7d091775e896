#!/usr/bin/env bash
# Applies named faults one by one to a scratch copy of what is committed, and prints what notices each.
#
#   tests/mutants/run.sh            all of them: hours
#   tests/mutants/run.sh roots ties those whose names contain one of the words
cd "$(dirname "$0")/../.." || exit
PATHMARK_MUTANTS="$*" exec cargo test --quiet --test mutants -- --ignored --nocapture
