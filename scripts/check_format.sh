#!/usr/bin/env bash
# Holds every tracked C++ file to .clang-format and every shell script to shellcheck.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/check_format.sh [--fix]

Checks the format of all tracked C++ files (clang-format 14: other versions format differently)
and the shell scripts (shellcheck, where there is one). --fix formats the C++ files in place.
TEXT
}

mode=(--dry-run -Werror)
case "${1:-}" in
    '') ;;
    --fix) mode=(-i) ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# A file may be tracked and, for the moment, not there.
mapfile -t sources < <(git ls-files '*.cpp' '*.hpp' | while read -r f; do [ -f "$f" ] && echo "$f"; done)
clang-format-14 "${mode[@]}" "${sources[@]}"
echo "format: ${#sources[@]} C++ files"

if command -v shellcheck >/dev/null; then
    mapfile -t scripts < <(git ls-files 'scripts/*.sh' 'scripts/deep/*' .ci/run)
    shellcheck "${scripts[@]}"
    echo "shellcheck: ${#scripts[@]} scripts"
fi
