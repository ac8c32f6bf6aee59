#!/usr/bin/env bash
# Runs the tests: those that a change of the product can break. Installs, builds and bakes what they need, as site/demo.sh does; ends
# with ctest's summary. .github/CONTRIBUTING.md lists what is in which run.
set -euo pipefail
usage() {
  cat <<'TXT'
bash tests/run.sh [ARGUMENT...]    arguments go to ctest (-R REGEX, -L LABEL), and only what these tests need is built
  --changed [BASE] [-- ARGUMENT...]  what the difference from the commit BASE can touch (tests/changed.mjs), after one whole run.
                                     BASE: HEAD where the tree has changes, else HEAD~1
  --long                             every test, the long ones included (weekly)
  --share                            a share of the long ones, in turn by the time, about five minutes
TXT
}
cd "$(dirname "$0")/.."
. site/steps.sh
mkdir -p build
selected=("$@")
case ${1:-} in
  '') selected=(-LE '^long$') ;;
  -h|--help) usage; exit 0 ;;
  --long) selected=("${@:2}") ;;
esac
install_packages "${page_packages[@]}" "${test_packages[@]}"
configure_release cmake-tests -DFOURDVT_MORE_TOOLS=ON -DFOURDVT_LAB=ON -DFOURDVT_TESTS=ON
case ${1:-} in
  --changed)
    base=() arguments=("${@:2}")
    case ${2:-} in ''|-*) ;; *) base=("$2") arguments=("${@:3}") ;; esac
    [ "${arguments[0]:-}" != -- ] || arguments=("${arguments[@]:1}")
    selected=(-R "$(node tests/changed.mjs "${base[@]}")" "${arguments[@]}") ;;
  --share)
    share=$(node tests/needed.mjs --share "$(date +%s)" 2>build/needed.log) || fail_with_log needed "choosing a share of the long tests"
    echo "Long tests whose turn it is: $share"
    selected=(-L "^$share\$") ;;
esac
needed=$(node tests/needed.mjs "${selected[@]}" 2>build/needed.log) || fail_with_log needed "listing what the tests need"
needs() { grep -q "^$1\b" <<<"$needed"; }
targets_of() { sed -n "s#^$1 ##p" <<<"$needed"; }
if needs site; then start_beside opencv env NODE_PATH=/usr/share/nodejs bash wasm/build_opencv.sh; fi
if needs build/release; then
  step "Building the lab and the tests"
  read -ra targets <<<"$(targets_of build/release)"
  build build-tests build/release "${targets[@]}"
fi
if needs build/asan; then
  step "Building tests with sanitizers"
  quiet cmake-asan cmake --preset asan
  read -ra targets <<<"$(targets_of build/asan)"
  build build-asan build/asan "${targets[@]}"
fi
if needs build/fuzz32; then
  step "Building the player's fuzzers for 32 bits"
  draco32=$(bash tests/fuzz/draco32.sh 2>build/draco32.log) || fail_with_log draco32 "building Draco for 32 bits"
  quiet cmake-fuzz32 cmake --preset fuzz32 -DDRACO_LIBRARY="$draco32/libdraco.a" -DDRACO_INCLUDE="$draco32/include"
  read -ra targets <<<"$(targets_of build/fuzz32)"
  build build-fuzz32 build/fuzz32 "${targets[@]}"
fi
if needs site; then
  step "Finishing OpenCV for wasm"
  finish_beside
  bash site/demo.sh --prepare --opencv
fi
step "Tests"
env -u FOURDVT_STEP_LOG ctest --preset release -j "$(nproc)" "${selected[@]}"  # tests run scripts with steps of their own
