#!/usr/bin/env bash
# The whole way from a clean clone to a page: installs what is missing, builds native and wasm, bakes a capture, serves
# the page. Safe to run again: finished steps are skipped or incremental.
set -euo pipefail
usage() {
  cat <<'TXT'
bash site/demo.sh [options]
  --check         open the page in headless Chromium, orbit, compare with native renders, print figures, exit
  --capture DIR   bake and show your own capture folder instead of the sample
  --port N        first port to try (default 8080); the next free one is taken
  --prepare       install, build and bake only
  --no-install    do not touch the system's packages
TXT
}
check='' capture='' port=8080 prepare='' install=1
while [ $# -gt 0 ]; do
  case $1 in
    --check) check=1 ;;
    --capture) capture=${2:?"--capture needs a folder"}; shift ;;
    --port) port=${2:?"--port needs a number"}; shift ;;
    --prepare) prepare=1 ;;
    --no-install) install='' ;;
    -h|--help) usage; exit 0 ;;
    *) echo "site/demo.sh: unknown option $1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
[ -z "$capture" ] || capture=$(realpath -e "$capture") || { echo "site/demo.sh: --capture: no such folder" >&2; exit 2; }
cd "$(dirname "$0")/.."
root=$PWD
mkdir -p build
step() { printf '\n== %s\n' "$*"; }
# Runs quietly; on failure shows the end of the log.
quiet() { local log=$root/build/$1.log; shift; "$@" >"$log" 2>&1 || { tail -n 60 "$log"; echo "failed: $* (whole log: $log)" >&2; exit 1; }; }

packages=(build-essential pkg-config cmake ninja-build ca-certificates dpkg-dev
  libglm-dev libeigen3-dev libtinygltf-dev nlohmann-json3-dev libdraco-dev libopencv-dev libgtest-dev
  libavcodec-dev libavformat-dev libavutil-dev libswscale-dev
  libegl-dev libgles-dev libegl1 libgles2 libgl1-mesa-dri
  emscripten chromium fonts-dejavu-core)
# A Node from elsewhere serves as well; Debian's npm would conflict with it.
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
if [ -n "$install" ]; then
  missing=()
  for p in "${packages[@]}"; do
    dpkg-query -W -f '${Status}' "$p" 2>/dev/null | grep -q 'ok installed' || missing+=("$p")
  done
  if [ ${#missing[@]} -gt 0 ]; then
    step "Installing ${missing[*]}"
    sudo=''; [ "$(id -u)" = 0 ] || sudo=sudo
    quiet apt-update $sudo apt-get update
    quiet apt-install $sudo env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "${missing[@]}"
  fi
fi

step "Building the native tools"
quiet cmake-release cmake --preset release
quiet build-release cmake --build build/release

step "Building the player (wasm and JavaScript)"
export NODE_PATH=/usr/share/nodejs  # Debian's emscripten keeps acorn there
# A library for wasm: the folder of it. Built on the first run, in the cache of all clones after that.
wasm_library() { bash "wasm/build_$1.sh" 2> >(tee "build/$1.log" | grep --line-buffered "^build_$1:" >&2) || { tail -n 40 "build/$1.log" >&2; exit 1; }; }
draco=$(wasm_library draco)
opencv=$(wasm_library opencv)
quiet cmake-wasm cmake --preset wasm "-DDRACO_WASM_DIR=$draco" "-DOPENCV_WASM_DIR=$opencv"
quiet build-wasm cmake --build build/wasm
(cd web
 lock=$(sha256sum package-lock.json | cut -d' ' -f1)
 if [ "$(cat node_modules/.fourdvt-lock 2>/dev/null)" != "$lock" ]; then
   quiet npm-ci npm ci --no-audit --no-fund && echo "$lock" >node_modules/.fourdvt-lock
 fi
 node build.mjs --wasm "$root/build/wasm/wasm")

step "Baking the character"
source_capture=${capture:-$root/site/sample/actor_a}
name=$( [ -z "$capture" ] && echo character || echo "character-$(basename "$capture")")
character=$root/build/$name
# The same tool on the same files gives the same character.
stamp=$( { sha256sum build/release/native/tools/fourdvt | cut -d' ' -f1
           find -L "$source_capture" -type f -printf '%P %s %T@\n' | sort; } | sha256sum | cut -d' ' -f1)
if [ "$(cat "$character.stamp" 2>/dev/null)" = "$stamp" ] && [ -e "$character/character.gltf" ]; then
  echo "unchanged: $character"
else
  build/release/native/tools/fourdvt bake "$source_capture" -o "$character" --resume
  echo "$stamp" >"$character.stamp"
fi

site_folder=$root/build/site; [ -z "$capture" ] || site_folder=$root/build/site-$name
node site/assemble.mjs "$site_folder" "$root/web/dist" "$character"
if [ -n "$check" ]; then
  step "Checking the page in Chromium"
  exec node tests/web/check.mjs "$site_folder" "$root/build/check" "$root/build/release/native/tools/fourdvt" "$character"
fi
[ -z "$prepare" ] || exit 0
step "Serving; Ctrl-C stops"
exec node tests/web/server.mjs "$site_folder" "$port"
