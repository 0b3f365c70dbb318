#!/usr/bin/env bash
# The page of brume study in headless Chromium, with uPlot (where it was found) and without: charts are
# there, nothing is fetched, no script fails. Screenshots stay in the build folder's study_page/.
set -euo pipefail
brume=$1 data=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) ||
  { echo "no Chromium here: skipped"; exit 77; }
out=$PWD/study_page
rm -rf "$out"
mkdir -p "$out"
export HOME=$out/home XDG_CONFIG_HOME=$out/home XDG_CACHE_HOME=$out/home

fail() { echo "FAILED: $*"; exit 1; }

look() {  # NAME: page NAME.html into NAME.png, its document and what it logged beside it
  local page=$out/$1/report.html
  timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --hide-scrollbars \
    --user-data-dir="$out/profile" --enable-logging=stderr --v=0 --virtual-time-budget=4000 \
    --window-size=1100,1700 --screenshot="$out/$1.png" --dump-dom "file://$page" >"$out/$1.dom" 2>"$out/$1.log" ||
    fail "$1: the browser"
  [ -s "$out/$1.png" ] || fail "$1: no screenshot"
  if grep -E 'CONSOLE.*(rror|Uncaught)' "$out/$1.log"; then fail "$1: a script failed"; fi
  # Offline: nothing but what it carries.
  if sed 's/<pre>.*<\/pre>//' "$page" | grep -oE '(src|href)=.?(https?:)?//[^ >]*|@import|url\(.?http[^)]*' | head -3 | grep .; then
    fail "$1: it asks the network"
  fi
  grep -q "<canvas\|<svg" "$out/$1.dom" || fail "$1: no chart"
  grep -q 'src="data:image/png;base64,iVBOR' "$out/$1.dom" || fail "$1: no picture"
}

study() {  # NAME [ENVIRONMENT...]
  local name=$1
  shift
  env "$@" "$brume" study "$data/scenes/fog.toml" "$data/valley_validation_480x270.exr" \
    -o "$out/$name/report.html" --seconds 2 --repeats 3
  [ -s "$out/$name/study.csv" ] && [ -s "$out/$name/study.json" ] || fail "$name: no data beside it"
}

study static BRUME_UPLOT=/nonexistent
look static
grep -q 'data-charts="uplot"' "$out/static.dom" && fail "static: uPlot out of nowhere"
grep -q '<svg' "$out/static.dom" || fail "static: no chart"

if [ -f "$(dirname "$brume")/share/brume/uplot/uPlot.iife.min.js" ]; then
  study uplot
  look uplot
  grep -q 'data-charts="uplot"' "$out/uplot.dom" || fail "uplot: the charts were not made"
  grep -q 'class="uplot' "$out/uplot.dom" || fail "uplot: no uPlot in the page"
  grep -q 'Leon Sorokin' "$out/uplot/report.html" || fail "uplot: its licence is missing"
  echo "uPlot draws; screenshots in $out"
else
  echo "built without uPlot: only the static page was tested"
fi
