#!/usr/bin/env bash
# Fail when a source differs from the output of clang-format (version 14, .clang-format). Usage: check_format.sh ROOT
# [--fix]
set -euo pipefail
cd "$1"
command -v clang-format >/dev/null || { echo "clang-format is missing: run scripts/setup.sh"; exit 1; }
mapfile -t files < <(find include src tests apps examples bench bindings -name '*.h' -o -name '*.cpp' | sort)
if [ "${2:-}" = --fix ]; then clang-format -i "${files[@]}"; else clang-format --dry-run --Werror "${files[@]}"; fi
