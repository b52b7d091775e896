#!/usr/bin/env bash
# Compares us on a mesh with one of three other programs, on one thread, in interleaved pairs: ours, theirs, theirs, ours, ...
#
#   experiments/peers/compare_mesh.sh embree [PAIRS] [TRIANGLES] [-- options of `pathmark inspect rays`]
#   TINYBVH=FOLDER experiments/peers/compare_mesh.sh tinybvh [PAIRS] [TRIANGLES] [-- options of `pathmark inspect rays`]
#   experiments/peers/compare_mesh.sh mitsuba [PAIRS] [TRIANGLES] [-- options of `pathmark render`]
#
# `embree`: rays per second of rtcIntersect1 with RTC_SCENE_FLAG_ROBUST, along the rays of our paths. Needs g++ and Debian's libembree-dev.
# `tinybvh`: the same with its trees for our precision (tinybvh.cpp). Needs g++, and tiny_bvh.h in the folder.
# `mitsuba`: time to equal RMSE, computed from the variance between two seeds. Needs Mitsuba 3 and LLVM (mitsuba_ball.py).
# Prints each pair's ratio, which is above 1 where we are faster, and their median.
set -euo pipefail
cd "$(dirname "$0")/../.."
peer=${1:?embree, tinybvh or mitsuba}
shift
numbers=()
while (($#)) && [[ $1 != -- ]]; do numbers+=("$1") && shift; done
pairs=${numbers[0]:-7}
triangles=${numbers[1]:-20000}
options=("${@:2}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
scene=bumpy-ball:$triangles
spp=64

cargo build --release --quiet
program=${CARGO_TARGET_DIR:-target}/release/pathmark
value() { sed -E "s/.*\"$1\":([0-9.e+-]+).*/\1/"; }

# Each function prints a cost: seconds per ray, or the seconds of an image times the mean squared error between two seeds.
ours_rays() {
  "$program" inspect rays "$scene" --size 256x256 --estimator bsdf --repetitions 5 --json --quiet "${options[@]}" |
    value median_rays_per_s | awk '{ print 1 / $1 }'
}
theirs_rays() { "$work/peer" "$work/rays" 5 "$mode" | awk '/rays\/s/ { print $1 }' | sort -n | sed -n 3p | awk '{ print 1 / $1 }'; }

ours_mitsuba() {
  local seconds=0
  for half in 0 1; do
    seconds=$("$program" render "$scene" --size 256x256 --spp $spp --filter box --strategy serial --seed $((2 * $1 + half)) \
      --json --quiet -o "$work/ours$half.pfm" "${options[@]}" | value makespan_s)
  done
  cost ours "$seconds"
}
theirs_mitsuba() {
  local seconds=0
  for half in 0 1; do
    seconds=$(MITSUBA_VARIANT=llvm_ad_rgb python3 experiments/peers/mitsuba_ball.py "$triangles" 256 $spp $((100 * (2 * $1 + half))) "$work/theirs$half.pfm" |
      sed -n 's/^seconds = //p')
  done
  cost theirs "$seconds"
}
cost() { "$program" image compare "$work/${1}0.pfm" "$work/${1}1.pfm" --json | value mse | awk -v seconds="$2" '{ print $1 * seconds }'; }

kind=$peer
case $peer in
embree)
  mode=robust kind=rays
  g++ -O3 -march=native experiments/peers/embree.cpp -lembree3 -o "$work/peer"
  ;;
tinybvh)
  [[ " ${options[*]} " == *" f32 "* ]] && mode=f32 || mode=f64
  kind=rays
  g++ -std=c++20 -O3 -march=native -I "${TINYBVH:?the folder of tiny_bvh.h}" experiments/peers/tinybvh.cpp -o "$work/peer"
  ;;
esac
if [[ $kind == rays ]]; then
  "$program" inspect rays "$scene" --size 256x256 --estimator bsdf --repetitions 1 --export "$work/rays" --quiet >/dev/null
fi
for ((pair = 1; pair <= pairs; pair++)); do
  if ((pair % 2)); then a=$("ours_$kind" $pair) b=$("theirs_$kind" $pair); else b=$("theirs_$kind" $pair) a=$("ours_$kind" $pair); fi
  awk -v a="$a" -v b="$b" 'BEGIN { printf "%.3f\n", b / a }'
done | tee "$work/pairs"
sort -n "$work/pairs" | awk -v what="$scene against $peer, ${options[*]:-defaults}" '{ r[NR] = $1 } END {
  m = NR % 2 ? r[(NR + 1) / 2] : (r[NR / 2] + r[NR / 2 + 1]) / 2
  printf "%s: median of %d pairs %.3f (%.3f to %.3f)\n", what, NR, m, r[1], r[NR] }'
