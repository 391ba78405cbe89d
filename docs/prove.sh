#!/usr/bin/env bash
# Runs the tests and prints what they measured, as the tables of docs/accuracy.md and docs/stability.md.
#
#     docs/prove.sh [--all]
#
# With --all also the long tests; then tables and charts are written into docs/, which needs the
# packages in docs/requirements.txt.
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
    "" | --all) ;;
    *) echo "usage: docs/prove.sh [--all]" >&2 && exit 2 ;;
esac

export METROLIGHT_FIGURES="$PWD/target/figures"
rm -rf "$METROLIGHT_FIGURES"
cargo test --release --locked
if [ "${1:-}" = --all ]; then
    cargo test --release --locked -- --ignored
    python3 docs/make_figures.py --write
else
    python3 docs/make_figures.py
fi
