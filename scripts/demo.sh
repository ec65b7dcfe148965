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

# build OPTIONS TARGET...: targets of build/release. In a subshell, so that the demo leaves its folder where
# the person is.
build() (
    cd "$top"
    read -ra options <<<"$1"
    shift
    echo "== configure (release)"
    cmake --preset release -DPALPATE_TESTS=OFF "${options[@]}"
    echo "== build (release, $*)"
    cmake --build --preset release --target "$@" --parallel "$(nproc)"
)

install() { if [ "$packages" = yes ]; then "$top/scripts/install_packages.sh" "$@"; fi; }

# On a bare system the core, which needs a compiler and Eigen alone, is built while apt installs the rest.
core_meanwhile() {
    if [ "$packages" = no ] || install --check program >/dev/null; then return; fi
    install core
    # Asks for the password now, not amid the compiler's lines.
    if [ "$(id -u)" -ne 0 ] && ! sudo true; then return; fi
    log=$top/build/packages.log
    mkdir -p "$top/build"
    echo "packages: the rest of group program in the background ($log)"
    set -m  # a process group of its own: Ctrl-C must not cut dpkg off
    install program >"$log" 2>&1 </dev/null &
    apt=$!
    set +m
    trap 'if kill -0 "$apt" 2>/dev/null; then echo "demo.sh: waiting for apt"; wait "$apt"; fi' EXIT
    (renice -n 10 "$BASHPID" >/dev/null; build -DPALPATE_IO=OFF all)
    wait "$apt" || { cat "$log"; exit 1; }
    trap - EXIT
}

# Everything: with the viewer (`ON`) or without.
build_all() { build "-DPALPATE_IO=ON -DPALPATE_PYTHON=ON -DPALPATE_VIEWER=$1" all; }

if [ "$viewer" = yes ] && [ -x "$top/build/release/apps/viewer/palpate-viewer" ]; then
    install viewer
    build_all ON
    viewer=built
else
    core_meanwhile
    install program
    targets=(palpate_program)
    if [ $# -gt 0 ]; then targets+=(palpate_io_helpers); fi  # a volume of any format, perhaps
    build "-DPALPATE_IO=ON -DPALPATE_PYTHON=OFF -DPALPATE_VIEWER=OFF" "${targets[@]}"
fi
echo "== palpate demo $*"
"$top/build/release/apps/palpate/palpate" demo "$@"

case "$viewer" in
    yes)
        echo "== the demo is done; the viewer is built now, for \`palpate view\`"
        install viewer
        build "-DPALPATE_IO=ON -DPALPATE_PYTHON=ON -DPALPATE_VIEWER=ON" palpate_viewer palpate_io_helpers
        echo "== \`palpate view\` opens a window from now on; the Python module and the rest are built, for installing"
        build_all ON
        ;;
    no)
        install io
        build_all OFF
        ;;
esac
