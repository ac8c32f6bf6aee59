#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds OpenCV's Farnebäck flow, and required parts of core, imgproc and video, as a static library for wasm and prints
# the folder to pass as OPENCV_WASM_DIR (nothing else on stdout). One thread, 128-bit SIMD, no file formats, no zlib.
#
# Source: Debian's source package (debian_source.sh); or
#   OPENCV_SOURCE_DIR=folder   an unpacked OpenCV 4 (it has CMakeLists.txt); read only
# Result: ${FOURDVT_CACHE:-~/.cache/fourdvt}/opencv-<version>-<hash>/{lib/libopencv_flow.a,include}; hash: of flags, parts
# and compiler
# With --only-if-built: prints the folder of an earlier run, or nothing.
# Needs no root. Every run after the first returns at once.
set -euo pipefail
case $* in
  '' | --only-if-built) ;;
  *) echo "usage: build_opencv.sh [--only-if-built]" >&2; exit 2 ;;
esac

cache=${FOURDVT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/fourdvt}
flags="${OPENCV_WASM_FLAGS:--O2 -msimd128} -DNDEBUG"
parts=$(dirname "$(realpath "${BASH_SOURCE[0]}")")/opencv/library  # lists the files

fail() { echo "build_opencv: $*" >&2; exit 1; }
. "$(dirname "${BASH_SOURCE[0]}")/debian_source.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../site/steps.sh"  # show_progress

need_tools OPENCV_SOURCE_DIR OpenCV

hash=$(printf '%s\n' "$flags" "$(cat "$parts/CMakeLists.txt")" "$(emcc --version | head -1)" "${OPENCV_SOURCE_DIR:-debian}" | sha256sum | cut -c1-12)
mkdir -p "$cache"
for ready in "$cache"/opencv-*-"$hash"; do
  if [ -f "$ready/lib/libopencv_flow.a" ]; then echo "$ready"; exit 0; fi
done
[ $# -eq 0 ] || exit 0

scratch=$(mktemp -d "$cache/.opencv-build-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
if [ -z "${OPENCV_SOURCE_DIR:-}" ]; then
  echo "build_opencv: fetching the source package" >&2
  fetch_source opencv "$scratch"
else
  mkdir -p "$scratch/source/modules"
  cp -r "$OPENCV_SOURCE_DIR"/modules/{core,imgproc,video} "$scratch/source/modules/"
fi
source_dir=$scratch/source

number() { sed -nE "s/^#define CV_VERSION_$1 +([0-9]+).*/\1/p" "$source_dir/modules/core/include/opencv2/core/version.hpp"; }
version=$(number MAJOR).$(number MINOR).$(number REVISION)
[[ $version =~ ^4\.[0-9]+\.[0-9]+$ ]] || fail "$source_dir is no OpenCV 4 (version '$version')"

# Optical flow needs no compressed files, and Debian's package lacks zlib.
sed -i 's/^#define USE_ZLIB 1$/#define USE_ZLIB 0/' "$source_dir/modules/core/src/persistence.hpp"

echo "build_opencv: building the optical flow of OpenCV $version for wasm (about 1 minute)" >&2
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}
log=$cache/opencv-$hash.log
{
  emcmake cmake -S "$parts" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="$flags" \
    "-DOPENCV_SOURCE=$source_dir" >"$log" 2>&1 &&
    cmake --build "$scratch/build" 2>&1 | show_progress "$log" "build_opencv: "
} || {
  tail -20 "$log" >&2
  grep -q 'undefined symbol' "$log" && fail "OpenCV $version needs files that $parts/CMakeLists.txt does not list, log: $log"
  fail "the build failed, log: $log"
}

staged=$scratch/staged
mkdir -p "$staged"/{lib,include}
cp "$scratch/build/libopencv_flow.a" "$staged/lib/"
for module in core imgproc video; do
  cp -r "$source_dir/modules/$module/include/." "$staged/include/"
done
cp "$scratch/build/made/opencv2/opencv_modules.hpp" "$scratch/build/made/cv_cpu_config.h" "$staged/include/opencv2/"

target=$cache/opencv-$version-$hash
chmod 755 "$staged"
mv -T "$staged" "$target" 2>/dev/null || [ -f "$target/lib/libopencv_flow.a" ] || fail "cannot write $target"
rm -f "$log"
echo "$target"
