#!/usr/bin/env bash
# The slow checks. scripts/test.sh is required for every change; this script is for releases and for suspected problems.
set -uo pipefail
usage='Usage: check.sh [PART...] [--base REV | --all] [--seconds N] [--steps N]
Parts (default: all of them)
  long    the long tests: motions, examples and random cases that test.sh cuts short, in full
  clang   build with clang, all tests
  tidy    clang-tidy on the sources of src, apps and examples changed since --base (default: origin/HEAD, else the last
          tag, else all)
  edits   the tests of hostile input and edits under the address and undefined behaviour sanitizers (preset asan)
  asan    all tests under these sanitizers (preset asan-all)
  tsan    all tests under the thread sanitizer
  fuzz    every fuzzer for --seconds (default 60)
  soak    one simulated hour of the bunny (or --steps of 5 ms), twice: same hash, no growth of memory, always finite
  python  the tests of the Python package (needs PyPI)
--all     clang-tidy on every source'
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root" || exit 1

all_parts=(long edits clang tidy asan tsan fuzz soak python)
parts=() base='' all=no seconds=60 steps=720000
while (($# > 0)); do
  case $1 in
    long | edits | clang | tidy | asan | tsan | fuzz | soak | python) parts+=("$1") ;;
    --all) all=yes ;;
    --base | --seconds | --steps)
      (($# > 1)) || die "$1 needs a value"
      case $1 in --base) base=$2 ;; --seconds) seconds=$2 ;; --steps) steps=$2 ;; esac
      shift
      ;;
    -h | --help) echo "$usage"; exit 0 ;;
    *) die "unknown part or option '$1' (check.sh --help lists them)" ;;
  esac
  shift
