# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. Characters from cameras of the sample's run.
node tests/bench/cameras.mjs "$tool" "$lab" "$sample" "$folder"
