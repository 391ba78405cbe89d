#!/usr/bin/env bash
# Runs the tests and prints the tables of docs/accuracy.md and docs/stability.md from what they measured.
#
#     docs/prove.sh [--all]
#
# With --all the long tests are run as well, and the tables and charts are written into docs/. This requires
# the packages in docs/requirements.txt.
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
