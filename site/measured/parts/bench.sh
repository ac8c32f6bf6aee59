# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. The character at its defaults and two variants without the class, with their scores at the
# held-out cameras; ratios of times; memory; native pictures against the browser's.
variant() {
  local name=$1; shift
  once "$folder/$name/character/character.gltf" "$tool" bake "$sample" -o "$folder/$name/character" --no-classes "$@"
  once "$folder/$name/scores/evaluate.csv" \
    "$lab" score "$folder/$name/character" --capture "$sample" --flicker 0 --input-every 0 -o "$folder/$name/scores"
}

# The page's character is baked beside other builds; this one's time is a figure.
once "$folder/character/character.gltf" "$tool" bake "$sample" -o "$folder/character"
variant high --quality high
variant crf31 --crf 31
printed draw_ratio build/release/tests/bench/bench_draw_ratio "$folder/character"
printed blend_ratio build/release/tests/bench/bench_blend_ratio
printed class_frame node build/wasm/tests/bench/wasm/bench_class_frame.js "$folder/character"
printed bake_memory bash tests/bench/bake_memory.sh "$tool" build/release/tests/package/repeat_capture "$sample" 5
printed parity env FOURDVT_SITE="$PWD/build/site" FOURDVT_CHARACTER="$PWD/build/character" FOURDVT_BIN="$tool" \
  FOURDVT_OUT="$PWD/build/web-tests" node --test tests/web/parity.test.mjs
