#!/usr/bin/env bash
# The crates below the acceleration structure (its construction, SIMD vectors, memory maps) are the only
# part of a render with `unsafe` code. This builds and traverses hierarchies under AddressSanitizer, which
# finds accesses out of bounds and is fast enough for all tests of the geometry, and under Miri, which
# finds all undefined behaviour, for a small hierarchy.
#
#     tests/sanitize.sh [address|miri]
#
# Both need a nightly toolchain; Miri also `rustup component add miri rust-src --toolchain nightly`.
set -euo pipefail
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu

address() {
    # A target directory of its own: other builds cannot use these objects.
    RUSTFLAGS="-Zsanitizer=address -Ctarget-cpu=native" CARGO_TARGET_DIR=target/sanitize \
        cargo +nightly test --release --target "$target" --lib geometry
}

miri() {
    # The thread pool leaks, casts integers to pointers, and has a thread list that Stacked Borrows forbids.
    # The hierarchy needs exp2 of integers to be exact, as it is on all known systems; Miri would add a
    # rounding error, since no standard guarantees it.
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
