#!/usr/bin/env bash
# Everything that must pass before a change goes in: builds the release and runs its tests. Needs no GPU and no display. Fast if
# nothing changed. scripts/check.sh does the rest: long tests, sanitizers, clang, fuzzers.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ $# = 0 ] || die "takes no options, got '$1' (the slow checks are in scripts/check.sh)"

"$root/scripts/setup.sh"
headline "build"
configure release
build release
headline "tests"
passed=yes
(cd "$root" && ctest --preset release -j "$(nproc)" </dev/null) || passed=no
headline "where the time went"
"$root/tools/slowest.py" "$root/build/release"

headline "result after $((SECONDS / 60)) min $((SECONDS % 60)) s"
if [ $passed = no ]; then
  # Again, alone: the end of the output names them, and tells whether they fail only beside others.
  (cd "$root" && ctest --preset release --rerun-failed </dev/null) || true
  die "tests failed"
fi
echo "all tests passed"
