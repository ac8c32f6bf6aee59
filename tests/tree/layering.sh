#!/usr/bin/env bash
# Portable folders may include only folders below them, and only one file may call gl*.
set -u
cd "$1"
bad=0
order=(base gpu package motion render stream player)
for i in "${!order[@]}"; do
  allowed=" ${order[*]:0:$((i + 1))} "
  [ "${order[$i]}" != package ] || allowed=" base package draco "
  [ "${order[$i]}" != motion ] || allowed=" base package motion "
  while IFS=: read -r file include; do
    folder=$(sed -E 's/.*"([a-z]+)\/.*/\1/' <<<"$include")
    [[ $allowed == *" $folder "* ]] || { echo "$file includes $folder/, which is not below ${order[$i]}/"; bad=1; }
  done < <(grep -HoE '#include "[a-z]+/[^"]+"' "native/${order[$i]}"/*.cpp "native/${order[$i]}"/*.h)
done
if grep -nE '\bgl[A-Z][A-Za-z0-9]*\(' native -r --include='*.cpp' --include='*.h' | grep -v '^native/gpu/gles_device.cpp' | grep -vE ':\s*//' | grep -v '/platform/egl_context'; then
  echo "gl* is called outside native/gpu/gles_device.cpp"; bad=1
fi
if grep -rn '__EMSCRIPTEN__' native --include='*.cpp' --include='*.h' | grep -v '^native/platform/'; then
  echo "platform #ifdef outside wasm/ and native/platform/"; bad=1
fi
exit $bad
