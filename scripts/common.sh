# shellcheck shell=bash
# Sourced by the scripts beside it: their common functions and settings. Not a program.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
script=$(basename "$0")

die() { echo "$script: $*" >&2; exit 1; }
headline() { printf '\n== %s\n' "$*"; }

# ccache and Mesa keep files under HOME, which a CI job may lack.
if [ -z "${HOME:-}" ] || [ ! -w "${HOME:-}" ]; then
  export HOME="$root/build/home"
  mkdir -p "$HOME"
fi

# Number of parallel compilers: one per core, with 1.5 GiB of memory for each (Eigen, Catch2 and CLI11 are heavy
# headers).
jobs_that_fit() {
  local cores kib limit jobs
  cores=$(nproc)
  kib=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || true)
  if [[ $limit =~ ^[0-9]+$ ]] && ((limit / 1024 < kib)); then kib=$((limit / 1024)); fi
  jobs=$((kib / (1536 * 1024)))
  if ((jobs > cores)); then jobs=$cores; fi
  echo $((jobs > 0 ? jobs : 1))
}

# configure PRESET [options]: silent unless it fails; fast if nothing changed.
configure() {
  local log="$root/build/$1-configure.log"
  mkdir -p "$root/build"
  if ! (cd "$root" && cmake --preset "$@" >"$log" 2>&1); then
    cat "$log" >&2
    die "cmake could not configure the preset '$1' (its messages are above)"
  fi
}

# build PRESET [options for cmake --build]: shows progress.
build() { (cd "$root" && cmake --build --preset "$1" -j "$(jobs_that_fit)" "${@:2}") || die "the preset '$1' does not build"; }

# python_environment FOLDER PACKAGES...: makes FOLDER/venv of $PYTHON with these packages. The file FOLDER/venv/packages
# says which it was made with: if others are asked for, pip installs what is missing.
python_environment() {
  local venv=$1/venv asked
  asked=$(printf '%s\n' "${@:2}")
  if [ -x "$venv/bin/python" ] && [ "$(cat "$venv/packages" 2>/dev/null)" = "$asked" ]; then return 0; fi
  headline "python: environment"
  mkdir -p "$1"
  [ -x "$venv/bin/python" ] || "${PYTHON:-python3}" -m venv "$venv" ||
    { rm -rf "$venv"; die "python3 -m venv failed (Debian: python3-venv)"; }
  "$venv/bin/python" -m pip install --quiet "${@:2}" || die "pip could not install ${*:2}"
  echo "$asked" >"$venv/packages"
}
