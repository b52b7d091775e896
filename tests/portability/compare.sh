#!/usr/bin/env bash
# Compares files of checksums with the first, and prints a row for each and each precision. If anything differs, prints it and ends with code 1.
#
#   tests/portability/compare.sh FOLDER/LEVEL OTHER/LEVEL...
set -euo pipefail
expected=$1
shift
code=0
echo "| processor, instruction set | precision | checksums compared | different |"
echo "|--|--|--|--|"
for found in "$@"; do
    [ ! "$found" -ef "$expected" ] || continue
    # A render that both refuse has no checksum. Files of other renders have other options.
    paste -d '|' "$expected" "$found" | awk -F'|' -v who="$(basename "$(dirname "$found")"), $(basename "$found")" '
        $1 != $3 { wrong++; print who ": " $3 ": expected " $1 >"/dev/stderr"; next }
        $2 !~ /^checksum/ && $2 == $4 { next }
        # A device has no program for it.
        $4 == "another kernel" { next }
        { precision = $1 ~ /--precision f32/ ? "f32" : "f64"; compared[precision]++ }
        $2 != $4 { wrong++; differ[precision]++; print who ": " $1 ": " $4 ", not " $2 >"/dev/stderr" }
        END {
            printf "| %s | f64 | %d | %d |\n", who, compared["f64"], differ["f64"]
            printf "| %s | f32 | %d | %d |\n", who, compared["f32"], differ["f32"]
            exit (wrong || !compared["f64"] || !compared["f32"])
        }' || code=1
done
exit "$code"
