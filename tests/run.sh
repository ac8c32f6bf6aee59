#!/usr/bin/env bash
# Runs every test. Installs, builds and bakes first what site/demo.sh does, with OpenCV for wasm; then builds the tests,
# and the unit tests once more with sanitizers; ends with ctest's summary. Arguments go to ctest (-R REGEX, -L LABEL).
set -euo pipefail
cd "$(dirname "$0")/.."
. site/steps.sh
mkdir -p build
install_packages "${page_packages[@]}" "${test_packages[@]}"
start_beside opencv env NODE_PATH=/usr/share/nodejs bash wasm/build_opencv.sh
step "Building the tests (OpenCV for wasm is built beside them: build/opencv.log)"
quiet cmake-tests cmake --preset release -DFOURDVT_TESTS=ON
build build-tests build/release
check_beside
step "Building the unit tests with sanitizers"
quiet cmake-asan cmake --preset asan
build build-asan build/asan unit_tests fuzz_smoke
step "Finishing OpenCV for wasm"
finish_beside
bash site/demo.sh --prepare --opencv
step "Tests"
ctest --preset release -j "$(nproc)" "$@"  # browser tests run alone
