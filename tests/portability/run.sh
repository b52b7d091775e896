#!/usr/bin/env bash
# Compares the images of another kind of processor, which is emulated, with those of this machine, checksum by checksum. Then it runs tests under
# emulation. Needs Debian, root and some 4 GB of disk. An emulator's times mean nothing, so none are printed.
#
#   tests/portability/run.sh aarch64       64-bit ARM: the instruction sets neon and baseline
#   tests/portability/run.sh riscv64
#   tests/portability/run.sh s390x         big-endian
#
# PATHMARK_PORTABILITY is the folder of the emulator, of the compilers and of what they make [default: ~/.cache/pathmark-portability]. The first run
# installs a small Debian there, whose compiler has Rust's library for many processors. PATHMARK_PARTS names what to do, some of
# "images files tests" [default: all].
set -euo pipefail
cd "$(dirname "$0")/../.."
fail() { printf '%s\n' "$1" >&2; exit "$2"; }

case "${1:-}" in
    aarch64) debian=arm64 target=aarch64-unknown-linux-gnu tools=aarch64-linux-gnu ;;
    riscv64) debian=riscv64 target=riscv64gc-unknown-linux-gnu tools=riscv64-linux-gnu ;;
    s390x) debian=s390x target=s390x-unknown-linux-gnu tools=s390x-linux-gnu ;;
    *) fail "architecture = ${1:-}: is not one of aarch64, riscv64, s390x" 2 ;;
esac
architecture=$1
base=${PATHMARK_PORTABILITY:-$HOME/.cache/pathmark-portability}
root=$base/root
repository=$PWD
downloads=${CARGO_HOME:-$HOME/.cargo}/registry
parts=${PATHMARK_PARTS:-images files tests}
for part in $parts; do
    [[ $part =~ ^(images|files|tests)$ ]] || fail "PATHMARK_PARTS = $part: is not one of images, files, tests" 2
done

# Runs a command in the root, where the repository has its usual place. The mounts end with the command.
within() {
    local variable
    variable=CARGO_TARGET_$(tr 'a-z-' 'A-Z_' <<<"$target")
    unshare --mount --propagation private bash -euo pipefail -c '
        root=$1 repository=$2 downloads=$3
        shift 3
        mkdir -p "$root$repository" "$root/root/.cargo/registry"
        mount --bind "$repository" "$root$repository"
        mount --bind "$downloads" "$root/root/.cargo/registry"
        mount --bind /etc/resolv.conf "$root/etc/resolv.conf"
        mount -t proc proc "$root/proc"
        mount --rbind /dev "$root/dev"
        exec chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 "$@"
    ' within "$root" "$repository" "$downloads" \
        CARGO_TARGET_DIR=/target "${variable}_LINKER=$tools-gcc" "${variable}_RUNNER=qemu-$architecture -L /usr/$tools" \
        bash -euo pipefail -c 'cd "$0" && exec "$@"' "$repository" "$@"
}

prepare() {
    [ "$(id -u)" = 0 ] || fail "only root can install the emulator's system" 3
    mkdir -p "$base"
    if [ ! -e "$base/installed" ]; then
        command -v debootstrap >/dev/null || apt-get install -y --no-install-recommends debootstrap
        rm -rf "$root"
        # The mirror that this machine's apt uses, and apt's settings.
        debootstrap --variant=minbase --include=ca-certificates sid "$root" \
            "$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1)"
        cp -r /etc/apt/apt.conf.d/. "$root/etc/apt/apt.conf.d/"
        touch "$root/etc/resolv.conf" "$base/installed"
    fi
    if [ ! -e "$base/installed-$debian" ]; then
        within dpkg --add-architecture "$debian"
        within apt-get update
        within apt-get install -y --no-install-recommends rustc cargo git qemu-user gcc libc6-dev \
            "libstd-rust-dev:$debian" "gcc-$tools" "libc6-dev-$debian-cross"
        touch "$base/installed-$debian"
    fi
    within git config --global --replace-all safe.directory "$repository"
    cargo fetch --locked
}

here() { target/debug/pathmark "$@"; }
there() { within "${emulated[@]}" "$@"; }
checksum() { "$@" 2>/dev/null | grep -o 'checksum [0-9a-f]\{16,\}' || echo "no checksum"; }

# The names of a kind. Of the scenes, those with few primitives: under emulation a tree takes long to build.
names() {
    here list "$1" --json | grep -o '"name":"[^"]*"\|"primitives":[0-9]*' | tr -d '"' | awk -F: -v kind="$1" '
        $1 == "name" { name = $2; if (kind != "scenes") print name }
        $1 == "primitives" && $2 <= 5000 { print name }'
}

