#!/usr/bin/env bash
# Renders each line of OPTIONS with each instruction set of the processor. FOLDER gets a sorted file for each set, with a line for each render: the
# options, and the checksum or the exit status. If a run is interrupted, the next one continues it.
#
#   tests/portability/checksums.sh OPTIONS FOLDER COMMAND...
set -euo pipefail
options=$1 folder=$2
shift 2
program=("$@")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$folder"
processors=$(getconf _NPROCESSORS_ONLN)

# Renders this worker's lines, except those that an earlier run has rendered.
share() {
    local level=$1 worker=$2 to=$3 line code said found
    local -a words
    touch "$to"
    awk -v all="$processors" -v own="$worker" 'NR % all == own' "$options" | tail -n "+$(($(wc -l <"$to") + 1))" |
        while IFS= read -r line; do
            read -ra words <<<"$line"
            code=0
            said=$("${program[@]}" render "${words[@]}" --simd "$level" -o "$scratch/$worker.pfm" 2>/dev/null </dev/null) || code=$?
            found=$(grep -o 'checksum [0-9a-f]\{16,\}' <<<"$said") || found="exit $code"
            printf '%s|%s\n' "$line" "$found"
        done >>"$to"
}

for level in $("${program[@]}" list simd --json | grep -o '"name":"[^"]*"' | cut -d '"' -f 4); do
    # The list has instruction sets that this processor lacks.
    [ ! -e "$folder/$level" ] && "${program[@]}" render cornell --size 4x3 --spp 4 --simd "$level" -o "$scratch/image.pfm" >/dev/null 2>&1 || continue
    parts=()
    for ((worker = 0; worker < processors; worker++)); do
        parts+=("$folder/.$level-$worker-of-$processors")
        share "$level" "$worker" "${parts[worker]}" &
    done
    wait
    LC_ALL=C sort "${parts[@]}" >"$scratch/all"
    # A worker that failed has rendered too few.
    [ "$(wc -l <"$scratch/all")" -eq "$(wc -l <"$options")" ] || { echo "$folder/$level: too few renders" >&2; exit 1; }
    mv "$scratch/all" "$folder/$level"
    rm "${parts[@]}"
done
