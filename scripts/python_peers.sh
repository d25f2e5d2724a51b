#!/usr/bin/env bash
# Filasofia beside soft bodies that install from PyPI (bench/python_peers.py): an environment of its own, the package with
# the libraries of build/release, at most ten minutes of measurements, and the tables of docs/lab/python.md. Do not use the
# machine meanwhile. Words after the name go to the program: --machine "what the page says"; with --small only the smaller
# body is measured, and the page stays as it is.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

place=$root/build/python_peers
python=$place/venv/bin/python
out=$root/bench/results/peers_2core_xeon.json
[[ " $* " != *" --small "* ]] || out=$place/small.json

python_environment "$place" 'scikit-build-core>=0.10' 'nanobind>=2.5' numpy scipy mujoco pybullet newton

headline "peers: package"
configure release
build release --target filasofia_scene
"$python" -m pip install --quiet --no-build-isolation --no-deps --force-reinstall "$root" \
  --config-settings=build-dir="$place/cmake" --config-settings=cmake.define.FILASOFIA_BUILD="$root/build/release" || die "pip could not build the package"

headline "peers: measurements"
cd "$place"
"$python" "$root/bench/python_peers.py" --out "$out" "$@" >"$place/out.json"
[ "$out" = "$place/small.json" ] || python3 "$root/bench/tables.py" --write "$root"
