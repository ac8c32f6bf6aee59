#!/usr/bin/env bash
# Runs every test. Installs, builds and bakes first what site/demo.sh would; ends with ctest's summary.
set -euo pipefail
cd "$(dirname "$0")/.."
bash site/demo.sh --prepare
printf '\n== Building the unit tests with sanitizers\n'
mkdir -p build
cmake --preset asan >build/cmake-asan.log 2>&1 || { tail -n 40 build/cmake-asan.log; exit 1; }
cmake --build build/asan --target unit_tests fuzz_smoke >build/build-asan.log 2>&1 || { tail -n 60 build/build-asan.log; exit 1; }
printf '\n== Tests\n'
ctest --preset release -j "$(nproc)" "$@"  # browser tests run alone
