#!/usr/bin/env bash
# Builds Palpate and runs its demo, from nothing but a Debian 12 system.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/demo.sh [--no-packages] [OPTION OF `palpate demo`...]

Installs the packages that are missing, builds the release preset in build/release and runs
`palpate demo` in the folder that you call it from.

  --no-packages   do not look for packages; use what is there
TEXT
}

packages=yes
case "${1:-}" in
    -h | --help) usage; exit 0 ;;
    --no-packages) packages=no; shift ;;
esac

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# In a subshell, so that the demo leaves its folder where the person is.
(
    cd "$top"
    if [ "$packages" = yes ]; then scripts/install_packages.sh viewer; fi
    echo "== configure (release)"
    cmake --preset release -DPALPATE_TESTS=OFF
    echo "== build (release)"
    cmake --build --preset release --parallel "$(nproc)"
)
program=$top/build/release/apps/palpate/palpate
if [ ! -x "$program" ]; then
    echo "demo.sh: $program was not built; this checkout has no command line" >&2
    exit 1
fi
echo "== palpate demo $*"
"$program" demo "$@"
