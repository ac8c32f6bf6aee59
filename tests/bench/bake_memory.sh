#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# bake_memory.sh FOURDVT REPEAT_CAPTURE CAPTURE [TIMES]: peak resident memory of baking one sequence, and the same
# sequence repeated, with their ratio. Exit code 1 if it is 1.15 or more.
set -euo pipefail
[ $# -ge 3 ] || { echo "usage: bake_memory.sh FOURDVT REPEAT_CAPTURE CAPTURE [TIMES]" >&2; exit 2; }
fourdvt=$1 repeat=$2 capture=$3 times=${4:-10} sequence=walk
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
peak() {  # CAPTURE NAME → bytes
  "$fourdvt" bake "$1" -o "$scratch/$2" --sequences "$sequence" >"$scratch/$2.log" 2>&1 || { cat "$scratch/$2.log" >&2; exit 1; }
  sed -n 's/.*"peak_rss_bytes": *\([0-9]*\).*/\1/p' "$scratch/$2.report/report.json"
}
frames() { sed -n 's/^ *"frames": *\([0-9]*\).*/\1/p' "$scratch/$1.report/report.json" | head -1; }
"$repeat" "$capture" "$sequence" "$times" "$scratch/capture"
once=$(peak "$capture" once)
many=$(peak "$scratch/capture" many)
awk -v a="$once" -v b="$many" -v fa="$(frames once)" -v fb="$(frames many)" 'BEGIN {
  printf "%d frames %.1f MB, %d frames %.1f MB, ratio %.3f\n", fa, a / 1e6, fb, b / 1e6, b / a
  exit b / a < 1.15 ? 0 : 1
}'
