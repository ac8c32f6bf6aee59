#!/usr/bin/env bash
# Every path that README.md or FORMAT.md names in backquotes or links to must exist.
set -u
cd "$1"
bad=0 seen=0
for doc in README.md native/package/FORMAT.md; do
  here=$(dirname "$doc")
  for p in $( { grep -oE '`[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]*)+`' "$doc" | tr -d '`'
                grep -oE '\]\([^)#:]+\)' "$doc" | sed 's/^](//; s/)$//'; } | sort -u); do
    case $p in build/*|character/*) continue ;; esac
    seen=$((seen + 1))
    [ -e "$p" ] || [ -e "$here/$p" ] || { echo "$doc names $p, which does not exist"; bad=1; }
  done
done
[ "$seen" -gt 0 ] || { echo "no path found to check"; bad=1; }
echo "$seen paths checked"
exit $bad
