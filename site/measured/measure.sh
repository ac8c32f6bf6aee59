#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures what README.md and the site show, in parts, and writes the figures there. Keep the machine quiet meanwhile, for
# the sake of the times.
#   Parts    study, fvvr, truth, cameras, hulls, methods, bench, player; what belongs to each is in parts.mjs and parts/NAME.sh
#   State    a part carries the hash of its inputs (sources, capture, scripts) and the date; unchanged inputs: not
#            measured again. The figures of the parts that do not run stay as they are, with their hash and date
#   Machine  the yardstick runs before and after each part, and is recorded with it: seconds are shown with their ratio to it
#   Resume   run the same command again after a kill: finished steps are in build/measured/PART, each written as a whole.
#            Changed inputs empty that folder
set -euo pipefail
usage() {
  cat <<'TXT'
bash site/measured/measure.sh [options] [PART…]
  PART            study, fvvr, truth, cameras, hulls, methods, bench or player (default: all that are out of date)
  --list          print each part's state, date and minutes, and exit
  --anew          measure the parts named even if they are up to date, from the start
  --before FILE   an earlier figures.json: the page lists what got worse since then (default: since the last figures)
  --no-build      use what is built
TXT
}
anew='' build=1 before=() wanted=()
while [ $# -gt 0 ]; do
  case $1 in
    --list) exec node "$(dirname "$0")/parts.mjs" --list ;;
    --anew) anew=1 ;;
    --before) before=(--before "$(realpath -e "${2:?"--before needs a file"}")"); shift ;;
    --no-build) build='' ;;
    -h|--help) usage; exit 0 ;;
    -*) echo "site/measured/measure.sh: unknown option $1" >&2; usage >&2; exit 2 ;;
    *) wanted+=("$1") ;;
  esac
  shift
done
cd "$(dirname "$0")/../.."
. site/steps.sh

# Functions of the parts' scripts.
tool=${FOURDVT_BIN:-$PWD/build/release/native/tools/fourdvt}
lab=${FOURDVT_LAB_BIN:-$PWD/build/release/native/lab/tools/fourdvt-lab}
sample=site/sample/actor_a out=build/measured
figures=site/measured/parts.mjs

stale=$(node "$figures" --stale)
if [ ${#wanted[@]} -eq 0 ]; then mapfile -t wanted < <(printf '%s' "$stale"); fi
chosen=()
for name in ${wanted[@]+"${wanted[@]}"}; do
  node "$figures" --hash "$name" >/dev/null
  if [ -z "$anew" ] && ! grep -qx "$name" <<<"$stale"; then echo "$name: up to date"; else chosen+=("$name"); fi
done
if [ ${#chosen[@]} -eq 0 ]; then echo "every part asked for is up to date"; exit 0; fi
needs() { [[ " ${chosen[*]} " == *" $1 "* ]]; }

if [ -n "$build" ]; then
  mkdir -p build
  install_packages "${page_packages[@]}" "${test_packages[@]}"
  step "Building the programs"
  configure_release cmake-tests -DFOURDVT_MORE_TOOLS=ON -DFOURDVT_LAB=ON -DFOURDVT_TESTS=ON
  build build-measured build/release fourdvt fourdvt-lab bench_yardstick bench_draw_ratio bench_blend_ratio repeat_capture
  if needs bench || needs player; then bash site/demo.sh --prepare; fi
  if needs bench; then
    quiet build-class-frame env NODE_PATH=/usr/share/nodejs cmake --build build/wasm --target bench_class_frame
  fi
fi

# Seconds that a part has taken over all its runs; at most those since its last finished step are lost in a kill.
note_time() {
  local before=0
  [ ! -e "$folder/seconds" ] || before=$(cat "$folder/seconds")
  echo $((before + SECONDS - noted)) >"$folder/seconds.part"
  mv "$folder/seconds.part" "$folder/seconds"
  noted=$SECONDS
}

# Runs a command unless the file or folder that it leaves as its last one is there: once FILE COMMAND…
once() {
  local made=$1; shift
  [ ! -e "$made" ] || return 0
  step "$part: $*"
  "$@"
  note_time
}

# Keeps what a command prints as FOLDER/NAME.txt: printed NAME COMMAND… A bench that misses its own goal fails, and is
# still shown; collect.mjs refuses the text of one that printed no figure.
printed() {
  local name=$1; shift
  [ ! -e "$folder/$name.txt" ] || return 0
  step "$part: $name"
  "$@" | tee "$folder/$name.part" || echo "bench $name failed"
  mv "$folder/$name.part" "$folder/$name.txt"
  note_time
}

# Keeps runs of the yardstick, whose own seconds are none of the part's.
measure_machine() {
  node tests/bench/yardstick.mjs --keep "$folder/yardstick"
  noted=$SECONDS
}

# The folder of a part, emptied where it was begun with other inputs.
begin_part() {
  part=$1 folder=$out/$1 noted=$SECONDS
  inputs=$(node "$figures" --hash "$part")
  if [ -n "$anew" ] || [ "$(cat "$folder/inputs" 2>/dev/null)" != "$inputs" ]; then rm -rf "$folder"; fi
  mkdir -p "$folder"
  echo "$inputs" >"$folder/inputs"
}

for part in "${chosen[@]}"; do
  begin_part "$part"
  measure_machine
  trap note_time EXIT
  . "site/measured/parts/$part.sh"
  note_time
  trap - EXIT
  measure_machine
  if [ "$(node "$figures" --hash "$part")" != "$inputs" ]; then
    echo "site/measured/measure.sh: inputs of $part changed while it was measured; run it again" >&2
    exit 1
  fi
  node "$figures" --record "$part" --seconds "$(cat "$folder/seconds")" --yardstick "$folder/yardstick" --out "$folder/part.json"
  step "Writing the figures of $part ($(duration "$(cat "$folder/seconds")"))"
  node site/measured/collect.mjs --from "$out" ${before[@]+"${before[@]}"} "$part"
  node site/measured/fill.mjs
done
