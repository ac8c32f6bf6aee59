# SPDX-License-Identifier: Apache-2.0
# Fetches Debian source packages; sourced by the build_*.sh scripts of this folder. Uses a private apt configuration,
# leaves the system's unchanged, and needs no root. The caller defines fail MESSAGE, which ends the script.

need() { command -v "$1" >/dev/null || fail "'$1' is missing: install the package $2"; }

# Ends the script for a missing tool, or for a variable set to anything but a source folder.
need_tools() {  # $1: variable, $2: the library's name
  need emcmake emscripten
  need cmake cmake
  need ninja ninja-build
  [ -z "${!1:-}" ] || [ -f "${!1}/CMakeLists.txt" ] || fail "$1=${!1} has no CMakeLists.txt: name an unpacked $2"
}

# Copies the system's apt sources, changed from binary to source packages.
write_private_sources() {  # $1: output folder
  local file
  for file in /etc/apt/sources.list.d/*.sources; do
    [ -f "$file" ] && sed -E 's/^Types:.*/Types: deb-src/' "$file" >"$1/$(basename "$file")"
  done
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [ -f "$file" ] && sed -nE 's/^[[:space:]]*deb[[:space:]]/deb-src /p' "$file" >"$1/$(basename "$file")"
  done
  [ -n "$(cat "$1"/* 2>/dev/null)" ] || fail "no apt sources in /etc/apt: name an unpacked source folder instead"
}

private_apt() {  # $1: scratch folder, rest: apt-get arguments
  local scratch=$1 sandbox=()
  shift
  [ "$(id -u)" -eq 0 ] && sandbox=(-o APT::Sandbox::User=root)
  apt-get -q "${sandbox[@]}" -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$scratch/sources" \
    -o Dir::State="$scratch/state" -o Dir::State::Lists="$scratch/state/lists" -o Dir::Cache="$scratch/cache" \
    -o Dir::State::status=/var/lib/dpkg/status -o Debug::NoLocking=true "$@"
}

fetch_source() {  # $1: source package, $2: scratch folder; leaves the unpacked source in $2/source
  mkdir -p "$2"/{sources,state/lists/partial,cache/archives/partial,download}
  write_private_sources "$2/sources"
  private_apt "$2" update >&2 || fail "apt-get update of the source lists failed: is the package mirror reachable?"
  (cd "$2/download" && private_apt "$2" source --download-only "$1" >&2) ||
    fail "no source package '$1' at the mirror: name an unpacked source folder instead"
  need dpkg-source dpkg-dev
  dpkg-source --no-check -x "$2"/download/"$1"_*.dsc "$2/source" >&2
}

# Patches the source folder of Draco 1.5.5: limits the number of texture-coordinate orientations to that of the corners.
# A mesh of 181 bytes may otherwise declare 2^31 of them, which takes 256 MB and many seconds.
bound_draco() {  # $1: source folder
  local header=$1/src/draco/compression/attributes/prediction_schemes/mesh_prediction_scheme_tex_coords_portable_decoder.h
  local corners='static_cast<int64_t>(this->mesh_data().corner_table()->num_corners())'
  sed -i "s/|| num_orientations < 0) {/|| num_orientations < 0 || num_orientations > $corners) {/" "$header"
  grep -qF "num_orientations > $corners" "$header" || fail "$header is not as expected: see bound_draco"
}
