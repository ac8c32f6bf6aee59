#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# layering.sh ROOT: a file may include only folders that native/layering.txt allows its folder; every folder of native/
# has a line there. The product may not include the lab.
# Also: only one file calls gl*, and platform #ifdefs stay in wasm/ and native/platform/.
set -u
cd "$1" || exit 2
bad=0
complain() { echo "$*"; bad=1; }

# native/layering.txt: "folder: what it may include", bottom → top; groups as "@name: folders"; the line "flow:" is for the
# picture of the documents alone.
declare -A allowed groups
order=()
while IFS=: read -r name rest; do
  case $name in '' | '#'* | flow) continue ;; esac
  words=()
  for word in $rest; do
    if [[ $word != @* ]]; then words+=("$word")
    elif [ -n "${groups[$word]+x}" ]; then words+=(${groups[$word]})
    else complain "native/layering.txt: $name names the group $word, which no line above defines"
    fi
  done
  if [[ $name == @* ]]; then groups[$name]="${words[*]}"
  elif [ -n "${allowed[$name]+x}" ]; then complain "native/layering.txt has two lines for $name"
  else order+=("$name") allowed[$name]="${words[*]}"
  fi
done < native/layering.txt

declare -A seen
for folder in "${order[@]}"; do
  [ -d "native/$folder" ] || complain "native/layering.txt names native/$folder, which does not exist"
  for below in ${allowed[$folder]}; do
    [ -n "${allowed[$below]+x}" ] || complain "$folder may include $below, which has no line in native/layering.txt"
    [[ $folder == lab/* || $below != lab/* ]] || complain "$folder is of the product and may not include $below"
    [ -n "${seen[$below]+x}" ] || complain "$folder may include $below, whose line stands below: a circle"
  done
  seen[$folder]=1
done
while read -r folder; do
  [ -n "${allowed[$folder]+x}" ] || complain "native/$folder has no line in native/layering.txt: add one"
done < <(find native -name '*.cpp' -o -name '*.h' | sed -E 's,^native/,,; s,/[^/]*$,,' | sort -u)

includes=0
while IFS=: read -r file include; do
  includes=$((includes + 1))
  folder=${file#native/} folder=${folder%/*} below=${include%/*}
  [[ $below == draco* ]] && continue
  [ "$below" != "$include" ] || { complain "$file includes \"$include\" without its folder"; continue; }
  [ "$folder" = "$below" ] || [[ " ${allowed[$folder]-} " == *" $below "* ]] || complain "$file includes $below/, which is not below native/$folder"
done < <(grep -rHoE '^#include "[^"]+"' native --include='*.cpp' --include='*.h' | sed -E 's/#include "(.*)"/\1/')
[ "$includes" -gt 500 ] || complain "only $includes includes found: the check looks in the wrong place"

if grep -nE '\bgl[A-Z][A-Za-z0-9]*\(' native -r --include='*.cpp' --include='*.h' | grep -v '^native/gpu/gles_[a-z_]*.cpp' | grep -vE ':\s*//' | grep -v '/platform/egl_context'; then
  complain "gl* is called outside native/gpu/gles_*.cpp"
fi
if grep -rn '__EMSCRIPTEN__' native --include='*.cpp' --include='*.h' | grep -v '^native/platform/'; then
  complain "platform #ifdef outside wasm/ and native/platform/"
fi
echo "$includes includes checked in ${#order[@]} folders"
exit $bad
