#!/usr/bin/env bash
# Renders each line of OPTIONS with each instruction set of the processor, or on each device. FOLDER gets a sorted file for each of them, with a line
# for each render: the options, and the checksum or the exit status, or "another kernel" if the device has no program for it. If a run is interrupted,
# the next one continues it.
#
#   tests/portability/checksums.sh simd OPTIONS FOLDER COMMAND...
#   tests/portability/checksums.sh devices OPTIONS FOLDER COMMAND...
set -euo pipefail
kind=$1 options=$2 folder=$3
shift 3
program=("$@")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$folder"
processors=$(getconf _NPROCESSORS_ONLN)

# The device `host` calls a C compiler.
export PATHMARK_COMPILER=${CC:-cc} PATHMARK_COMPILED=$scratch
CC=$(cd "$(dirname "$0")" && pwd)/compiler.sh
export CC

# The options of a render with this instruction set, or on this device. A driver takes seconds to compile a program: the one with all effects serves
# every scene.
with() {
    if [ "$kind" = simd ]; then echo "--simd $1"; else echo "--kernel device:$1 --effects all"; fi
}

# Renders this worker's lines, except those that an earlier run has rendered.
share() {
    local name=$1 worker=$2 to=$3 line code said found
    local -a words
    touch "$to"
    awk -v all="$processors" -v own="$worker" 'NR % all == own' "$options" | tail -n "+$(($(wc -l <"$to") + 1))" |
        while IFS= read -r line; do
            read -ra words <<<"$line $(with "$name")"
            code=0
            said=$("${program[@]}" render "${words[@]}" -o "$scratch/$worker.pfm" 2>/dev/null </dev/null) || code=$?
            found=$(grep -o 'checksum [0-9a-f]\{16,\}' <<<"$said") || found="exit $code"
            # A device says how often it was launched.
            [ "$kind" = simd ] || [ "$code" != 0 ] || grep -q "^$name: compiled" <<<"$said" || found="another kernel"
            printf '%s|%s\n' "$line" "$found"
        done >>"$to"
}

for name in $("${program[@]}" list "$kind" --json | grep -o '"name":"[^"]*"' | cut -d '"' -f 4); do
    # The list has instruction sets and devices that this machine lacks.
    read -ra words <<<"$(with "$name")"
    [ ! -e "$folder/$name" ] && "${program[@]}" render cornell --size 4x3 --spp 4 "${words[@]}" -o "$scratch/image.pfm" >/dev/null 2>&1 || continue
    parts=()
    for ((worker = 0; worker < processors; worker++)); do
        parts+=("$folder/.$name-$worker-of-$processors")
        share "$name" "$worker" "${parts[worker]}" &
    done
    wait
    LC_ALL=C sort "${parts[@]}" >"$scratch/all"
    # A worker that failed has rendered too few.
    [ "$(wc -l <"$scratch/all")" -eq "$(wc -l <"$options")" ] || { echo "$folder/$name: too few renders" >&2; exit 1; }
    mv "$scratch/all" "$folder/$name"
    rm "${parts[@]}"
done
