#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# readme_paths.sh ROOT: every relative link of every document must lead to a file, and every path in backquotes that
# begins with a folder of the tree must exist. Anchors behind a # are checked by docs.test.mjs.
set -u
cd "$1" || exit 2
bad=0 links=0 paths=0 documents=0
complain() { echo "$*"; bad=1; }

while read -r doc; do
  documents=$((documents + 1))
  here=$(dirname "$doc")
  while read -r target; do
    links=$((links + 1))
    [ -e "$here/$target" ] || complain "$doc links to $target, which does not exist"
  done < <(sed '/^```/,/^```/d' "$doc" | grep -oE '\]\([^)#:[:space:]]+' | sed 's/^](//' | sort -u)
  while read -r path; do
    case $path in web/dist/* | site/fourdvt-viewer/*) continue ;; esac  # made by a build
    paths=$((paths + 1))
    [ -e "$path" ] || complain "$doc names $path, which does not exist"
  done < <(grep -oE '`(native|shaders|site|tests|wasm|web|\.github|\.ci)/[A-Za-z0-9_./-]*`' "$doc" | tr -d '`' | sort -u)
done < <(find . \( -name node_modules -o -name build -o -name dist -o -name .git \) -prune -o -name '*.md' -print | sed 's,^\./,,' | sort)

[ "$documents" -ge 10 ] || complain "only $documents documents found: the check looks in the wrong place"
[ "$links" -ge 40 ] || complain "only $links links found: the check looks in the wrong place"
[ "$(wc -w <README.md)" -le 900 ] || complain "README.md has $(wc -w <README.md) words; 900 are allowed: move text to site/docs/"
echo "$links links and $paths paths checked in $documents documents"
exit $bad
