#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# cameras.sh FOURDVT CAPTURE OUT STAMP: characters from cameras of the sample's run, OUT/{hull,refined,tracked}: on its
# visual hull, on the hull refined by stereo (quicker and coarser than by default), and on its own tracked mesh. Does nothing if OUT was made with this STAMP.
set -euo pipefail
tool=$1 capture=$2 out=$3 stamp=$4

if [ "$(cat "$out.stamp" 2>/dev/null)" = "$stamp" ] && [ -e "$out/tracked/character.gltf" ]; then
  echo "unchanged: $out"
  exit 0
fi
mkdir -p "$out"
work=$out.work
rm -rf "$work"
mkdir -p "$work"
"$tool" reconstruct "$capture" -o "$work/hull" --sequences run --hull polyhedral
"$tool" reconstruct "$capture" -o "$work/refined" --sequences run --voxel-mm 8 --planes 24
for surface in hull refined; do "$tool" bake "$work/$surface" -o "$out/$surface" --sequences run --crf 30; done
"$tool" bake "$capture" -o "$out/tracked" --sequences run --appearance cameras --no-classes --refine-cameras off --crf 30
rm -rf "$work"
echo "$stamp" >"$out.stamp"