done
[[ $seconds =~ ^[1-9][0-9]*$ ]] || die "--seconds must be a whole number > 0, got '$seconds'"
[[ $steps =~ ^[1-9][0-9]*$ ]] || die "--steps must be a whole number > 0, got '$steps'"
((${#parts[@]} > 0)) || parts=("${all_parts[@]}")

# The thread sanitizer of these compilers cannot start if the kernel randomises addresses widely.
fixed_addresses=()
if setarch "$(uname -m)" -R true 2>/dev/null; then fixed_addresses=(setarch "$(uname -m)" -R); fi

# The sources to check (not the tests, which contain odd code on purpose): those that are compiled, as listed in
# compile_commands.json.
sources_to_tidy() {
  local since=$base
  if [ $all = no ] && [ -z "$since" ]; then
    since=$(git rev-parse --verify -q origin/HEAD || git describe --tags --abbrev=0 2>/dev/null || true)
  fi
  if [ $all = yes ] || [ -z "$since" ]; then
    git ls-files -co --exclude-standard 'src/*.cpp' 'apps/*.cpp' 'examples/*.cpp'
  else
    git rev-parse --verify -q "$since^{commit}" >/dev/null || die "--base: '$since' is not a revision"
    { git diff --name-only --diff-filter=d "$since" -- '*.cpp' && git ls-files -o --exclude-standard '*.cpp'; } |
      grep -E '^(src|apps|examples)/' | sort -u
  fi
}


check_long() {
  (configure release && build release) || return 1
  ctest --preset long -j "$(nproc)" </dev/null
}

check_clang() {
  (configure clang && build clang) || return 1
  ctest --preset clang -j "$(nproc)" </dev/null
}

check_tidy() {
  (configure clang && build clang) || return 1 # the generated and precompiled headers must exist
  local listed chosen
  listed=$(sed -n 's/^ *"file": "\(.*\)",*$/\1/p' build/clang/compile_commands.json)
  chosen=$(sources_to_tidy) || return 1
  mapfile -t files < <(sed "s|^|$root/|" <<<"$chosen" | grep -xF -f <(printf '%s\n' "$listed") || true)
  echo "clang-tidy on ${#files[@]} sources"
  ((${#files[@]} == 0)) || printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(jobs_that_fit)" clang-tidy -p build/clang --quiet
}

check_edits() {
  (configure asan && build asan) || return 1
  ctest --preset asan -j "$(nproc)" </dev/null
}

check_asan() {
  (configure asan-all && build asan-all) || return 1
  ctest --preset asan-all -j "$(nproc)" </dev/null
}

check_tsan() {
  (configure tsan && cd "$root" && "${fixed_addresses[@]}" cmake --build --preset tsan -j "$(jobs_that_fit)") || return 1
  "${fixed_addresses[@]}" ctest --preset tsan -j "$(nproc)" </dev/null
}

check_fuzz() {
  (configure fuzz && build fuzz) || return 1
  local fuzzer name corpus ran=0
  for fuzzer in build/fuzz/bin/fuzz_*; do
    [ -x "$fuzzer" ] || continue
    name=$(basename "$fuzzer")
    corpus=build/fuzz/corpus/$name
    mkdir -p "$corpus" build/fuzz/found
    seeds=()
    [ -d "tests/fuzz/corpus/${name#fuzz_}" ] && seeds=("tests/fuzz/corpus/${name#fuzz_}")
    echo "$name: $seconds s"
    "$fuzzer" -max_total_time="$seconds" -rss_limit_mb=2048 -print_final_stats=1 -verbosity=0 \
      -artifact_prefix="build/fuzz/found/$name-" "$corpus" "${seeds[@]}" || return 1
    ran=$((ran + 1))
  done
  ((ran > 0)) || { echo "no program named fuzz_* was built"; return 1; }
}

resident_kib() { awk '/^VmRSS/ {print $2}' "/proc/$1/status" 2>/dev/null || true; }

# One run of the bunny at 200 steps per second, its output in the file $1. Prints "HASH FIRST LAST": the memory [KiB]
# that it holds after it has settled (10 s) and at the end. If the run is shorter, growth cannot be measured, and both
# are 0.
soak_run() {
  local said=$1 first=0 last=0 held run second=0
  build/release/bin/filasofia run bunny --tets 756 --rate 200 --headless --steps "$steps" >"$said" &
  run=$!
  while kill -0 $run 2>/dev/null; do
    sleep 1
    second=$((second + 1))
    held=$(resident_kib $run)
    if [ -n "$held" ] && ((second >= 10)); then
      last=$held
      ((first > 0)) || first=$held
    fi
  done
  wait $run || return 1
  grep -q 'rolled back 0,' "$said" || { cat "$said" >&2; echo "a state was not finite" >&2; return 1; }
  echo "$(awk '/^state hash/ {print $3}' "$said") $first $last"
}

check_soak() {
  (configure release && build release --target filasofia) || return 1
  local said run hash first last grown=0 hashes=()
  said=build/release/soak.txt # kept: the output of the last run
  for run in first second; do
    read -r hash first last < <(soak_run "$said") || return 1
    echo "$run run: hash $hash, $first KiB after 10 s, $last KiB at the end"
    ((first > 0)) || echo "$run run: too short to measure the growth of its memory"
    ((last - first < 1024)) || { echo "$run run: memory grew by $((last - first)) KiB"; grown=1; }
    hashes+=("$hash")
  done
  [ -n "${hashes[0]}" ] && [ "${hashes[0]}" = "${hashes[1]}" ] || { echo "the hashes differ"; return 1; }
  return $grown
}

check_python() { "$root/scripts/test_python.sh"; }

"$root/scripts/setup.sh" --dev || exit 1
summary=() failures=0
for part in "${parts[@]}"; do
  headline "$part"
  started=$SECONDS
  if "check_$part"; then result=passed; else result=FAILED; failures=$((failures + 1)); fi
  summary+=("$(printf '%-6s  %-6s  %5d s' "$part" $result $((SECONDS - started)))")
done
headline "summary"
printf '%s\n' "${summary[@]}"
exit $((failures > 0))
