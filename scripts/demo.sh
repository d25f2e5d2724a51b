#!/usr/bin/env bash
# From a fresh clone to the bunny: in a window where there is a display, else in pictures under out/.
set -euo pipefail
usage='Usage: demo.sh [--headless] [options of filasofia run bunny]'
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

headless=no options=()
for word in "$@"; do
  case $word in
    --headless) headless=yes ;;
    -h | --help) echo "$usage"; exit 0 ;;
    *) options+=("$word") ;;
  esac
done
[ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || headless=yes

"$root/scripts/setup.sh" --run
headline "build"
configure release
build release --target filasofia
program=$root/build/release/bin/filasofia

if [ $headless = no ]; then
  headline "the bunny, in a window (Escape ends it)"
  exec "$program" run bunny "${options[@]}"
fi

headline "the bunny, in pictures (no display)"
mkdir -p "$root/out"
pictures=() rates=()
for steps in 100 200 400 800; do # at the default 200 Hz: 0.5, 1, 2 and 4 s
  picture=$root/out/bunny_$(printf %04d $steps).png
  started=$(date +%s.%N)
  "$program" run bunny --headless --steps $steps --picture "$picture" "${options[@]}" ||
    die "the bunny did not run (what it said is above; 'filasofia doctor' says what this machine lacks)"
  [ -s "$picture" ] || die "no picture was written to $picture"
  pictures+=("$picture")
  rates+=("$(awk -v n=$steps -v a="$started" -v b="$(date +%s.%N)" 'BEGIN {printf "%6d  %8.2f s  %8.0f", n, b - a, n / (b - a)}')")
done
headline "rates, start and picture included"
printf '%6s  %10s  %8s\n' steps 'wall time' 'steps/s'
printf '%s\n' "${rates[@]}"
headline "written"
ls -l "${pictures[@]}"
