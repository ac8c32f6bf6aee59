#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# cameras.sh FOURDVT CAPTURE OUT STAMP: characters from cameras of the sample's run, OUT/{hull,refined,tracked}: on its
# visual hull, on the hull refined by stereo (quicker and coarser than by default), and on its own tracked mesh; and
# OUT/steered, a character from layers that walks and runs on one mesh tracked through the refined hulls. OUT.reports has
# their reports. Does nothing if OUT was made with this STAMP by this script.
# cameras.sh --is-made OUT STAMP: succeeds if there is nothing to do.
set -euo pipefail
# Its own sources and those of the surfaces; STAMP has the bake's.
made_by=$({ cat "$0"; node "$(dirname "$0")/bake_stamp.mjs" reconstruct/run track/run; } | sha256sum | cut -d' ' -f1)
is_made() { [ "$(cat "$1.stamp" 2>/dev/null)" = "$2 $made_by" ] && [ -d "$1" ]; }
if [ "$1" = --is-made ]; then
  is_made "$2" "$3"
  exit
fi
tool=$1 capture=$2 out=$3
if is_made "$out" "$4"; then
  echo "unchanged: $out"
  exit 0
fi
work=$out.work
rm -rf "$work" "$out" "$out.stamp"
mkdir -p "$work/made"
"$tool" reconstruct "$capture" -o "$work/hull" --sequences run --hull polyhedral
"$tool" reconstruct "$capture" -o "$work/refined" --sequences walk,run --voxel-mm 8 --planes 24
"$tool" bake "$work/hull" -o "$work/made/hull" --sequences run --crf 30
# The others are drawn by the method measured for the hull: measuring it again would take most of their time.
method=$(node -p 'JSON.parse(require("fs").readFileSync(process.argv[1], "utf8")).extensions.FOURDVT_layered_video_texture.method.name' \
  "$work/made/hull/character.gltf")
"$tool" bake "$work/refined" -o "$work/made/refined" --sequences run --crf 30 --method "$method"
"$tool" bake "$capture" -o "$work/made/tracked" --sequences run --appearance cameras --no-classes \
  --refine-cameras off --crf 30 --method "$method"
"$tool" track "$work/refined" -o "$work/steered" --class locomotion:speed_mps=walk,run
"$tool" bake "$work/steered" -o "$work/made/steered" --quality draft --renditions highest
rm -rf "$out.reports"
mkdir "$out.reports"
mv "$work/made/"*.report "$out.reports"
mkdir "$out.reports/steered.track"
mv "$work/steered/track"* "$out.reports/steered.track"
mv "$work/made" "$out"
rm -rf "$work"
echo "$4 $made_by" >"$out.stamp"
