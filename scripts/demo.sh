#!/usr/bin/env bash
# Builds Palpate and runs its demo, from nothing but a Debian 12 system.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/demo.sh [--no-packages] [--no-viewer] [OPTION OF `palpate demo`...]

Installs the packages that are missing, builds the command line in build/release (preset release)
and runs `palpate demo` in the folder that you call it from. After that, when the first pictures are
there, it builds the rest: the viewer, and what `cmake --install build/release` installs.

  --no-packages   do not install packages
  --no-viewer     leave out the viewer and its packages (VTK's and Qt's windows)
TEXT
}

packages=yes
viewer=yes
while [ $# -gt 0 ]; do
    case "$1" in
        -h | --help) usage; exit 0 ;;
        --no-packages) packages=no; shift ;;
        --no-viewer) viewer=no; shift ;;
        *) break ;;
    esac
done

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# build GROUP TARGET OPTION...: packages of the group, then one target of build/release. In a
# subshell, so that the demo leaves its folder where the person is.
build() (
    group=$1 target=$2
    shift 2
    cd "$top"
    if [ "$packages" = yes ]; then scripts/install_packages.sh "$group"; fi
    echo "== configure (release)"
    cmake --preset release -DPALPATE_TESTS=OFF "$@"
    echo "== build (release, $target)"
    cmake --build --preset release --target "$target" --parallel "$(nproc)"
)

if [ "$viewer" = yes ] && [ -x "$top/build/release/apps/viewer/palpate-viewer" ]; then
    build viewer all -DPALPATE_VIEWER=ON
    viewer=built
else
    build io palpate_program -DPALPATE_VIEWER=OFF
fi
echo "== palpate demo $*"
"$top/build/release/apps/palpate/palpate" demo "$@"

case "$viewer" in
    yes)
        echo "== the demo is done; the viewer is built now, for \`palpate view\` and for installing"
        build viewer all -DPALPATE_VIEWER=ON
        ;;
    no) build io all -DPALPATE_VIEWER=OFF ;;
esac
