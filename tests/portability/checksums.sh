#!/usr/bin/env bash
# Renders each line of its input, which holds the options of `render`, with an instruction set. Prints one line for each: the checksum, or the
# exit status.
#
#   tests/portability/checksums.sh LEVEL COMMAND... <options >checksums
set -euo pipefail
level=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
while read -ra options; do
    code=0
    said=$("$@" render "${options[@]}" --simd "$level" -o "$folder/image.pfm" 2>/dev/null </dev/null) || code=$?
    found=$(grep -o 'checksum [0-9a-f]\{16,\}' <<<"$said") || found="exit $code"
    printf '%s\n' "$found"
done
