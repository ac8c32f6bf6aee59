# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. The virtual studio, where the appearance drifts by 12 mm over the mesh: what lies between two
# motions is known there, and only that is measured.
make_studio() {
  rm -rf "$folder/studio.part"
  "$lab" studio --actor procedural --drift-mm 12 -o "$folder/studio.part"
  mv "$folder/studio.part" "$folder/studio"
}
once "$folder/studio" make_studio
"$lab" study "$folder/studio" -o "$folder/report" --steps labels,motion
