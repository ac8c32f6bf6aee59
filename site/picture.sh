#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# picture.sh [FOURDVT [CHARACTER]]: makes site/viewer.webp, README's moving picture: the sample walks four loops while the
# camera goes round once. Needs the baked sample (site/demo.sh) and ffmpeg.
set -euo pipefail
cd "$(dirname "$0")/.."
tool=${1:-build/release/native/tools/fourdvt} character=${2:-build/character}
movie=$(mktemp --suffix .mp4)
trap 'rm -f "$movie"' EXIT
"$tool" render "$character" --sequence walk --turntable "$movie" --seconds 4.48 --size 480x640 --azimuth 20 --elevation 6 \
  --background f1efec
ffmpeg -nostdin -v error -y -i "$movie" -vf 'fps=12.5,crop=352:592:64:24,scale=320:-2:flags=lanczos' -c:v libwebp_anim -quality 76 \
  -compression_level 6 -loop 0 site/viewer.webp
ls -l site/viewer.webp
