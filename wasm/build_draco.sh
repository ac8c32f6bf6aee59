#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds Draco's static library for wasm and prints the folder to pass as DRACO_WASM_DIR (nothing else on stdout).
#
# Source: Debian's source package, through a private apt configuration that leaves the system's alone; or
#   DRACO_SOURCE_DIR=folder   an unpacked Draco (it has CMakeLists.txt)
# Result: ${FOURDVT_CACHE:-~/.cache/fourdvt}/draco-<version>-<hash of flags and compiler>/{lib/libdraco.a,include/draco}
# Needs no root. Every run after the first returns at once.
set -euo pipefail

cache=${FOURDVT_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/fourdvt}
flags="${DRACO_WASM_FLAGS:--Os -msimd128} -fno-exceptions -fno-rtti -DNDEBUG"
options=(-DDRACO_JS_GLUE=OFF -DDRACO_TESTS=OFF -DDRACO_BACKWARDS_COMPATIBILITY=OFF)

fail() { echo "build_draco: $*" >&2; exit 1; }
need() { command -v "$1" >/dev/null || fail "'$1' is missing: install the package $2"; }

need emcmake emscripten
need cmake cmake
need ninja ninja-build
if [ -n "${DRACO_SOURCE_DIR:-}" ]; then
  [ -f "$DRACO_SOURCE_DIR/CMakeLists.txt" ] || fail "DRACO_SOURCE_DIR=$DRACO_SOURCE_DIR has no CMakeLists.txt: name an unpacked Draco"
fi

# Prints the system's own binary sources with their type turned into source packages.
write_private_sources() {  # $1: folder for them
  local file
  for file in /etc/apt/sources.list.d/*.sources; do
    [ -f "$file" ] && sed -E 's/^Types:.*/Types: deb-src/' "$file" >"$1/$(basename "$file")"
  done
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [ -f "$file" ] && sed -nE 's/^[[:space:]]*deb[[:space:]]/deb-src /p' "$file" >"$1/$(basename "$file")"
  done
  [ -n "$(cat "$1"/* 2>/dev/null)" ] || fail "no apt sources in /etc/apt: set DRACO_SOURCE_DIR to an unpacked Draco"
}

private_apt() {  # $1: scratch folder, rest: apt-get arguments
  local scratch=$1 sandbox=()
  shift
  [ "$(id -u)" -eq 0 ] && sandbox=(-o APT::Sandbox::User=root)
  apt-get -q "${sandbox[@]}" -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$scratch/sources" \
    -o Dir::State="$scratch/state" -o Dir::State::Lists="$scratch/state/lists" -o Dir::Cache="$scratch/cache" \
    -o Dir::State::status=/var/lib/dpkg/status -o Debug::NoLocking=true "$@"
}

fetch_source() {  # $1: scratch folder; leaves the unpacked source in $1/source
  mkdir -p "$1"/{sources,state/lists/partial,cache/archives/partial,download}
  write_private_sources "$1/sources"
  private_apt "$1" update >&2 || fail "apt-get update of the source lists failed: is the package mirror reachable?"
  (cd "$1/download" && private_apt "$1" source --download-only draco >&2) ||
    fail "no source package 'draco' at the mirror: set DRACO_SOURCE_DIR to an unpacked Draco"
  need dpkg-source dpkg-dev
  dpkg-source --no-check -x "$1"/download/draco_*.dsc "$1/source" >&2
}

version_of() { sed -nE 's/.*kDracoVersion\[\] = "([^"]+)".*/\1/p' "$1/src/draco/core/draco_version.h"; }

hash=$(printf '%s\n' "$flags" "${options[*]}" "$(emcc --version | head -1)" "${DRACO_SOURCE_DIR:-debian}" | sha256sum | cut -c1-12)
mkdir -p "$cache"
for ready in "$cache"/draco-*-"$hash"; do
  if [ -f "$ready/lib/libdraco.a" ]; then echo "$ready"; exit 0; fi
done

scratch=$(mktemp -d "$cache/.draco-build-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
source_dir=${DRACO_SOURCE_DIR:-}
if [ -z "$source_dir" ]; then
  echo "build_draco: fetching the source package" >&2
  fetch_source "$scratch"
  source_dir=$scratch/source
fi
version=$(version_of "$source_dir")
[ -n "$version" ] || fail "no version in $source_dir/src/draco/core/draco_version.h: is it Draco?"

echo "build_draco: building Draco $version for wasm (2-3 minutes)" >&2
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}
EMSCRIPTEN=${EMSCRIPTEN:-$(dirname "$(readlink -f "$(command -v emcc)")")}
export EMSCRIPTEN
log=$cache/draco-$hash.log
{
  emcmake cmake -S "$source_dir" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=None \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" "${options[@]}" &&
    cmake --build "$scratch/build" --target draco_static
} >"$log" 2>&1 || { tail -20 "$log" >&2; fail "the build failed, log: $log"; }

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
