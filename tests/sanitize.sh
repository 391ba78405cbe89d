#!/usr/bin/env bash
# The crates that the acceleration structure uses (its construction, SIMD vectors, memory maps) are the
# only part of a render with `unsafe` code. This script builds and traverses hierarchies under two tools
# that detect reads and writes out of bounds: AddressSanitizer, fast enough for all tests of the hierarchy
# and the geometry, and Miri, which detects all undefined behaviour, for a small hierarchy.
#
#     tests/sanitize.sh [address|miri]
#
# Both need a nightly toolchain; Miri also `rustup component add miri rust-src --toolchain nightly`.
set -euo pipefail
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu

address() {
    # A folder of its own, since no other build can use these objects.
    RUSTFLAGS="-Zsanitizer=address -Ctarget-cpu=native" CARGO_TARGET_DIR=target/sanitize \
        cargo +nightly test --release --target "$target" --lib -- bvh geometry
}

miri() {
    # The thread pool is the source of the leaks, of the integers cast to pointers, and of the list of
    # threads that Stacked Borrows forbids. The hierarchy needs exp2 of whole numbers to be exact, as it is
    # on all known systems; Miri would add a rounding error, since no standard forbids it.
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
