#!/usr/bin/env bash
# Runs every test. Installs, builds and bakes first what site/demo.sh does, with OpenCV for wasm; then builds the tests,
# and the unit tests once more with sanitizers; ends with ctest's summary. Arguments go to ctest (-R REGEX, -L LABEL).
set -euo pipefail
cd "$(dirname "$0")/.."
. site/steps.sh
mkdir -p build
install_packages "${page_packages[@]}" "${test_packages[@]}"
bash site/demo.sh --prepare --opencv
step "Building the tests"
quiet cmake-tests cmake --preset release -DFOURDVT_TESTS=ON
build build-tests build/release
step "Building the unit tests with sanitizers"
quiet cmake-asan cmake --preset asan
build build-asan build/asan unit_tests fuzz_smoke
step "Tests"
ctest --preset release -j "$(nproc)" "$@"  # browser tests run alone
