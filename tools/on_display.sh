#!/usr/bin/env bash
# Run a program on an X server of its own (Xvfb) and return its exit code; 77, which ctest shows as skipped, if there is no
# Xvfb. Usage: on_display.sh PROGRAM [ARGUMENT]...
set -euo pipefail
command -v Xvfb >/dev/null || { echo "skipped: Xvfb is not installed (scripts/setup.sh)"; exit 77; }
number=$(mktemp)
# With -displayfd the server takes the first free display and writes its number when it is ready.
Xvfb -displayfd 3 -screen 0 1024x768x24 -noreset -nolisten tcp 3>"$number" 2>/dev/null &
server=$!
trap 'kill $server 2>/dev/null || true; rm -f "$number"' EXIT
for _ in $(seq 200); do
  [ -s "$number" ] && break
  kill -0 $server 2>/dev/null || break
  sleep 0.05
done
[ -s "$number" ] || { echo "skipped: Xvfb does not start"; exit 77; }
DISPLAY=:$(cat "$number") "$@"
