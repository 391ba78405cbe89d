#!/usr/bin/env bash
# Fuzzes one target, or all in turn, for some seconds each (600 unless told otherwise).
#
#     tests/fuzz/run.sh [TARGET|all] [SECONDS]
#
# What is found stands in tests/fuzz/artifacts/TARGET, new inputs in tests/fuzz/work/TARGET.
set -euo pipefail
cd "$(dirname "$0")/../.."
export RAYON_NUM_THREADS=1

fuzz() {
    local target=$1 dictionary=tests/fuzz/dictionaries/$1.dict options=()
    [[ -f $dictionary ]] && options+=("-dict=$dictionary")
    mkdir -p "tests/fuzz/work/$target"
    cargo +nightly fuzz run --fuzz-dir tests/fuzz "$target" \
        "tests/fuzz/work/$target" "tests/fuzz/corpus/$target" -- "${options[@]}" \
        -max_len=8192 -timeout=120 -rss_limit_mb=3072 -max_total_time="$seconds"
}

seconds=${2:-600}
case "${1:-all}" in
    all) for target in scene obj ply serialized image exr reference records; do fuzz "$target"; done ;;
    *) fuzz "$1" ;;
esac
