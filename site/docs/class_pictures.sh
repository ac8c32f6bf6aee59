#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# class_pictures.sh [FOURDVT [CHARACTER]]: makes the pictures of native/capture/CLASSES.md, site/docs/classes/*.webp. Needs the baked
# sample (site/demo.sh), ffmpeg and the font DejaVu Sans.
set -euo pipefail
cd "$(dirname "$0")/../.."
tool=${1:-build/release/native/tools/fourdvt} character=${2:-build/character}
parts=$(mktemp -d)
trap 'rm -rf "$parts"' EXIT
mkdir -p site/docs/classes

draw() {
  "$tool" render "$character" -o "$parts/whole.png" --elevation 5 --size 360x480 --background 191919 --quiet "${@:2}"
  ffmpeg -nostdin -v error -y -i "$parts/whole.png" -vf crop=230:440:65:30 "$parts/$1.png"
}

# Sets pictures side by side, each with its label: NAME, then pairs of a part and a label.
row() {
  local name=$1 inputs=() filter='' count=0
  shift
  while [ $# -gt 0 ]; do
    inputs+=(-i "$parts/$1.png")
    filter+="[$count:v]pad=iw+6:ih+30:3:26:0x191919,drawtext=font='DejaVu Sans':fontsize=15:fontcolor=0xe8e8e8:x=5:y=5:text='$2'[p$count];"
    count=$((count + 1))
    shift 2
  done
  for ((i = 0; i < count; ++i)); do filter+="[p$i]"; done
  ffmpeg -nostdin -v error -y "${inputs[@]}" -filter_complex "${filter}hstack=inputs=$count" -c:v libwebp -quality 80 "site/docs/classes/$name.webp"
}

for speed in 1.22 1.74 2.26 2.78; do draw "at-$speed" --class locomotion --parameter "speed_mps=$speed" --phase 0.3 --azimuth 60; done
row speeds at-1.22 '1.2 m/s, filmed' at-1.74 '1.7 m/s, made' at-2.26 '2.3 m/s, made' at-2.78 '2.8 m/s, filmed'

# Layer 1 of the highest rendition of a motion: its texture.
texture() {
  local video
  video=$(find "$character" -name "$1.????????.mp4")
  ffmpeg -nostdin -v error -y -i "$video" -vf "select=eq(n\,$2),crop=1024:1024:0:0,scale=300:300" -frames:v 1 "$parts/$1.png"
}
texture walk 8
texture run 6
row texture walk 'walk, frame 8' run 'run, frame 6'
ls -l site/docs/classes
