#!/usr/bin/env bash
# Fail when a source differs from the output of clang-format (version 14, .clang-format), or a test has a name that CTest
# cannot take. Usage: check_format.sh ROOT [--fix]
set -euo pipefail
cd "$1"
command -v clang-format >/dev/null || { echo "clang-format is missing: run scripts/setup.sh"; exit 1; }
mapfile -t files < <(find include src tests apps examples bench bindings -name '*.h' -o -name '*.cpp' | sort)
if [ "${2:-}" = --fix ]; then clang-format -i "${files[@]}"; else clang-format --dry-run --Werror "${files[@]}"; fi
# A semicolon would part a test's name in two for CTest.
if grep -rnE '^TEST_CASE\("[^"]*;' tests; then echo "a test's name must have no semicolon"; exit 1; fi
