#!/usr/bin/env bash
# The crates under the acceleration structure (its construction, vectors of numbers, memory maps) are the
# only part of a render with `unsafe` code. This builds and traverses hierarchies under tools that see a
# read or write out of bounds: AddressSanitizer, fast
# enough for all tests of the geometry, and Miri, which sees all undefined behaviour, for a small one.
#
#     tests/sanitize.sh [address|miri]
#
# Both need a nightly toolchain; Miri also `rustup component add miri rust-src --toolchain nightly`.
set -euo pipefail
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu

address() {
    # A folder of its own: these objects are of no use to anything else.
    RUSTFLAGS="-Zsanitizer=address -Ctarget-cpu=native" CARGO_TARGET_DIR=target/sanitize \
        cargo +nightly test --release --target "$target" --lib geometry
}

miri() {
    # Leaks, integers cast to pointers and the list of threads that Stacked Borrows forbids are the thread
    # pool's. The hierarchy needs exp2 of whole numbers to be exact, as it is on all known systems; Miri
    # would make it off by a rounding, since no standard says so.
    MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-ignore-leaks -Zmiri-permissive-provenance \
        -Zmiri-tree-borrows -Zmiri-deterministic-floats" \
        RAYON_NUM_THREADS=1 RUSTFLAGS="" CARGO_TARGET_DIR=target/sanitize \
        cargo +nightly miri test --target "$target" --lib small_hierarchies
}

case "${1:-all}" in
    address) address ;;
    miri) miri ;;
    all) address && miri ;;
    *) echo "usage: tests/sanitize.sh [address|miri]" >&2 && exit 2 ;;
esac
