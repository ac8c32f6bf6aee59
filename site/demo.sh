#!/usr/bin/env bash
# The whole way from a clean clone to a page: installs what is missing, builds the tool and the player, bakes a capture,
# serves the page, with one motion first: the other motions, commands that the page does without and characters from cameras
# are made while it is served. Safe to run again: finished steps are skipped or incremental. Builds neither tests nor the
# lab: tests/run.sh does.
set -euo pipefail
usage() {
  cat <<'TXT'
bash site/demo.sh [options]
  --check         open the page in headless Chromium, orbit, compare with native renders, print figures, exit
  --capture DIR   bake and show your own capture folder instead of the sample
  --opencv        build OpenCV for wasm too (a minute, once), so that the page offers its optical flow
  --port N        first port to try (default 8080); the next free one is taken
  --lan           serve to the local network, for a phone: over https with a certificate made here, because browsers
                  decode video only for https pages; prints address and QR code. The phone warns of the certificate
  --live          no character that was baked, but the sample's videos as live cameras: fourdvt live and its console
  --prepare       install, build all commands and bake only, characters from cameras included
  --no-install    do not touch the system's packages
TXT
}
check='' capture='' opencv=--only-if-built port=8080 prepare='' install=1 lan='' live=''
while [ $# -gt 0 ]; do
  case $1 in
    --check) check=1 ;;
    --capture) capture=${2:?"--capture needs a folder"}; shift ;;
    --opencv) opencv='' ;;
    --port) port=${2:?"--port needs a number"}; shift ;;
    --lan) lan=1 ;;
    --live) live=1 ;;
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
. site/steps.sh
mkdir -p build

[ -z "$install" ] || install_packages "${page_packages[@]}" ${check:+"${browser_packages[@]}"} ${lan:+"${lan_packages[@]}"}

# A library for wasm: prints its folder. Built on the first run, in the cache of all clones after that.
wasm_library() { bash "wasm/build_$1.sh" "${@:2}" 2> >(tee "build/$1.log" | grep --line-buffered "^build_$1:" >&2) || fail_with_log "$1" "wasm/build_$1.sh"; }

# The player: wasm and JavaScript, in web/dist.
build_player() {
  local draco opencv_library lock
  export NODE_PATH=/usr/share/nodejs  # Debian's emscripten keeps acorn there
  lock=$(sha256sum web/package-lock.json | cut -d' ' -f1)
  if [ "$(cat web/node_modules/.fourdvt-lock 2>/dev/null)" != "$lock" ]; then
    quiet npm-ci env -C web npm ci --no-audit --no-fund
    echo "$lock" >web/node_modules/.fourdvt-lock
  fi
  draco=$(wasm_library draco)
  opencv_library=$(wasm_library opencv $opencv)
  quiet cmake-wasm cmake --preset wasm "-DDRACO_WASM_DIR=$draco" "-DOPENCV_WASM_DIR=$opencv_library"
  build build-wasm build/wasm
  node web/build.mjs --wasm "$root/build/wasm/wasm"
}

start_beside player build_player  # its downloads and links leave a core idle

# In a new build folder: the commands of the page alone, unless all of them are wanted before it (native/tools/CMakeLists.txt).
# The others are built while the page is served; tests/run.sh turns the tests and the lab on.
tool=build/release/native/tools/fourdvt
options=()
[ -e build/release/CMakeCache.txt ] || options=(-DFOURDVT_TESTS=OFF -DFOURDVT_LAB=OFF -DFOURDVT_MORE_TOOLS=OFF)
[ -z "$prepare$live" ] || options+=(-DFOURDVT_MORE_TOOLS=ON)
build_tool() {
  configure_release cmake-release "$@"
  build build-release build/release fourdvt
}
step "Building the tool (the player is built beside it: build/player.log)"
build_tool "${options[@]}"
check_beside

source_capture=${capture:-$root/site/sample/actor_a}
name=$( [ -z "$capture" ] && echo character || echo "character-$(basename "$capture")")
character=$root/build/$name
# The same sources of the bake on the same files give the same character.
stamp=$( { node site/bake_stamp.mjs
           find -L "$source_capture" -type f -printf '%P %s %T@\n' | sort; } | sha256sum | cut -d' ' -f1)
