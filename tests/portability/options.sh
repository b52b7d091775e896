#!/usr/bin/env bash
# Prints the options of the renders whose checksums are compared, a line for each. Each scene has each estimator in both precisions; samplers,
# strategies and decompositions take turns. In each of PATHMARK_ROUNDS rounds [default: 1] they begin with the next one. Like checksums.sh and
# compare.sh, it runs on macOS, too, whose Bash is of version 3.2.
#
#   tests/portability/options.sh COMMAND... >OPTIONS
set -euo pipefail
program=("$@")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The names of a kind. Of the scenes, those with few primitives: under emulation a tree takes long to build.
names() {
    "${program[@]}" list "$1" --json | grep -oE '"name":"[^"]*"|"primitives":[0-9]*' | tr -d '"' | awk -F: -v kind="$1" '
        $1 == "name" { name = $2; if (kind != "scenes") print name }
        $1 == "primitives" && $2 <= 5000 { print name }'
}

# The samplers whose numbers do not depend on the threads.
deterministic() {
    local sampler
    names samplers | while read -r sampler; do
        # Not `grep -q`, which would close the pipe early.
        if "${program[@]}" render cornell --size 2x2 --spp 4 --sampler "$sampler" -o "$scratch/image.pfm" 2>/dev/null </dev/null |
            grep 'checksum [0-9a-f]' >/dev/null; then echo "$sampler"; fi
    done
}

scenes=($(names scenes) spheres:300 bumpy-ball:400 spheres:30 bumpy-ball:60 spheres:1000 spheres:3 bumpy-ball:100)
estimators=($(names estimators))
samplers=($(deterministic))
strategies=($(names strategies))
cuts=(rows bands:5 grid:6 tiles:5x4 tiles:3x3:hilbert samples:16:8x8)
for ((round = 0; round < ${PATHMARK_ROUNDS:-1}; round++)); do
    turn=$round
    for scene in "${scenes[@]}"; do
        for estimator in "${estimators[@]}"; do
            for precision in f64 f32; do
                echo "$scene --size 12x9 --spp 4 --threads 3 --estimator $estimator --precision $precision" \
                    "--sampler ${samplers[turn % ${#samplers[@]}]} --strategy ${strategies[turn % ${#strategies[@]}]}" \
                    "--decomposition ${cuts[turn % ${#cuts[@]}]}"
            done
            turn=$((turn + 1))
        done
    done
done
