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
layer platform $core
layer capture base
layer studio/actors base platform
layer refine base capture
layer reconstruct base capture
layer reconstruct/stereo base gpu reconstruct
layer studio base gpu platform capture studio/actors
layer report base platform
layer measure base gpu package render render/cameras player platform capture report
layer reconstruct/run base gpu platform capture report measure reconstruct reconstruct/stereo
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
layer study/run $core platform capture refine report measure $bake_all
layer study/tables base report study/run
layer study/steps $core platform capture report measure $bake_all study/run study/tables
layer study/motion $core platform capture report measure $bake_all study/run study/tables
layer study/projective $core platform capture studio report measure reconstruct/run bake/texels bake/cameras study/run study/tables
layer study base platform capture refine report $bake_all study/run study/tables study/steps study/motion study/projective
layer tools $core platform capture refine reconstruct/run studio studio/actors report measure $bake_all study study/run study/projective

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
