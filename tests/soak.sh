#!/usr/bin/env bash
# Renders with every method for some seconds each (600 unless told otherwise), with saves, and fails if the memory
# grows: if the largest resident set of the last quarter exceeds that of the second by more than 5%.
#
#     tests/soak.sh [SECONDS]
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-600}
cargo build --release --locked
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
failed=0
for method in path light bdpt pssmlt mmlt; do
    target/release/metrolight render scenes/pool/scene.xml -q --integrator "$method" --time "${seconds}s" \
        --error --save-every 10s -o "$out/$method.exr" --stats "$out/$method.json" 2>/dev/null &
    process=$!
    start=$SECONDS early=0 late=0
    while kill -0 "$process" 2>/dev/null; do
        size=$(awk '/^VmRSS:/ { print $2 }' "/proc/$process/status" 2>/dev/null || echo 0)
        share=$(((SECONDS - start) * 4 / seconds))
        if ((share == 1 && ${size:-0} > early)); then early=$size; fi
        if ((share == 3 && ${size:-0} > late)); then late=$size; fi
        sleep 0.2
    done
    wait "$process"
    verdict=flat
    if ((late * 100 > early * 105)); then
        verdict=grows
        failed=1
    fi
    echo "$method: $early kB in the second quarter, $late kB in the last: $verdict"
done
exit "$failed"
