#!/usr/bin/env bash
# The C compiler of the device `host`, for many renders: programs that it has compiled it keeps in the folder PATHMARK_COMPILED, because a program for
# all effects takes seconds, and hundreds of renders share a few of them. PATHMARK_COMPILER is the compiler itself.
set -euo pipefail
library='' source=''
for ((word = 1; word < $#; word++)); do
    next=$((word + 1))
    [ "${!word}" != -o ] || library=${!next}
    [[ ${!next} != *.c ]] || source=${!next}
done
[ -n "$source" ] || exec "$PATHMARK_COMPILER" "$@"
known=$PATHMARK_COMPILED/$(sha256sum <"$source" | cut -c 1-32).so
if [ ! -e "$known" ]; then
    "$PATHMARK_COMPILER" "$@"
    # Another worker may read or write it now.
    cp "$library" "$known.$$"
    mv "$known.$$" "$known"
else
    cp "$known" "$library"
fi
