#!/usr/bin/env bash
# Everything that must pass before a change goes in: builds and runs all tests, then again under the address and
# undefined behaviour sanitizers. Needs no GPU and no display. Fast if nothing changed.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ $# = 0 ] || die "takes no options, got '$1' (the slow checks are in scripts/check.sh)"

run_tests() { (cd "$root" && ctest --preset "$1" -j "$(nproc)" </dev/null); }

"$root/scripts/setup.sh"

failed=()
for preset in release asan; do
  headline "$preset: build"
  configure $preset
  build $preset
  headline "$preset: tests"
  run_tests $preset || failed+=("$preset")
  headline "$preset: where the time went"
  "$root/tools/slowest.py" "$root/build/$preset"
done

headline "result after $((SECONDS / 60)) min $((SECONDS % 60)) s"
if ((${#failed[@]} > 0)); then
  # Again, alone: the end of the output names them, and tells whether they fail only beside others.
  for preset in "${failed[@]}"; do (cd "$root" && ctest --preset "$preset" --rerun-failed </dev/null) || true; done
  die "tests failed: ${failed[*]}"
fi
echo "all tests passed: release, asan"
