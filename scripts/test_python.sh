#!/usr/bin/env bash
# Installs the Python package into a virtual environment under build/python and runs its tests. The libraries are those
# of build/release. Fast if nothing changed. Words after the name go to pytest: test_python.sh -k frames
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

place=$root/build/python
python=$place/venv/bin/python
stamp=$place/installed

python_environment "$place" 'scikit-build-core>=0.10' 'nanobind>=2.5' 'numpy>=1.22' pytest gymnasium pyarrow scipy highdicom mypy

headline "python: libraries"
configure release
build release --target filasofia_scene 01_bunny

# What the installed package is made of; pip itself takes ten seconds, whatever changed.
changed() {
  [ ! -e "$stamp" ] || [ -n "$(find "$root/bindings" "$root/pyproject.toml" "$root/include" "$root"/assets/{meshes,motions,scenes} \
    "$root"/build/release/src -newer "$stamp" \( -path '*/__pycache__' -prune -o -type f \
    ! -path "$root/build/*.o" -print -quit \))" ]
}
if changed; then
  headline "python: package"
  touch "$stamp.next"
  "$python" -m pip install --quiet --no-build-isolation --no-deps --force-reinstall "$root" \
    --config-settings=build-dir="$place/cmake" --config-settings=cmake.define.FILASOFIA_BUILD="$root/build/release" || die "pip could not build the package"
  mv "$stamp.next" "$stamp"
fi

headline "python: tests"
# From elsewhere, so that the installed package is tested and not the folder of the sources.
cd "$place"
FILASOFIA_BUNNY=$root/build/release/bin/01_bunny FILASOFIA_ROOT=$root "$python" -m pytest -q -p no:cacheprovider \
  -W error "$root/tests/python" "$@"
