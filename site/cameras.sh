#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# cameras.sh FOURDVT CAPTURE OUT STAMP: characters from cameras of the sample's run, OUT/{hull,refined,tracked}: on its
# visual hull, on the hull refined by stereo (quicker and coarser than by default), and on its own tracked mesh. Does
# nothing if OUT was made with this STAMP by this script.
set -euo pipefail
tool=$1 capture=$2 out=$3
stamp="$4 $(sha256sum <"$0" | cut -d' ' -f1)"

if [ "$(cat "$out.stamp" 2>/dev/null)" = "$stamp" ] && [ -d "$out" ]; then
  echo "unchanged: $out"
  exit 0
fi
work=$out.work
rm -rf "$work" "$out" "$out.stamp"
mkdir -p "$work/made"
"$tool" reconstruct "$capture" -o "$work/hull" --sequences run --hull polyhedral
"$tool" reconstruct "$capture" -o "$work/refined" --sequences run --voxel-mm 8 --planes 24
for surface in hull refined; do "$tool" bake "$work/$surface" -o "$work/made/$surface" --sequences run --crf 30; done
"$tool" bake "$capture" -o "$work/made/tracked" --sequences run --appearance cameras --no-classes \
  --refine-cameras off --crf 30
mv "$work/made" "$out"
rm -rf "$work"
echo "$stamp" >"$out.stamp"
