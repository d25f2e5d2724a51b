#!/usr/bin/env bash
# From a fresh clone to the trainer: in a window if there is a display, otherwise as pictures and a report under out/.
set -euo pipefail
usage='Usage: demo.sh [--headless] [options of hysteroscopy]
       demo.sh --bunny [--headless] [options of filasofia run bunny]'
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

headless=no bunny=no options=()
for word in "$@"; do
  case $word in
    --headless) headless=yes ;;
    --bunny) bunny=yes ;;
    -h | --help) echo "$usage"; exit 0 ;;
    *) options+=("$word") ;;
  esac
done

"$root/scripts/setup.sh" --run
headline "build"
configure release
build release --target filasofia hysteroscopy
program=$root/build/release/bin/filasofia
trainer=$root/build/release/bin/hysteroscopy

# A named display may not answer (ssh, sudo), and the renderer needs an X11 display.
window_opens() {
  [ -n "${DISPLAY:-}" ] && WAYLAND_DISPLAY='' "$program" doctor --json - |
    python3 -c 'import json, sys; sys.exit(not json.load(sys.stdin)["display"]["a_window_can_open"]["value"])'
}
[ $headless = yes ] || window_opens || headless=yes

if [ $headless = no ] && [ $bunny = yes ]; then
  headline "the bunny, in a window (Escape ends it)"
  exec "$program" run bunny "${options[@]}"
elif [ $headless = no ]; then
  headline "the hysteroscopy trainer, in a window (Escape ends it; hysteroscopy --help tells the keys)"
  exec "$trainer" "${options[@]}"
fi

hint="'build/release/bin/filasofia doctor' says what this machine lacks"
mkdir -p "$root/out"
shopt -s nullglob

if [ $bunny = no ]; then
  headline "the hysteroscopy trainer, without a window: a planned motion finds the polyp and takes it out"
  rm -f "$root"/out/hysteroscopy.jsonl "$root"/out/report.html
  "$trainer" --motion expert --headless --pictures "$root/out" --session "$root/out/hysteroscopy.jsonl" "${options[@]}" ||
    die "the trainer stopped early (see the message above); $hint"
  "$program" report "$root/out/hysteroscopy.jsonl" --html "$root/out/report.html"
  headline "written"
  ls -l "$root"/out/{os,canal,cavity,polyp,grasped,torn}.png "$root/out/report.html"
  exit 0
fi

headline "the bunny, in pictures (no window): 2 s of falling under its own weight"
rm -f "$root"/out/bunny_*.png
"$program" run bunny --headless --rate 200 --steps 401 --picture "$root/out/bunny.png" --picture-every 0.5 "${options[@]}" ||
  die "the bunny did not run (see the message above); $hint"

headline "physics alone, steps of 5 ms"
printf '%10s  %12s  %12s\n' tetrahedra 'step [ms]' 'steps/s'
for tets in 756 1492 3004; do
  said=$("$program" run bunny --headless --rate 200 --steps 400 --tets $tets) || die "the bunny of $tets tetrahedra did not run"
  awk -v tets=$tets '/^one step takes/ {step = $6} /^physics rate/ {rate = $5}
    END {printf "%10s  %12s  %12s\n", tets, step, rate}' <<<"$said"
done

headline "written"
pictures=("$root"/out/bunny_*.png)
((${#pictures[@]} > 0)) || die "no picture was written; $hint"
ls -l "${pictures[@]}"
