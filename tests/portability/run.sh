#!/usr/bin/env bash
# Compares the images of another kind of processor, which is emulated, with those of this machine, checksum by checksum. Then it runs tests under
# emulation. Needs Debian, root and some 4 GB of disk. An emulator's times mean nothing, so none are printed.
#
#   tests/portability/run.sh aarch64       64-bit ARM: the instruction sets neon and baseline
#   tests/portability/run.sh riscv64
#   tests/portability/run.sh s390x         big-endian
#   tests/portability/run.sh devices       this machine's devices, without an emulator: only images
#
# PATHMARK_PORTABILITY is the folder of the emulator, of the compilers and of what they make [default: ~/.cache/pathmark-portability]. The first run
# installs a small Debian there, whose compiler has Rust's library for many processors. PATHMARK_PARTS names what to do, some of
# "images files units paths contract cases" [default: all]; the last four are tests under emulation. Each emulated program may take PATHMARK_LIMIT
# seconds [default: 600], and a program of tests three times as many; one that takes longer is named. PATHMARK_CASES names the hard cases and their
# order [default: all]. target/portability keeps the checksums and what has passed, so an interrupted run continues. Each verdict is printed at once.
set -euo pipefail
cd "$(dirname "$0")/../.."
fail() { printf '%s\n' "$1" >&2; exit "$2"; }

known="images files units paths contract cases"
case "${1:-}" in
    aarch64) debian=arm64 target=aarch64-unknown-linux-gnu tools=aarch64-linux-gnu ;;
    riscv64) debian=riscv64 target=riscv64gc-unknown-linux-gnu tools=riscv64-linux-gnu ;;
    s390x) debian=s390x target=s390x-unknown-linux-gnu tools=s390x-linux-gnu ;;
    devices) known=images ;;
    *) fail "architecture = ${1:-}: is not one of aarch64, riscv64, s390x, devices" 2 ;;
esac
architecture=$1
base=${PATHMARK_PORTABILITY:-$HOME/.cache/pathmark-portability}
root=$base/root
repository=$PWD
kept=$repository/target/portability
downloads=${CARGO_HOME:-$HOME/.cargo}/registry
limit=${PATHMARK_LIMIT:-600}
parts=${PATHMARK_PARTS:-$known}
for part in $parts; do
    [[ " $known " == *" $part "* ]] || fail "PATHMARK_PARTS = $part: is not one of $known" 2
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
        CARGO_TARGET_DIR=/target "${variable}_LINKER=$tools-gcc" "${variable}_RUNNER=${emulator[*]}" \
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
        within apt-get install -y --no-install-recommends rustc cargo git qemu-user gcc libc6-dev "gcc-$tools" "libc6-dev-$debian-cross"
        # Rust's library is only unpacked. An installed one needs LLVM for both processors in the same version, which sid lacks at times.
        within bash -euo pipefail -c '
            cd "$(mktemp -d)"
            apt-get download "libstd-rust-dev:$0=$(dpkg-query --show --showformat "\${Version}" rustc)"
            dpkg --extract libstd-rust-dev_*.deb /
        ' "$debian"
        touch "$base/installed-$debian"
    fi
    within git config --global --replace-all safe.directory "$repository"
    cargo fetch --locked
}

here() { target/debug/pathmark "$@"; }
there() { within "${emulated[@]}" "$@"; }
checksum() { "$@" 2>/dev/null | grep -o 'checksum [0-9a-f]\{16,\}' || echo "no checksum"; }
# The files that it writes are compared, and a missing file is a difference.
quietly() { "$@" >/dev/null 2>&1 || true; }
digest() { if [ -e "$1" ]; then sha256sum <"$1"; else echo "no file"; fi; }
# The folder of what a program with this compiler has printed. It belongs to the sources: the program itself also differs with each commit.
folder() {
    local key
    key=$( (echo "$1" && find src crates experiments tests/support Cargo.toml Cargo.lock build.rs -type f -print0 | LC_ALL=C sort -z | xargs -0 sha256sum) | sha256sum)
    echo "$kept/${key:0:12}/$2"
}

