# SPDX-License-Identifier: Apache-2.0
# Sourced by site/demo.sh, tests/run.sh and wasm/build_*.sh: installs packages, runs builds, and says what is being done
# and how long is left. The caller has `set -euo pipefail`; quiet and build want the project's root as current folder,
# because their logs go to build/.

# What the page needs.
page_packages=(build-essential pkg-config cmake ninja-build ca-certificates dpkg-dev
  libglm-dev libeigen3-dev libtinygltf-dev nlohmann-json3-dev libdraco-dev libopencv-dev liblcms2-dev libpugixml-dev libtomlplusplus-dev libyaml-cpp-dev
  libopenvdb-dev libboost-iostreams-dev zlib1g-dev libssl-dev libmeshoptimizer-dev
  libavcodec-dev libavfilter-dev libavformat-dev libavutil-dev libswscale-dev libswresample-dev
  libegl-dev libgles-dev libegl1 libgles2 libgl1-mesa-dri emscripten clang-14)
# A Node from elsewhere serves as well; Debian's npm would conflict with it.
command -v node >/dev/null || page_packages+=(nodejs)
command -v npm >/dev/null || page_packages+=(npm)
browser_packages=(chromium fonts-dejavu-core)  # site/demo.sh --check
lan_packages=(openssl qrencode)                # site/demo.sh --lan
# The libraries for 32 bits are for a build of the player that is fuzzed. Figures and --changed compare trees by git.
test_packages=(git libgtest-dev libclang-rt-14-dev "${browser_packages[@]}" firefox-esr xvfb)
if [ "$(uname -m)" = x86_64 ]; then test_packages+=(libc6-dev-i386 lib32stdc++-12-dev); fi

# Says what is done, and at which minute of the script. FOURDVT_STEP_LOG: a file that gets a line a step, with its time.
step() {
  printf '\n== %s (at %d:%02d)\n' "$*" $((SECONDS / 60)) $((SECONDS % 60))
  [ -z "${FOURDVT_STEP_LOG:-}" ] || echo "$(date +%s) $*" >>"$FOURDVT_STEP_LOG"
}

# Ends the script with the last lines of build/NAME.log.
fail_with_log() {  # $1: name, rest: what failed
  tail -n 60 "build/$1.log" >&2
  echo "failed: ${*:2} (whole log: $PWD/build/$1.log)" >&2
  exit 1
}

# Runs a command quietly.
quiet() { local name=$1; shift; "$@" >"build/$name.log" 2>&1 || fail_with_log "$name" "$@"; }

# Installs the packages that are missing. Does nothing where all are there.
install_packages() {
  local p missing=() sudo=''
  for p in "$@"; do
    dpkg-query -W -f '${Status}' "$p" 2>/dev/null | grep -q 'ok installed' || missing+=("$p")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  step "Installing ${missing[*]} (all packages on a bare system: about 2 minutes)"
  [ "$(id -u)" = 0 ] || sudo=sudo
  quiet apt-update $sudo apt-get update
  quiet apt-install $sudo env DEBIAN_FRONTEND=noninteractive \
    apt-get -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "${missing[@]}"
}

# "45 s" or "3 min 05 s".
duration() { if [ "$1" -lt 60 ]; then echo "$1 s"; else printf '%d min %02d s\n' $(($1 / 60)) $(($1 % 60)); fi; }

# Copies Ninja's output to a log, and tells how many steps are done and about how long the rest takes: on a terminal in
# one line, which it rewrites; elsewhere in a line every 20 seconds.
show_progress() {  # $1: log, $2: what each line begins with
  local line began=$SECONDS told=$SECONDS done_steps all_steps note=''
  while IFS= read -r line; do
    echo "$line" >>"$1"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    done_steps=${BASH_REMATCH[1]} all_steps=${BASH_REMATCH[2]}
    note="${2:-}$done_steps of $all_steps steps"
    if ((SECONDS - began >= 10)); then
      note+=", about $(duration $(((SECONDS - began) * (all_steps - done_steps) / done_steps))) left"
    fi
    if [ -t 2 ]; then
      printf '\r\033[K%s' "$note" >&2
    elif ((SECONDS - told >= 20)); then
      echo "$note" >&2
      told=$SECONDS
    fi
  done
  if [ -t 2 ] && [ -n "$note" ]; then printf '\r\033[K' >&2; fi
}

# Builds targets of a build folder, all where none is named.
build() {  # $1: name of the log, $2: build folder, rest: targets
  local name=$1 command=(cmake --build "$2")
  [ $# -lt 3 ] || command+=(--target "${@:3}")
  : >"build/$name.log"
  NINJA_STATUS='[%f/%t] ' "${command[@]}" 2>&1 | show_progress "build/$name.log" || fail_with_log "$name" "${command[@]}"
}

# Runs a command beside the script, for work that leaves a core idle: one at a time. It has a process group of its own,
# which ends as a whole when the script does.
start_beside() {  # $1: what it makes, also the name of its log; rest: command
  beside=$1
  set -m
  "${@:2}" >"build/$1.log" 2>&1 &
  beside_id=$!
  set +m
  trap 'kill -- "-$beside_id" 2>/dev/null || true' EXIT
}

# Ends the script if the command beside it has failed already.
check_beside() { kill -0 "$beside_id" 2>/dev/null || finish_beside; }

# Configures build/release for all commands, or for what the options say. A new build folder has Clang where it is found, which
# Emscripten brings and which compiles in two thirds of GCC's time; programs of both are equally fast and give the same bytes.
configure_release() {  # $1: name of the log, rest: options of cmake
  local compiler=()
  if [ ! -e build/release/CMakeCache.txt ] && command -v clang++-14 >/dev/null; then compiler=(-DCMAKE_CXX_COMPILER=clang++-14); fi
  quiet "$1" cmake --preset release "${compiler[@]}" "${@:2}"
}

# Shows what the command says from here on, until it ends.
finish_beside() {
  [ -n "$beside_id" ] || return 0
  tail -n 1 -f --pid="$beside_id" "build/$beside.log"
  wait "$beside_id" || fail_with_log "$beside" "making the $beside"
  beside_id=''
  trap - EXIT
}
