#!/usr/bin/env bash
# Runs every test. Installs, builds and bakes first what site/demo.sh does, with characters from cameras and OpenCV for
# wasm; then builds the lab and the tests, unit tests with sanitizers; ends with ctest's summary.
#   bash tests/run.sh [ARGUMENT...]    arguments go to ctest (-R REGEX, -L LABEL)
#   bash tests/run.sh --changed [BASE] [-- ARGUMENT...]
#     builds and runs what the difference from the commit BASE can touch (tests/changed.mjs), after one whole run.
#     BASE: HEAD where the tree has changes, else HEAD~1
set -euo pipefail
cd "$(dirname "$0")/.."
. site/steps.sh
if [ "${1:-}" = --changed ]; then
  exec node tests/changed.mjs "${@:2}"
fi
mkdir -p build
install_packages "${page_packages[@]}" "${test_packages[@]}"
start_beside opencv env NODE_PATH=/usr/share/nodejs bash wasm/build_opencv.sh
step "Building the lab and the tests (OpenCV for wasm is built beside them: build/opencv.log)"
configure_release cmake-tests -DFOURDVT_MORE_TOOLS=ON -DFOURDVT_LAB=ON -DFOURDVT_TESTS=ON
build build-tests build/release
check_beside
step "Building most unit tests, with sanitizers"
quiet cmake-asan cmake --preset asan
build build-asan build/asan sanitized_tests fuzz_smoke
if [ "$(uname -m)" = x86_64 ]; then
  step "Building the player's fuzzers for 32 bits"
  draco32=$(bash tests/fuzz/draco32.sh 2>build/draco32.log) || fail_with_log draco32 "building Draco for 32 bits"
  quiet cmake-fuzz32 cmake --preset fuzz32 -DDRACO_LIBRARY="$draco32/libdraco.a" -DDRACO_INCLUDE="$draco32/include"
  build build-fuzz32 build/fuzz32 fuzz_smoke
fi
step "Finishing OpenCV for wasm"
finish_beside
bash site/demo.sh --prepare --opencv
step "Tests"
ctest --preset release -j "$(nproc)" "$@"
