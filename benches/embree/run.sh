#!/usr/bin/env bash
# Rays per second of Metrolight and of Embree 3 for the same triangles and the same rays, on one thread in one run.
#
#     benches/embree/run.sh
#
# Requires Embree 3 with its headers (Debian: apt-get install libembree-dev) and a C++ compiler. On a machine with other
# load, restrict it to one core: `taskset -c 1 benches/embree/run.sh`.
set -euo pipefail
cd "$(dirname "$0")/../.."
mkdir -p target/embree
g++ -std=c++17 -O3 -march=native benches/embree/rays.cpp -lembree3 -o target/embree/rays
cargo bench --bench embree -- target/embree/rays
