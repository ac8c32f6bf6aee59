# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. Surfaces of the sample's run.
node tests/bench/hulls.mjs "$tool" "$lab" "$sample" "$folder" run
