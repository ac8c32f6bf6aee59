#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Shows whether two builds of the tool give the same bytes: bakes a capture and renders pictures with both, and compares
# SHA-256 of every file apart from report.*. Prints a table; the exit code is 1 where a file differs or is missing.
# Bakes and pictures that the same tool made before with the same options stay in OUT and are not made again.
#   bash tests/bench/same_bytes.sh BEFORE AFTER CAPTURE OUT [CASE...]     cases: see below; default: all
# BEFORE, AFTER: FOURDVT,FOURDVT_LAB, two programs; or one that also has the lab's commands.
# FOURDVT_AFTER_OPTIONS: further options of `bake`, for the second tool only, to see that a difference is found.
set -euo pipefail
usage() { sed -n '3,8s/^# //p' "$0" >&2; exit 2; }
[ $# -ge 4 ] || usage
declare -A tools labs
for side in before after; do
  IFS=, read -r tool lab <<<"$1"
  tools[$side]=$(realpath -e "$tool")
  labs[$side]=$(realpath -e "${lab:-$tool}")
  shift
done
capture=$(realpath -e "$1")
shift
mkdir -p "$1"
out=$(realpath "$1")
shift

# Facts of the capture: its first class and the members, its shortest sequence.
describe='const c = JSON.parse(require("fs").readFileSync(process.argv[1]));
const by_length = [...c.sequences].sort((a, b) => a.frames - b.frames);
const k = (c.classes ?? [])[0];
console.log(by_length[0].name, k ? k.name : "-", k ? k.members.join(",") : "-");'
read -r shortest class members < <(node -e "$describe" "$capture/capture.json")

plain="--sequences $shortest --no-classes"
declare -A bakes=(
  [as-is]=""
  [layers-1]="$plain --layers 1" [layers-2]="$plain --layers 2" [layers-3-equal]="$plain --layers 3 --equal-layers"
  [labels-naive]="$plain --labels naive" [labels-spatial]="$plain --labels spatial"
  [labels-temporal-paper]="$plain --labels temporal-paper" [labels-joint]="$plain --labels joint"
  [labels-per-texel]="$plain --labels per-texel" [penalty-ray]="$plain --penalty ray"
  [codec-vp9]="$plain --codec vp9" [codec-av1]="$plain --codec av1"
  [filter-bicubic]="$plain --filter bicubic --no-colour-calibration")
[ "$class" = - ] || bakes[class]="--sequences $members"
[ "$class" = - ] && shown=labels-joint || shown=class  # the character that is rendered
names=("$@")
[ ${#names[@]} -gt 0 ] || readarray -t names < <(printf '%s\n' "${!bakes[@]}" pictures studio | sort)
for name in "${names[@]}"; do
  [[ $name =~ ^(pictures|studio)$ ]] || [[ -v bakes[$name] ]] || { echo "same_bytes: no case \"$name\" for this capture: ${!bakes[*]} pictures studio" >&2; exit 2; }
done

# What a result depends on. A tool is known by its contents.
capture_is=$(cd "$capture" && find -L . -type f -printf '%P %s %T@\n' | sort | sha256sum)
fingerprint() { { sha256sum <"$1"; echo "$capture_is" "${@:2}"; } | sha256sum | cut -d' ' -f1; }

# Runs COMMAND, which fills FOLDER, unless that was done before with the same fingerprint.
once() {  # $1: folder, $2: fingerprint, rest: command
  [ "$(cat "$1.made" 2>/dev/null)" != "$2" ] || return 0
  rm -rf "$1" "$1.work" "$1.made"
  "${@:3}" >"$1.log" 2>&1 || { tail -n 20 "$1.log" >&2; echo "same_bytes: failed: ${*:3}" >&2; exit 1; }
  echo "$2" >"$1.made"
}

bake() {  # $1: side, $2: case, rest: further options
  local folder=$out/$1/$2 tool=${tools[$1]}
  [[ ${bakes[$2]} != *--labels* ]] || tool=${labs[$1]}
  # shellcheck disable=SC2086  # options are words
  once "$folder" "$(fingerprint "$tool" "${bakes[$2]}" "${@:3}")" "$tool" bake "$capture" -o "$folder" ${bakes[$2]} "${@:3}"
}

studio() {  # $1: side
  local options=(procedural --sequences walk --no-truth --size 240x320 --fps 8 --noise 2 --drift-mm 4 --proxy-mm 2)
  once "$out/$1/studio" "$(fingerprint "${labs[$1]}" "${options[@]}")" "${labs[$1]}" studio "${options[@]}" -o "$out/$1/studio"
}

# The class's parameter, in the middle of its members, as --parameter takes it.
middle_parameter='let found; const walk = (v) => { if (!v || typeof v !== "object") return;
  if (v.parameterSpace && v.members) found = v; Object.values(v).forEach(walk); };
walk(JSON.parse(require("fs").readFileSync(process.argv[1])));
const at = found.members.map((m) => [m.parameter].flat()[0]);
console.log(`${found.parameterSpace.names[0]}=${((Math.min(...at) + Math.max(...at)) / 2).toFixed(3)}`);'

render_all() {  # $1: tool, $2: character, $3: folder
  local character=$2 folder=$3 still=(--sequence "$shortest" --size 360x480) moving method parameter bad=0
  still_of() { "$1" render "$character" "${@:3}" -o "$folder/$2.png" || bad=$((bad + 1)); }
  mkdir -p "$folder"
  still_of "$1" front "${still[@]}" --frame 7 --azimuth 0
  still_of "$1" behind-above "${still[@]}" --frame 3 --azimuth 160 --elevation 35 --no-shadow --background none
  for method in labels layers weights; do still_of "$1" "debug-$method" "${still[@]}" --frame 7 --azimuth 40 --debug $method; done
  still_of "$1" fvvr "${still[@]}" --frame 7 --azimuth 30 --method fvvr --capture "$capture"
  still_of "$1" fvvr-closest "${still[@]}" --frame 7 --azimuth 210 --method fvvr --capture "$capture" --closest 3
  [ "$class" != - ] || return $bad
  parameter=$(node -e "$middle_parameter" "$character/character.gltf")
  moving=(--class "$class" --parameter "$parameter" --phase 0.3 --size 360x480)
  for method in none baked flow-gpu flow-dis flow-opencv; do
    still_of "$1" "align-$method" "${moving[@]}" --azimuth 30 --align $method
  done
  return $bad
}

pictures() {  # $1: side, rest: as bake
  local tool=${tools[$1]}
  bake "$1" "$shown" "${@:2}"
  once "$out/$1/pictures" "$(fingerprint "$tool" "$(sha256sum <"$0")" "${@:2}")" render_all "$tool" "$out/$1/$shown" "$out/$1/pictures"
}

# "FILE<tab>SHA-256" per file.
sums() { (cd "$1" && find . -type f ! -name 'report.*' -printf '%P\n' | sort | while read -r f; do printf '%s\t%s\n' "$f" "$(sha256sum <"$f" | cut -d' ' -f1)"; done); }

mkdir -p "$out/before" "$out/after"
read -ra further <<<"${FOURDVT_AFTER_OPTIONS:-}"
failed=0
printf '%-24s %6s %10s  %s\n' case files different "SHA-256 of all, before"
for name in "${names[@]}"; do
  case $name in
    pictures) pictures before; pictures after "${further[@]}" ;;
    studio) studio before; studio after ;;
    *) bake before "$name"; bake after "$name" "${further[@]}" ;;
  esac
  sums "$out/before/$name" >"$out/before/$name.sums"
  sums "$out/after/$name" >"$out/after/$name.sums"
  files=$(wc -l <"$out/before/$name.sums")
  [ "$files" -gt 0 ] || { echo "same_bytes: $out/before/$name has no files" >&2; exit 1; }
  different=$(sort "$out/before/$name.sums" "$out/after/$name.sums" | uniq -u | cut -f1 | sort -u)
  printf '%-24s %6d %10d  %s\n' "$name" "$files" "$(grep -c . <<<"$different" || true)" "$(sha256sum <"$out/before/$name.sums" | cut -c1-16)"
  [ -z "$different" ] || { sed 's/^/    differs or is missing: /' <<<"$different"; failed=1; }
done
[ $failed = 0 ] && echo "the same bytes" || echo "NOT the same bytes"
exit $failed
