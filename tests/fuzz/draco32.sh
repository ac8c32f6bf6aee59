#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Draco for 32 bits with the sanitizers, for the preset fuzz32, and prints its folder (nothing else on stdout): wasm has pointers and
# sizes of 32 bits, too, but no sanitizer that follows coverage.
# Source: Debian's source package, or DRACO_SOURCE_DIR=folder. Result: ${FOURDVT_CACHE:-~/.cache/fourdvt}/draco32-HASH/{libdraco.a,include}.
# Needs no root. Returns at once if the result is there.
set -euo pipefail
cache=${FOURDVT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/fourdvt}
flags='-m32 -idirafter /usr/include/x86_64-linux-gnu -O1 -g1 -DNDEBUG -fsanitize=address,fuzzer-no-link -fno-omit-frame-pointer'
fail() { echo "draco32: $*" >&2; exit 1; }
. "$(dirname "${BASH_SOURCE[0]}")/../../wasm/debian_source.sh"

target=$cache/draco32-$(printf '%s\n' "$(declare -f bound_draco)" "$flags" "$(clang++-14 --version | head -1)" "${DRACO_SOURCE_DIR:-debian}" | sha256sum | cut -c1-12)
if [ -f "$target/libdraco.a" ]; then echo "$target"; exit 0; fi
mkdir -p "$cache"
scratch=$(mktemp -d "$cache/.draco32-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
source_dir=${DRACO_SOURCE_DIR:-}
if [ -z "$source_dir" ]; then
  fetch_source draco "$scratch"
  source_dir=$scratch/source
  bound_draco "$source_dir"
fi
echo "draco32: building Draco for 32 bits (about a minute)" >&2
{
  cmake -S "$source_dir" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_C_COMPILER=clang-14 -DCMAKE_CXX_COMPILER=clang++-14 \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_UNITY_BUILD=ON -DDRACO_TESTS=OFF -DBUILD_SHARED_LIBS=OFF &&
    cmake --build "$scratch/build" --target draco_static
} >"$scratch/log" 2>&1 || { tail -20 "$scratch/log" >&2; fail 'the build failed'; }
mkdir -p "$scratch/install/include/draco"
cp "$scratch/build/libdraco.a" "$scratch/install/"
(cd "$source_dir/src/draco" && find . -name '*.h' -exec cp --parents {} "$scratch/install/include/draco/" \;)
find "$scratch/build" -name draco_features.h -exec cp {} "$scratch/install/include/draco/" \;
chmod 755 "$scratch/install"
mv -T "$scratch/install" "$target" 2>/dev/null || [ -f "$target/libdraco.a" ] || fail "cannot write $target"
echo "$target"