images() {
    local mine theirs rounds=1
    # A device has no program for half of the renders.
    [ "$architecture" != devices ] || rounds=3
    mine=$(folder "$compiled_here" "$(uname -m)-$rounds")
    if [ "$architecture" = devices ]; then theirs=$mine-devices; else theirs=$(folder "$compiled_there" "$architecture"); fi
    mkdir -p "$mine" "$theirs"
    # Named only when it is whole, because a run may be interrupted.
    if [ ! -e "$mine.options" ]; then
        PATHMARK_ROUNDS=$rounds bash tests/portability/options.sh target/debug/pathmark >"$work/options"
        mv "$work/options" "$mine.options"
    fi
    bash tests/portability/checksums.sh simd "$mine.options" "$mine" target/debug/pathmark
    if [ "$architecture" = devices ]; then
        bash tests/portability/checksums.sh devices "$mine.options" "$theirs" target/debug/pathmark
    else
        within bash tests/portability/checksums.sh simd "$mine.options" "$theirs" "${emulated[@]}"
    fi
    bash tests/portability/compare.sh "$mine/baseline" "$mine"/* "$theirs"/* || echo "images differ" >>"$work/differences"
}

told() {
    if [ "$2" = "$3" ] && [[ $2 != no\ * ]]; then echo "| $1 | the same |"; else echo "| $1 | DIFFERENT |" | tee -a "$work/differences"; fi
}

# Files that one of both programs writes and the other reads: pictures, meshes, parts of an image, and checkpoints.
files() {
    local kind order whole
    printf '| file | here and there |\n|--|--|\n'
    for kind in pfm hdr exr png ppm bmp; do
        quietly here render cornell --kernel scalar --size 24x18 --spp 4 -o "$work/here.$kind"
        quietly there render cornell --kernel scalar --size 24x18 --spp 4 -o "$work/there.$kind"
        told "picture .$kind, written" "$(digest "$work/here.$kind")" "$(digest "$work/there.$kind")"
        quietly here image convert "$work/here.$kind" -o "$work/here-$kind.pfm"
        quietly there image convert "$work/here.$kind" -o "$work/there-$kind.pfm"
        told "picture .$kind, read" "$(digest "$work/here-$kind.pfm")" "$(digest "$work/there-$kind.pfm")"
    done
    for order in little big; do
        cp "tests/fuzz/corpus/ply/$order.ply" "$work/square.ply"
        printf '%s\n' 'about = "a square"' 'background = [0.1, 0.2, 0.3]' '[camera.pinhole]' 'position = [0.3, 0.2, -3.0]' 'look-at = [0.0, 0.0, 0.0]' \
            'field-of-view = 60.0' '[[objects]]' 'name = "square"' 'shape = { mesh = { file = "square.ply" } }' \
            'material = { diffuse = { albedo = [0.7, 0.6, 0.5] } }' >"$work/square.toml"
        set -- "$work/square.toml" --size 24x18 --spp 4
        told "mesh .ply, $order-endian, read" "$(checksum here render "$@" -o "$work/1.pfm")" "$(checksum there render "$@" -o "$work/2.pfm")"
    done
    set -- cornell --size 24x18 --spp 32
    whole=$(checksum here render "$@" -o "$work/whole.pfm")
    quietly here render "$@" --shard 1/2 -o "$work/1.film"
    quietly there render "$@" --shard 2/2 -o "$work/2.film"
    told "parts of both, merged here" "$(checksum here merge "$work/1.film" "$work/2.film" -o "$work/1.pfm")" "$whole"
    told "parts of both, merged there" "$(checksum there merge "$work/1.film" "$work/2.film" -o "$work/2.pfm")" "$whole"
    quietly here render cornell --size 24x18 --spp 16 --checkpoint "$work/ours" -o "$work/half.pfm"
    quietly there render cornell --size 24x18 --spp 16 --checkpoint "$work/theirs" -o "$work/half.pfm"
    told "checkpoint of there, resumed here" "$(checksum here render "$@" --checkpoint "$work/theirs" -o "$work/3.pfm")" "$whole"
    told "checkpoint of here, resumed there" "$(checksum there render "$@" --checkpoint "$work/ours" -o "$work/4.pfm")" "$whole"
}

# Tries a verb of the emulated program with each name, and prints a row for each. What has passed in an earlier run is not tried again.
verdicts() {
    local verb=$1 rows name code
    rows=$(folder "$compiled_there" "$architecture-$1")
    shift
    mkdir -p "$(dirname "$rows")"
    touch "$rows"
    sed -i '/ passed |$/!d' "$rows"
    printf '| %s | result |\n|--|--|\n' "$verb"
    cat "$rows"
    for name; do
        ! grep -qF "| $verb $name |" "$rows" || continue
        code=0
        there "$verb" "$name" >"$work/said" 2>&1 </dev/null || code=$?
        case $code in
            0) echo "| $verb $name | passed |" ;;
            124 | 137) echo "| $verb $name | NOT ENDED after $limit s |" ;;
            *) echo "| $verb $name | FAILED with code $code |" && cat "$work/said" >&2 ;;
        esac | tee -a "$rows"
    done
    grep -v 'passed |$' "$rows" >>"$work/differences" || true
}

# Runs tests of three crates: those that have not passed in an earlier run. All three are named each time, or Cargo would compile their libraries again
# with other features. A name of two tests is always tried.
tested() {
    local kind=$1 log count name
    local -a words names=() command
    read -ra words <<<"$kind"
    command=(within cargo test --no-fail-fast --locked --offline --target "$target" -p pathmark-tracer -p pathmark-strategy -p pathmark-lanes "${words[@]}")
    # A test program has many tests.
    local emulator=(timeout --foreground --kill-after=10 $((3 * limit)) "${emulator[@]:4}")
    log=$(folder "$compiled_there" "$architecture-tests")
    mkdir -p "$(dirname "$log")"
    touch "$log"
    "${command[@]}" -- --list "${@:2}" >"$work/list" || return
    while read -r count name; do
        [ "$count" = 1 ] && grep -qxF -e "$kind: test $name ... ok" "$log" || names+=("$name")
    done < <(sed -n 's/: test$//p' "$work/list" | sort | uniq -c)
    printf "%s\n" "$kind: ${#names[@]} of $(grep -c ': test$' "$work/list") tests have not passed yet"
    [ ${#names[@]} = 0 ] || "${command[@]}" -- --exact "${names[@]}" </dev/null 2>&1 | sed -u "s/^test /$kind: &/" | tee -a "$log"
}
units() { tested --lib; }
# Of the equilibrium of scenes one test in three: the others take longest.
paths() { tested '--test paths' && tested '--test equilibrium' long_paths; }
# Strategies one by one, so that the one that hangs has a name.
contract() {
    verdicts contract $(here list strategies --json | grep -o '"name":"[^"]*"' | cut -d '"' -f 4) \
        dynamic:7 mfac:50 steal-one:richest steal-half:neighbour weighted-factoring:1:0.5
    tested '--test strategy_contract' refusals::
}
# All cases by name, which the message about a wrong name lists. Without names, the price list of the guards would be timed, too.
cases() { verdicts selftest ${PATHMARK_CASES:-$( (here selftest none 2>&1 || true) | grep -oE '\b[A-Z][0-9]+\b')}; }

emulator=(timeout --foreground --kill-after=10 "$limit" "qemu-$architecture" -L "/usr/${tools:-}")
emulated=("${emulator[@]}" "/target/${target:-}/debug/pathmark")
cargo build --locked
mkdir -p "$kept"
work=$(mktemp -d "$kept/work-XXXXXX")
trap 'rm -rf "$work"' EXIT
touch "$work/differences"
compiled_here="$(rustc --version) here"
compiled_there=
if [ "$architecture" != devices ]; then
    prepare
    within cargo build --locked --offline --target "$target"
    compiled_there="$(within rustc --version) and $(within "qemu-$architecture" --version | head -n 1) there"
fi
echo "$architecture, $(date -u +%F), commit $(git rev-parse --short=12 HEAD), $compiled_here${compiled_there:+, $compiled_there}"
for part in $parts; do
    printf '\n%s\n' "$part"
    # In a condition, Bash would go on after an error within the part.
    set +e
    (set -e; "$part")
    code=$?
    set -e
    [ "$code" = 0 ] || echo "$part: code $code" | tee -a "$work/differences"
done
if [ -s "$work/differences" ]; then
    printf '\ndifferent, failed or not ended:\n'
    cat "$work/differences"
    exit 1
fi