is_baked() { [ "$(cat "$1.stamp" 2>/dev/null)" = "$stamp" ] && [ -e "$1/character.gltf" ]; }
bake() {  # $1: character folder, rest: options
  if is_baked "$1"; then
    echo "unchanged: $1"
  else
    $tool bake "$source_capture" -o "$1" --resume "${@:2}" && echo "$stamp" >"$1.stamp"
  fi
}
# The sample's page is served with one motion before the others are baked.
shown=$character
if [ -z "$capture$prepare" ] && ! is_baked "$character"; then
  step "Baking the first motion"
  shown=$root/build/character-walk
  bake "$shown" --sequences walk
else
  step "Baking the character"
  bake "$character"
fi

step "Finishing the player (wasm and JavaScript)"
finish_beside

# The sample from cameras alone: its run on the hull, on the hull refined by stereo and on the tracked mesh, for cameras.html and
# methods.html; its walk and run on a mesh tracked from the cameras, for slider.html.
cameras=$root/build/cameras
make_cameras() { bash site/cameras.sh $tool "$source_capture" "$cameras" "$stamp"; }
cameras_made() { bash site/cameras.sh --is-made "$cameras" "$stamp"; }

site_folder=$root/build/site; [ -z "$capture" ] || site_folder=$root/build/site-$name
if [ -n "$prepare" ] && [ -z "$capture" ]; then
  step "Making characters from cameras"
  make_cameras
fi
from_cameras=()
[ -n "$capture" ] || ! cameras_made || from_cameras=("$cameras")
assemble() { node site/assemble.mjs "$@" "${from_cameras[@]}"; }
assemble "$site_folder" "$root/web/dist" "$shown"
[ -z "$prepare" ] || exit 0
if [ -n "$check" ]; then
  step "The page can be served"
  if [ "$shown" != "$character" ]; then
    node tests/web/check.mjs --first "$site_folder" "$root/build/check"
    step "Baking the whole character"
    bake "$character"
    assemble --add "$site_folder" "$root/web/dist" "$character"
  fi
  step "Checking the page in Chromium"
  exec node tests/web/check.mjs "$site_folder" "$root/build/check" "$root/$tool" "$character"
fi
if [ -n "$live" ]; then
  step "Serving a live stage; Ctrl-C stops"
  exec $tool live site/sample/actor_a/live.json --port "$port" --web "$site_folder"
fi

# Makes the other motions, commands and characters, in the order in which a visitor of the page misses them.
make_the_rest() {
  if ! is_baked "$character"; then
    bake "$character" && assemble --add "$site_folder" "$root/web/dist" "$character" || return 1
    echo "All motions are baked: reload the page" >&3
  fi
  build_tool -DFOURDVT_MORE_TOOLS=ON || return 1
  if [ -z "$capture" ] && ! cameras_made; then
    make_cameras || return 1
    from_cameras=("$cameras")
    assemble --add "$site_folder" "$root/web/dist" "$character" || return 1
    echo "Characters from cameras are ready: reload the page" >&3
  fi
  echo "All commands are built: $tool" >&3
}
report_the_rest() { (make_the_rest) || echo "Not everything could be made: $root/build/rest.log" >&3; }
[ -z "$capture" ] && is_baked "$character" && cameras_made ||
  echo "What the page does without is made while it is served, in some minutes (build/rest.log): other motions, other commands, characters from cameras"
exec 3>&2
start_beside rest report_the_rest
if [ -n "$lan" ]; then
  # The key stays in build/ and is made once: the phone's consent lasts.
  certificate=build/lan
  if [ ! -e "$certificate.crt" ]; then
    (umask 077 && quiet certificate openssl req -x509 -newkey rsa:2048 -nodes -days 365 -subj "/CN=fourdvt demo" \
      -keyout "$certificate.key" -out "$certificate.part")
    mv "$certificate.part" "$certificate.crt"
  fi
  step "Serving to the local network; Ctrl-C stops"
  node tests/web/server.mjs "$site_folder" "$port" "$certificate.key" "$certificate.crt" | while read -r url; do
    echo "$url"
    qrencode -t UTF8 "$url"
    echo "Open it on the phone, and accept the warning: the certificate is self-signed."
  done
  exit 0
fi
step "Serving; Ctrl-C stops"
node tests/web/server.mjs "$site_folder" "$port"
