#!/usr/bin/env bash
# Golden frames (frames.txt): what each stage made of a small frame, so that no change goes unseen.
#   golden.sh BRUME                        compares; exit 1 where one differs, with what and where
#   golden.sh BRUME --update WHY [NAME...] redraws those that differ (or those named) and writes down why
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
brume=$(readlink -f "$1")
shift
cd "$here/../.."
update='' why='' names=' '
if [ "${1:-}" = --update ]; then
  why=${2:-}
  [ -n "$why" ] || { echo "golden: --update wants a reason: --update \"why\"" >&2; exit 2; }
  update=yes
  shift 2
  [ $# -eq 0 ] || names=" $* "
elif [ $# -gt 0 ]; then
  echo "golden: $1? only --update WHY [NAME...]" >&2
  exit 2
fi

new=$(mktemp -d)
trap 'rm -r "$new"' EXIT
failed=0 redrawn=''
while read -r name scene frame every layers limit; do
  case $name in '' | '#'*) continue ;; esac
  file=tests/golden/$name.exr
  layers=(--aovs "${layers/#-/}")
  "$brume" apply "$scene" "$frame" -o "$new/$name.exr" -q --proxy "$every" --compression zip \
    "${layers[@]}" --set output.aov_type=half
  compare=("$brume" diff "$file" "$new/$name.exr" --fail "$limit" --relative 1 --ignore-attributes 'brume/*')
  if [ -z "$update" ]; then
    if [ ! -f "$file" ]; then
      echo "$name: no golden frame yet: ./run golden --update \"why\" $name"
      failed=1
    elif ! said=$("${compare[@]}"); then
      printf '%s: not what it was (%s, limit %s)\n%s\n' "$name" "$file" "$limit" "$said"
      failed=1
    fi
  elif [ "$names" = ' ' ] && [ -f "$file" ] && "${compare[@]}" >/dev/null; then
    continue
  elif [ "$names" = ' ' ] || [[ $names == *" $name "* ]]; then
    cp "$new/$name.exr" "$file"
    redrawn+="${redrawn:+, }$name"
  fi
done <tests/golden/frames.txt

if [ -n "$redrawn" ]; then
  printf -- '- %s: %s: %s\n' "$(date +%F)" "$redrawn" "$why" >>tests/golden/HISTORY.md
  echo "redrawn: $redrawn"
elif [ -n "$update" ]; then
  echo "nothing to redraw"
fi
exit $failed
