#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Draco's decoders as a static library for wasm and prints the folder to pass as DRACO_WASM_DIR (nothing else on
# stdout).
#
# Source: Debian's source package (debian_source.sh); or
#   DRACO_SOURCE_DIR=folder   an unpacked Draco (it has CMakeLists.txt)
# Result: ${FOURDVT_CACHE:-~/.cache/fourdvt}/draco-<version>-<hash of flags and compiler>/{lib/libdraco.a,include/draco}
# Needs no root. Returns at once if the result is there.
set -euo pipefail

cache=${FOURDVT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/fourdvt}
flags="${DRACO_WASM_FLAGS:--Oz -flto -msimd128} -fno-exceptions -fno-rtti -DNDEBUG"
# One translation unit per part, since most of the time goes to headers. With LTO the player becomes 0.2 % smaller.
options=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 -DDRACO_JS_GLUE=OFF -DDRACO_TESTS=OFF
  -DDRACO_BACKWARDS_COMPATIBILITY=OFF -DDRACO_POINT_CLOUD_COMPRESSION=OFF -DDRACO_PREDICTIVE_EDGEBREAKER=OFF)
# Unused decoder without a Draco option to exclude it: a character has positions and texture coordinates only.
no_features=NORMAL_ENCODING_SUPPORTED
# Draco's mesh decoding; most of the rest are encoders.
parts=(draco_core draco_attributes draco_mesh draco_point_cloud draco_metadata draco_metadata_dec
  draco_compression_entropy draco_compression_bit_coders draco_compression_attributes_dec draco_compression_mesh_dec
  draco_compression_point_cloud_dec draco_compression_decode)

fail() { echo "build_draco: $*" >&2; exit 1; }
. "$(dirname "${BASH_SOURCE[0]}")/debian_source.sh"
. "$(dirname "${BASH_SOURCE[0]}")/../site/steps.sh"  # show_progress

need_tools DRACO_SOURCE_DIR Draco

version_of() { sed -nE 's/.*kDracoVersion\[\] = "([^"]+)".*/\1/p' "$1/src/draco/core/draco_version.h"; }

hash=$(printf '%s\n' "$(declare -f bound_draco)" "$flags" "${options[*]}" "$no_features" "${parts[*]}" "$(emcc --version | head -1)" "${DRACO_SOURCE_DIR:-debian}" | sha256sum | cut -c1-12)
mkdir -p "$cache"
for ready in "$cache"/draco-*-"$hash"; do
  if [ -f "$ready/lib/libdraco.a" ]; then echo "$ready"; exit 0; fi
done

scratch=$(mktemp -d "$cache/.draco-build-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
source_dir=${DRACO_SOURCE_DIR:-}
if [ -z "$source_dir" ]; then
  echo "build_draco: fetching the source package" >&2
  fetch_source draco "$scratch"
  source_dir=$scratch/source
  bound_draco "$source_dir"
fi
version=$(version_of "$source_dir")
[ -n "$version" ] || fail "no version in $source_dir/src/draco/core/draco_version.h: is it Draco?"

echo "build_draco: building Draco $version for wasm (about 20 seconds)" >&2
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}
EMSCRIPTEN=${EMSCRIPTEN:-$(dirname "$(readlink -f "$(command -v emcc)")")}
export EMSCRIPTEN
log=$cache/draco-$hash.log
{
  emcmake cmake -S "$source_dir" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=None \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" "${options[@]}" >"$log" 2>&1 &&
    find "$scratch/build" -name draco_features.h -exec sed -i "/$no_features/d" {} + &&
    cmake --build "$scratch/build" --target "${parts[@]}" 2>&1 | show_progress "$log" "build_draco: " &&
    find "$scratch/build/CMakeFiles" -name '*.o' | sort | xargs emar qc "$scratch/build/libdraco.a" >>"$log" 2>&1
} || { tail -20 "$log" >&2; fail "the build failed, log: $log"; }

staged=$scratch/install
mkdir -p "$staged/lib" "$staged/include/draco"
cp "$scratch/build/libdraco.a" "$staged/lib/"
(cd "$source_dir/src/draco" && find . -name '*.h' -exec cp --parents {} "$staged/include/draco/" \;)
find "$scratch/build" -name draco_features.h -exec cp {} "$staged/include/draco/" \;
[ -f "$staged/include/draco/draco_features.h" ] || fail "the build wrote no draco_features.h, log: $log"

target=$cache/draco-$version-$hash
chmod 755 "$staged"
mv -T "$staged" "$target" 2>/dev/null || [ -f "$target/lib/libdraco.a" ] || fail "cannot write $target"
rm -f "$log"
echo "$target"
