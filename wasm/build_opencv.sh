#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds OpenCV's core, imgproc and video as static libraries for wasm and prints the folder to pass as OPENCV_WASM_DIR
# (nothing else on stdout). One thread, 128-bit SIMD, no file formats, no zlib.
#
# Source: Debian's source package (debian_source.sh); or
#   OPENCV_SOURCE_DIR=folder   an unpacked OpenCV 4 (it has CMakeLists.txt); read only
# Result: ${FOURDVT_CACHE:-~/.cache/fourdvt}/opencv-<version>-<hash of flags and compiler>/{lib/libopencv_*.a,include}
# With --only-if-built: prints the folder of an earlier run, or nothing.
# Needs no root. Every run after the first returns at once.
set -euo pipefail
case $* in
  '' | --only-if-built) ;;
  *) echo "usage: build_opencv.sh [--only-if-built]" >&2; exit 2 ;;
esac

cache=${FOURDVT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/fourdvt}
flags="${OPENCV_WASM_FLAGS:--O2 -msimd128} -DNDEBUG"
options=(-DBUILD_LIST=core,imgproc,video -DBUILD_SHARED_LIBS=OFF -DENABLE_PIC=OFF -DCPU_BASELINE= -DCPU_DISPATCH=
  -DCV_ENABLE_INTRINSICS=ON -DCV_TRACE=OFF -DWITH_PTHREADS_PF=OFF -DOPENCV_DISABLE_FILESYSTEM_SUPPORT=ON
  -DOPENCV_DISABLE_THREAD_SUPPORT=ON -DBUILD_ZLIB=ON -DBUILD_TESTS=OFF -DBUILD_PERF_TESTS=OFF -DBUILD_EXAMPLES=OFF
  -DBUILD_DOCS=OFF -DBUILD_PACKAGE=OFF -DBUILD_opencv_apps=OFF -DBUILD_opencv_js=OFF -DBUILD_JAVA=OFF)
for feature in 1394 ADE EIGEN FFMPEG GSTREAMER GTK IPP ITT JASPER JPEG LAPACK OPENCL OPENCLAMDBLAS OPENCLAMDFFT OPENEXR \
  OPENJPEG OPENGL PNG PROTOBUF QUIRC TBB TIFF V4L VTK WEBP; do
  options+=("-DWITH_$feature=OFF")
done

fail() { echo "build_opencv: $*" >&2; exit 1; }
. "$(dirname "${BASH_SOURCE[0]}")/debian_source.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../site/steps.sh"  # show_progress

need_tools OPENCV_SOURCE_DIR OpenCV

hash=$(printf '%s\n' "$flags" "${options[*]}" "$(emcc --version | head -1)" "${OPENCV_SOURCE_DIR:-debian}" | sha256sum | cut -c1-12)
mkdir -p "$cache"
for ready in "$cache"/opencv-*-"$hash"; do
  if [ -f "$ready/lib/libopencv_video.a" ]; then echo "$ready"; exit 0; fi
done
[ $# -eq 0 ] || exit 0

scratch=$(mktemp -d "$cache/.opencv-build-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
if [ -z "${OPENCV_SOURCE_DIR:-}" ]; then
  echo "build_opencv: fetching the source package" >&2
  fetch_source opencv "$scratch"
else
  cp -r "$OPENCV_SOURCE_DIR" "$scratch/source"
fi
source_dir=$scratch/source

number() { sed -nE "s/^#define CV_VERSION_$1 +([0-9]+).*/\1/p" "$source_dir/modules/core/include/opencv2/core/version.hpp"; }
version=$(number MAJOR).$(number MINOR).$(number REVISION)
[[ $version =~ ^4\.[0-9]+\.[0-9]+$ ]] || fail "$source_dir is no OpenCV 4 (version '$version')"

# Optical flow reads no compressed files, but OpenCV's build insists on zlib, which Debian's package leaves out. So it gets
# a library of that name with nothing in it.
sed -i 's/^#define USE_ZLIB 1$/#define USE_ZLIB 0/' "$source_dir/modules/core/src/persistence.hpp"
zlib=$source_dir/3rdparty/zlib
rm -rf "$zlib"
mkdir -p "$zlib"
echo '#define ZLIB_VERSION "1.2.13"' >"$zlib/zlib.h"
echo 'int fourdvt_no_zlib;' >"$zlib/none.c"
cat >"$zlib/CMakeLists.txt" <<'END'
add_library(zlib STATIC none.c)
install(TARGETS zlib EXPORT OpenCVModules ARCHIVE DESTINATION lib)
END

echo "build_opencv: building OpenCV $version for wasm (about 10 minutes)" >&2
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}
log=$cache/opencv-$hash.log
{
  emcmake cmake -S "$source_dir" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=None \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" "${options[@]}" >"$log" 2>&1 &&
    cmake --build "$scratch/build" --target opencv_core opencv_imgproc opencv_video 2>&1 | show_progress "$log" "build_opencv: "
} || { tail -20 "$log" >&2; fail "the build failed, log: $log"; }

staged=$scratch/staged
mkdir -p "$staged"/{lib,include/opencv2}
cp "$scratch"/build/lib/libopencv_{core,imgproc,video}.a "$staged/lib/"
for module in core imgproc video; do
  cp -r "$source_dir/modules/$module/include/opencv2/." "$staged/include/opencv2/"
done
find "$scratch/build" -maxdepth 2 -name 'cv_cpu_config.h' -o -maxdepth 3 -name 'opencv_modules.hpp' |
  xargs -I{} cp {} "$staged/include/opencv2/"

target=$cache/opencv-$version-$hash
chmod 755 "$staged"
mv -T "$staged" "$target" 2>/dev/null || [ -f "$target/lib/libopencv_video.a" ] || fail "cannot write $target"
rm -f "$log"
echo "$target"
