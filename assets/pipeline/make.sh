#!/usr/bin/env bash
# Makes the meshes of hysteroscopy, suturing and laparoscopy again, offline; README.md says what it needs. Words go on to make.py.
set -euo pipefail
python=${PYTHON:-/usr/bin/python3} # Debian's own: python3-numpy belongs to it
command -v gmsh >/dev/null && "$python" -c 'import numpy' 2>/dev/null || {
  echo "make.sh: gmsh or python3-numpy is missing: scripts/setup.sh --assets installs them" >&2
  exit 1
}
OPENBLAS_NUM_THREADS=1 exec "$python" -B "$(dirname "${BASH_SOURCE[0]}")/make.py" "$@"
