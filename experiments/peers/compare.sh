#!/usr/bin/env bash
# Compares our samples per second on one thread with the C++ yardstick's, in interleaved pairs: ours, theirs, theirs, ours, ...
#
#   experiments/peers/compare.sh [PAIRS] [g++ flags; default -O3] [-- options of `pathmark render`]
#   experiments/peers/compare.sh 15 -O3 -march=native -ffast-math -- --kernel lanes --simd avx2 --estimator bsdf
#
# Needs g++. Prints each pair's ratio (ours / theirs) and their median.
set -euo pipefail
cd "$(dirname "$0")/../.."
pairs=${1:-9}
shift || true
flags=''
while (($#)) && [[ $1 != -- ]]; do flags+=" $1" && shift; done
flags=${flags:- -O3}
options=("${@:2}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cargo build --release --quiet
# shellcheck disable=SC2086  # flags are several words
g++ $flags experiments/peers/smallpt_peer.cpp -o "$work/peer"

ours() {
  "${CARGO_TARGET_DIR:-target}/release/pathmark" render cornell --size 256x192 --spp 32 --strategy serial --json --quiet \
    -o "$work/image.pfm" "${options[@]}" |
    sed -E 's/.*"makespan_s":([0-9.e-]+).*"paths":([0-9]+).*/\1 \2/' | awk '{ print $2 / $1 }'
}
theirs() { OMP_NUM_THREADS=1 "$work/peer" 256 192 32 | awk '{ print $6 }'; }

ours >/dev/null
for ((pair = 1; pair <= pairs; pair++)); do
  if ((pair % 2)); then a=$(ours) b=$(theirs); else b=$(theirs) a=$(ours); fi
  awk -v a="$a" -v b="$b" 'BEGIN { printf "%.3f   ours %.3f, theirs %.3f Msamples/s\n", a / b, a * 1e-6, b * 1e-6 }'
done | tee "$work/pairs"
sort -n "$work/pairs" | awk -v flags="$flags" -v options="${options[*]}" '{ r[NR] = $1 } END {
  m = NR % 2 ? r[(NR + 1) / 2] : (r[NR / 2] + r[NR / 2 + 1]) / 2
  printf "%s: median of %d pairs against g++%s: %.3f (%.3f to %.3f)\n", options ? options : "defaults", NR, flags, m, r[1], r[NR] }'
