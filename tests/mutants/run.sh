#!/usr/bin/env bash
# Applies named faults one by one to a scratch copy of what is committed, and prints what notices each.
#
#   tests/mutants/run.sh            all of them: hours
#   tests/mutants/run.sh roots ties those whose names contain one of the words
#
# A fault is a patch whose first line says who is expected to notice:
#   # killed by: check S29 S30              cases of `pathmark check`
#   # killed by: test faults kills::a_sweep a test binary, and a filter if there is one
# A fault that those miss is a survivor; so is one that no longer applies or compiles, which is told apart.
set -uo pipefail
cd "$(dirname "$0")/../.."
patches=$(pwd)/tests/mutants
target=$(pwd)/target/mutants
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
git clone --quiet --shared . "$scratch/copy"
cd "$scratch/copy"
# Compiling takes longer than the cases: less optimisation, and only what a fault changes.
export CARGO_TARGET_DIR=$target CARGO_INCREMENTAL=1 CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=false

killed=0 survived=0 broken=0
for patch in "$patches"/*.patch; do
    name=$(basename "$patch" .patch)
    if [ $# -gt 0 ]; then
        wanted=no
        for word in "$@"; do [[ $name == *"$word"* ]] && wanted=yes; done
        [ $wanted = yes ] || continue
    fi
    read -r -a rule <<<"$(sed -n '1s/^# killed by: //p' "$patch")"
    git checkout --quiet -- . && git clean --quiet -fd
    if ! git apply "$patch" 2>/dev/null; then
        echo "$name: does not apply"
        broken=$((broken + 1))
        continue
    fi
    case ${rule[0]:-} in
    check)
        build=(cargo build --quiet --bin pathmark)
        try=(timeout 600 "$target/debug/pathmark" check "${rule[@]:1}" --quiet)
        ;;
    test)
        build=(cargo test --quiet --no-run --test "${rule[1]}")
        try=(timeout 600 cargo test --quiet --test "${rule[1]}" -- "${rule[@]:2}")
        ;;
    lib)
        build=(cargo test --quiet --no-run --lib)
        try=(timeout 600 cargo test --quiet --lib -- "${rule[@]:1}")
        ;;
    *)
        echo "$name: says not who notices"
        broken=$((broken + 1))
        continue
        ;;
    esac
    if ! "${build[@]}" >"$scratch/build" 2>&1; then
        echo "$name: does not compile: $(grep -m1 '^error' "$scratch/build")"
        broken=$((broken + 1))
    elif "${try[@]}" >"$scratch/out" 2>&1; then
        echo "$name: SURVIVED ${rule[*]}"
        survived=$((survived + 1))
    else
        noticed=$(grep -oE '^  [A-Z][0-9]+ +FAIL|^test .* FAILED$|^    [a-z_:]+$' "$scratch/out" | sed 's/FAIL$//; s/^test //; s/ \.\.\. FAILED//' | tr -s ' \n' ' ')
        echo "$name: killed by ${noticed:-its time limit or a crash}"
        killed=$((killed + 1))
    fi
done
echo "$killed killed, $survived survived, $broken not tried"
[ "$survived" -eq 0 ] && [ "$broken" -eq 0 ]
