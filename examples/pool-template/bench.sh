#!/usr/bin/env bash
# Did the pool get slower? Builds this commit and BASE, and runs both builds in turns. Arguments go to `run`, as in
# `bash bench.sh --set threads=4`. Exit code 1: a cell is certainly slower by more than 5 %.
set -euo pipefail
base=${BASE:-origin/main} profile=${PROFILE:-release} time=${MAX_TIME:-60s}
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
program=$CARGO_TARGET_DIR/${profile/dev/debug}/my-pool

rm -rf old out
git worktree prune
git worktree add --detach old "$base"
# Both builds share their dependencies, so only the pool is compiled twice. Cargo takes both for one package, and without
# `clean` it would not compile the second one.
build() (
    cd "$1"
    cargo clean --quiet --profile "$profile" --package my-pool
    cargo build --profile "$profile"
)
build old
cp "$program" old/before
build .

"$program" run bench --baseline old/before --until 5% --max-time "$time" "$@"
"$program" diff out/baseline/bench out/bench --fail-above 5% --undecided pass
