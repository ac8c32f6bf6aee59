# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. Methods on the motions that no constant was chosen on, from two test frames of each (12 views) where
# a method is chosen and one elsewhere; and the demo's characters after the codec.
once "$folder/characters.stamp" bash site/cameras.sh "$tool" "$sample" "$folder/characters" "$inputs"
node tests/bench/methods.mjs "$lab" "$sample" "$folder" run,pickup 2 1 "$folder/characters"
