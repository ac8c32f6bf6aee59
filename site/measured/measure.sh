#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures everything that README.md and the site say, and writes it there: studies, variants of the character, benches,
# then collect.mjs and fill.mjs. Keep the machine quiet meanwhile, for the sake of the times.
# Run it again to go on where it was stopped; remove build/measured to measure anew.
set -euo pipefail
usage() {
  cat <<'TXT'
bash site/measured/measure.sh [options]
  --quick         the sample's study in its quick form, neither the virtual studio nor variants: for a first look
  --before FILE   an earlier figures.json: the page then lists what got worse
TXT
}
quick='' before=()
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=--quick ;;
    --before) before=(--before "$(realpath -e "${2:?"--before needs a file"}")"); shift ;;
    -h|--help) usage; exit 0 ;;
    *) echo "site/measured/measure.sh: unknown option $1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
cd "$(dirname "$0")/../.."
tool=build/release/native/tools/fourdvt sample=site/sample/actor_a out=build/measured
bench=$out/bench character=$out/character
. site/steps.sh

# What NAME prints, kept as NAME.txt; a bench that was run is not run again. A bench that misses its own goal fails, and
# is still shown; collect.mjs refuses the text of one that printed no figure.
bench() {
  local name=$1; shift
  [ -e "$bench/$name.txt" ] && return
  step "Bench $name"
  "$@" | tee "$bench/$name.part" || echo "bench $name failed"
  mv "$bench/$name.part" "$bench/$name.txt"
}

# A character with other settings, without the class, and its scores at the held-out cameras.
variant() {
  local folder=$out/$1; shift
  [ -e "$folder/scores/evaluate.csv" ] && return
  step "Variant $*"
  "$tool" bake "$sample" -o "$folder/character" --no-classes "$@"
  "$tool" evaluate "$sample" --character "$folder/character" --flicker 0 -o "$folder/scores"
}

mkdir -p build
install_packages "${page_packages[@]}" "${test_packages[@]}"
bash site/demo.sh --prepare
step "Building the benches"
quiet cmake-tests cmake --preset release -DFOURDVT_TESTS=ON
build build-benches build/release bench_draw_ratio bench_blend_ratio repeat_capture fourdvt
quiet build-class-frame env NODE_PATH=/usr/share/nodejs cmake --build build/wasm --target bench_class_frame
build=$(sha256sum "$tool" | cut -d' ' -f1)
if [ "$(cat "$out/build" 2>/dev/null)" != "$build" ]; then  # another build's figures; a study looks after its own
  rm -rf "$bench" "$character" "$out/high" "$out/crf31" "$out/studio"
fi
mkdir -p "$bench"
echo "$build" >"$out/build"

# The page's character is baked beside other builds; this one's time is a figure.
step "Baking the character on a quiet machine"
[ -e "$character/character.gltf" ] || "$tool" bake "$sample" -o "$character"

bench draw_ratio build/release/tests/bench/bench_draw_ratio "$character"
bench blend_ratio build/release/tests/bench/bench_blend_ratio
bench class_frame node build/wasm/tests/bench/wasm/bench_class_frame.js "$character"
bench bake_memory bash tests/bench/bake_memory.sh "$tool" build/release/tests/package/repeat_capture "$sample" 5
bench parity env FOURDVT_SITE="$PWD/build/site" FOURDVT_CHARACTER="$PWD/build/character" FOURDVT_BIN="$PWD/$tool" \
  FOURDVT_OUT="$PWD/build/web-tests" node --test tests/web/parity.test.mjs

more=()
if [ -z "$quick" ]; then
  variant high --quality high
  variant crf31 --crf 31
  step "The virtual studio"
  [ -e "$out/studio/capture.json" ] || "$tool" studio --actor procedural --drift-mm 12 -o "$out/studio"
  "$tool" evaluate "$out/studio" -o "$out/truth"
  more=(--truth "$out/truth" --variant "high=$out/high" --variant "crf31=$out/crf31")
fi
study=$out/study${quick:+-quick}
step "The sample"
"$tool" evaluate "$sample" -o "$study" $quick

step "Writing the figures"
node site/measured/collect.mjs --study "$study" --character "$character" --player web/dist --bench "$bench" \
  ${more[@]+"${more[@]}"} ${before[@]+"${before[@]}"}
node site/measured/fill.mjs
