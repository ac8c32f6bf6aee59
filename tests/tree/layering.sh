#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# layering.sh ROOT: a file may include only folders at or below its own; every folder of native/ has its place here.
# Also: only one file calls gl*, and platform #ifdefs stay in wasm/ and native/platform/.
set -u
cd "$1" || exit 2
bad=0
complain() { echo "$*"; bad=1; }

# Folder: what it may include besides itself. Bottom → top; a folder may name only folders that stand above it in this
# list, so that there are no circles.
declare -A allowed
order=()
layer() { order+=("$1"); allowed[$1]="${*:2}"; }
core="base gpu package package/coding motion render render/flow render/fields render/cameras render/styles render/montage stream player player/parts"
layer base
layer gpu base
layer package base
layer package/coding base package
layer motion base package
layer render/flow base gpu
layer render base gpu package render/flow
layer render/fields base gpu package render
layer render/cameras base gpu package render render/fields render/flow
layer render/styles base gpu render
layer render/montage base gpu render render/fields
layer stream base package package/coding
layer player/parts base gpu package package/coding motion render render/flow stream
layer player base gpu package motion render render/flow stream player/parts
layer platform base
layer edge $core platform
layer capture base
layer refine base capture
layer reconstruct base capture
layer reconstruct/stereo base gpu reconstruct
layer report base platform
layer reconstruct/run base gpu platform capture report reconstruct reconstruct/stereo
layer bake/labels base package
layer bake/texels base gpu package
layer bake/room base package
layer bake/motion base package motion capture
layer bake/align base gpu package render
layer bake/cameras base package
layer bake/video base package
layer bake/run base gpu package motion platform capture refine bake/labels bake/texels bake/motion bake/cameras bake/video
layer bake/stages base gpu package motion render render/cameras platform capture refine report bake/labels bake/texels bake/room bake/motion bake/align bake/cameras bake/video bake/run
layer bake base platform report bake/labels bake/texels bake/video bake/run bake/stages
bake_all="bake bake/labels bake/texels bake/room bake/motion bake/align bake/cameras bake/video bake/run bake/stages"
layer tools $core platform edge capture refine reconstruct/run report $bake_all
# The lab stands above the product; nothing of the product includes it.
layer lab/labels base gpu bake/labels bake/texels bake/run
layer lab/measure base gpu package render render/cameras player platform edge capture report
layer lab/studio/actors base platform
layer lab/studio base gpu platform capture lab/studio/actors
layer lab/study/run $core platform edge capture refine report $bake_all lab/measure
layer lab/study/tables base report lab/study/run
layer lab/study/steps $core platform edge capture report $bake_all lab/labels lab/measure lab/study/run lab/study/tables
layer lab/study/motion $core platform edge capture report $bake_all lab/measure lab/study/run lab/study/tables
layer lab/study/projective $core platform edge capture report reconstruct/run bake/texels bake/cameras lab/measure lab/studio lab/study/run lab/study/tables
layer lab/study base platform capture refine report $bake_all lab/study/run lab/study/tables lab/study/steps lab/study/motion lab/study/projective
layer lab/tools base package player render render/cameras platform edge capture bake/labels bake/run tools lab/labels lab/measure lab/studio lab/study lab/study/run lab/study/projective

declare -A seen
for folder in "${order[@]}"; do
  [ -d "native/$folder" ] || complain "this list names native/$folder, which does not exist"
  for below in ${allowed[$folder]}; do
    [ -n "${allowed[$below]+x}" ] || complain "$folder may include $below, which has no place in this list"
    [ -n "${seen[$below]+x}" ] || complain "$folder may include $below, which stands above it: a circle"
  done
  seen[$folder]=1
done
while read -r folder; do
  [ -n "${allowed[$folder]+x}" ] || complain "native/$folder has no place in the layering: name it in tests/tree/layering.sh"
done < <(find native -name '*.cpp' -o -name '*.h' | sed -E 's,^native/,,; s,/[^/]*$,,' | sort -u)

includes=0
while IFS=: read -r file include; do
  includes=$((includes + 1))
  folder=$(dirname "${file#native/}") below=$(dirname "$include")
  [[ $below == draco* ]] && continue
  [ "$below" != . ] || { complain "$file includes \"$include\" without its folder"; continue; }
  [ "$folder" = "$below" ] || [[ " ${allowed[$folder]-} " == *" $below "* ]] || complain "$file includes $below/, which is not below native/$folder"
done < <(grep -rHoE '^#include "[^"]+"' native --include='*.cpp' --include='*.h' | sed -E 's/#include "(.*)"/\1/')
[ "$includes" -gt 500 ] || complain "only $includes includes found: the check looks in the wrong place"

if grep -nE '\bgl[A-Z][A-Za-z0-9]*\(' native -r --include='*.cpp' --include='*.h' | grep -v '^native/gpu/gles_device.cpp' | grep -vE ':\s*//' | grep -v '/platform/egl_context'; then
  complain "gl* is called outside native/gpu/gles_device.cpp"
fi
if grep -rn '__EMSCRIPTEN__' native --include='*.cpp' --include='*.h' | grep -v '^native/platform/'; then
  complain "platform #ifdef outside wasm/ and native/platform/"
fi
echo "$includes includes checked in ${#order[@]} folders"
exit $bad
