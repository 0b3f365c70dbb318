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
    --user-data-dir="$out/profile" --enable-logging=stderr --v=0 --virtual-time-budget=60000 \
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

# What a hand does: hover until a point says what it is, drag a rectangle, choose another error.
cat >"$out/hand.html" <<'END'
<script>
addEventListener('load', async () => {
  const said = document.documentElement.dataset, over = document.querySelector('.u-over');
  const box = over.getBoundingClientRect(), tip = document.querySelector('.tip');
  const mouse = (kind, x, y, on) => {
    on.dispatchEvent(new MouseEvent(kind, { bubbles: true, view: window, button: 0, movementX: 9, movementY: 9,
      clientX: box.left + x, clientY: box.top + y }));
    return new Promise(then => setTimeout(then, 40));
  };
  const drawn = () => document.querySelector('canvas').toDataURL();
  await mouse('mouseenter', 1, 1, over);
  for (let x = 10; x < box.width && !said.tip; x += 40)
    for (let y = 10; y < box.height && !said.tip; y += 40) {
      await mouse('mousemove', x, y, over);
      if (tip.style.display === 'block') said.tip = tip.textContent;
    }
  const before = drawn();
  await mouse('mousedown', 100, 100, over);
  await mouse('mousemove', 200, 200, over);
  await mouse('mousemove', 300, 250, over);
  await mouse('mouseup', 300, 250, document);
  said.zoomed = before !== drawn();
  const select = document.querySelector('.chart select');
  select.value = 'T';
  select.dispatchEvent(new Event('change'));
  await mouse('mousemove', 1, 1, over);
  said.chosen = document.querySelectorAll('.uplot').length;
});
</script>
END

if [ -f "$(dirname "$brume")/share/brume/uplot/uPlot.iife.min.js" ]; then
  study uplot
  look uplot
  grep -q 'data-charts="uplot"' "$out/uplot.dom" || fail "uplot: the charts were not made"
  grep -q 'class="uplot' "$out/uplot.dom" || fail "uplot: no uPlot in the page"
  grep -q 'Leon Sorokin' "$out/uplot/report.html" || fail "uplot: its licence is missing"
  mkdir -p "$out/hand"
  cat "$out/uplot/report.html" "$out/hand.html" >"$out/hand/report.html"
  look hand
  tr '\n' ' ' <"$out/hand.dom" | grep -q 'data-tip="[^"]*for the frame'  || fail "hand: hovering says nothing"
  grep -q 'data-zoomed="true"' "$out/hand.dom" || fail "hand: dragging does not zoom"
  grep -q 'data-chosen="1"' "$out/hand.dom" || fail "hand: no chart of another error"
  echo "uPlot draws; screenshots in $out"
else
  echo "built without uPlot: only the static page was tested"
fi
