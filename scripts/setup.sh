#!/usr/bin/env bash
# Installs the Debian packages that Filasofia needs. Fast if none is missing.
set -euo pipefail
usage='Usage: setup.sh [--run | --dev] [--assets] [--check]
  (nothing)  install what is needed to build, run and test
  --run      install only what is needed to build and run
  --dev      also the checkers of scripts/check.sh (clang, clang-tidy, sanitizers, fuzzers)
  --assets   also the tools that generate the meshes of the hysteroscopy trainer (assets/pipeline)
  --check    install nothing: list what is missing; exit 1 if something is'
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# Catch2 and python3 are listed because configuring looks for them even if no test is built.
run_packages=(
  g++ cmake ninja-build ccache git ca-certificates python3 catch2
  libeigen3-dev libhwy-dev libassimp-dev libpugixml-dev libspdlog-dev libcli11-dev nlohmann-json3-dev libstb-dev
  libfilament-dev libfilament-tools libosd-dev libsdl2-dev libimgui-dev fonts-dejavu-core
  libx11-dev libgl-dev libopengl-dev libegl-dev libegl1 libgl1 libgl1-mesa-dri zlib1g-dev
)
test_packages=(clang-format xvfb xauth libxtst6 chromium libglfw3-dev python3-dev python3-venv)
dev_packages=(clang clang-tidy libclang-rt-dev util-linux calculix-ccx libbullet-dev)
asset_packages=(gmsh python3-numpy)

groups=run,test assets=no check=no
for word in "$@"; do
  case $word in
    --run) groups=run ;;
    --dev) groups=run,test,dev ;;
    --assets) assets=yes ;;
    --check) check=yes ;;
    -h | --help) echo "$usage"; exit 0 ;;
    *) die "unknown option '$word' (setup.sh --help lists them)" ;;
  esac
done
packages=("${run_packages[@]}")
[[ $groups == *test* ]] && packages+=("${test_packages[@]}")
[[ $groups == *dev* ]] && packages+=("${dev_packages[@]}")
[ $assets = no ] || packages+=("${asset_packages[@]}")

command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
  die "this is not Debian (no apt-get); install the content of these Debian 12 packages by hand: ${packages[*]}"

# uPlot draws the charts of `filasofia report`. It is not a Debian package, so it is fetched by version and checksum.
# Without it everything still builds, but the pages have no plots.
fetch_charts() {
  "$root/tools/fetch_npm.py" "$root/tools/report" || echo "setup: continuing without uPlot; the pages of filasofia report will have no plots"
}

installed=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' "${packages[@]}" 2>/dev/null | awk 'substr($1, 2, 1) == "i" {print $2}' || true)
mapfile -t missing < <(printf '%s\n' "${packages[@]}" | grep -vxF -f <(printf '%s\n' "$installed") || true)

if ((${#missing[@]} == 0)); then
  echo "setup: all ${#packages[@]} packages are installed"
  [ $check = yes ] || fetch_charts
  exit 0
fi
echo "setup: missing: ${missing[*]}"
[ $check = no ] || exit 1

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || die "installing needs root, and sudo is not installed; run as root: apt-get install ${missing[*]}"
  # Without a terminal nobody can type a password.
  if [ -t 0 ]; then as_root=(sudo); else as_root=(sudo -n); fi
  "${as_root[@]}" true || die "sudo was refused; run as root: apt-get install ${missing[*]}"
fi
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0)

"${apt[@]}" update -q || echo "setup: the package lists could not be refreshed; continuing with the present ones"
known=$(apt-cache --no-all-versions show "${missing[@]}" 2>/dev/null | awk '$1 == "Package:" {print $2}' || true)
mapfile -t unknown < <(printf '%s\n' "${missing[@]}" | grep -vxF -f <(printf '%s\n' "$known") || true)
if ((${#unknown[@]} > 0)); then
  die "not in this system's package lists: ${unknown[*]} (Debian 12 has them; this is $(. /etc/os-release && echo "$PRETTY_NAME"))"
fi
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null || die "apt-get could not install: ${missing[*]}"
echo "setup: installed ${#missing[@]} packages"
fetch_charts