# The options of all renders. Each scene has each estimator in both precisions; samplers, strategies and decompositions take turns.
options() {
    local scene estimator precision turn=0
    local -a scenes estimators samplers strategies cuts
    mapfile -t scenes < <(names scenes)
    mapfile -t estimators < <(names estimators)
    # The numbers of the others depend on the threads.
    mapfile -t samplers < <(names samplers | while read -r sampler; do
        [ "$(checksum here render cornell --size 2x2 --spp 4 --sampler "$sampler" -o "$work/image.pfm")" = "no checksum" ] || echo "$sampler"
    done)
    mapfile -t strategies < <(names strategies)
    cuts=(rows bands:5 grid:6 tiles:5x4 tiles:3x3:hilbert samples:16:8x8)
    for scene in "${scenes[@]}" spheres:300 bumpy-ball:400; do
        for estimator in "${estimators[@]}"; do
            for precision in f64 f32; do
                echo "$scene --size 12x9 --spp 4 --threads 3 --estimator $estimator --precision $precision" \
                    "--sampler ${samplers[turn % ${#samplers[@]}]} --strategy ${strategies[turn % ${#strategies[@]}]}" \
                    "--decomposition ${cuts[turn % ${#cuts[@]}]}"
            done
            turn=$((turn + 1))
        done
    done
}

# Compares the checksums in a file with the expected ones, and prints a row for each precision. A render that both refuse has no checksum.
compare() {
    paste -d '|' "$work/options" "$work/expected" "$work/found" | awk -F'|' -v who="$1" -v differences="$work/differences" '
        $2 !~ /^checksum/ && $2 == $3 { next }
        { precision = $1 ~ /--precision f32/ ? "f32" : "f64"; compared[precision]++ }
        $2 != $3 { differ[precision]++; print who ": " $1 ": " $3 ", not " $2 >>differences }
        END { for (p in compared) printf "| %s | %s | %d | %d |\n", who, p, compared[p], differ[p] }' | sort -r
}

images() {
    local level
    options >"$work/options"
    printf '\n| processor, instruction set | precision | checksums compared | different |\n|--|--|--|--|\n'
    for level in $(names simd); do
        here render cornell --size 4x3 --spp 4 --simd "$level" -o "$work/image.pfm" >/dev/null 2>&1 || continue
        bash tests/portability/checksums.sh "$level" target/debug/pathmark <"$work/options" >"$work/found"
        # This machine's fastest instruction set comes first and gives what the others are compared with.
        [ -e "$work/expected" ] || cp "$work/found" "$work/expected"
        compare "this machine, $level"
    done
    for level in $(there list simd --json | grep -o '"name":"[^"]*"' | cut -d '"' -f 4); do
        within bash tests/portability/checksums.sh "$level" "${emulated[@]}" <"$work/options" >"$work/found"
        compare "$architecture, $level"
    done
}

told() {
    if [ "$2" = "$3" ] && [ "$2" != "no checksum" ]; then echo "| $1 | the same |"; else echo "| $1 | DIFFERENT |" | tee -a "$work/differences"; fi
}

# Files that one of both programs writes and the other reads: pictures, parts of an image, and a checkpoint.
files() {
    local kind whole
    printf '\n| file | here and there |\n|--|--|\n'
    for kind in pfm hdr exr png ppm bmp; do
        here render cornell --kernel scalar --size 24x18 --spp 4 -o "$work/here.$kind" >/dev/null 2>&1
        there render cornell --kernel scalar --size 24x18 --spp 4 -o "$work/there.$kind" >/dev/null 2>&1
        told "picture .$kind" "$(sha256sum <"$work/here.$kind")" "$(sha256sum <"$work/there.$kind")"
    done
    set -- cornell --size 24x18 --spp 32
    whole=$(checksum here render "$@" -o "$work/whole.pfm")
    here render "$@" --shard 1/2 -o "$work/1.film" >/dev/null 2>&1
    there render "$@" --shard 2/2 -o "$work/2.film" >/dev/null 2>&1
    told "parts of both, merged here" "$(checksum here merge "$work/1.film" "$work/2.film" -o "$work/1.pfm")" "$whole"
    told "parts of both, merged there" "$(checksum there merge "$work/1.film" "$work/2.film" -o "$work/2.pfm")" "$whole"
    there render cornell --size 24x18 --spp 16 --checkpoint "$work/checkpoint" -o "$work/half.pfm" >/dev/null 2>&1
    told "checkpoint of there, resumed here" "$(checksum here render "$@" --checkpoint "$work/checkpoint" -o "$work/3.pfm")" "$whole"
}

tests() {
    printf '\nTests under emulation\n'
    within cargo test --quiet --locked --offline --target "$target" -p pathmark-tracer -p pathmark-strategy -p pathmark-lanes \
        --lib --test equilibrium --test strategy_contract --test paths
    # By letters: without them, the price list of the guards would be timed, too.
    there selftest S T H P R M A
}

emulated=("qemu-$architecture" -L "/usr/$tools" "/target/$target/debug/pathmark")
prepare
cargo build --locked
within cargo build --locked --offline --target "$target"
work=$(mktemp -d "$repository/target/portability-XXXXXX")
trap 'rm -rf "$work"' EXIT
touch "$work/differences"
echo "$architecture, $(date -u +%F), commit $(git rev-parse --short=12 HEAD), $(rustc --version) here, $(within rustc --version) there"
for part in $parts; do
    "$part"
done
if [ -s "$work/differences" ]; then
    cat "$work/differences"
    exit 1
fi
