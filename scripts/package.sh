#!/usr/bin/env bash
# Makes the Debian packages (docs/packages.md), or the zip for Windows (docs/windows.md).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'TEXT'
usage: scripts/package.sh [windows] [--build FOLDER] [OUTPUT]

Installs the packages that are missing, builds Palpate for /usr (in build/package; a quarter of an hour on
two cores) and makes the Debian packages palpate, palpate-io-helper, libpalpate-c0 and libpalpate-dev, in
OUTPUT (default: packages).
With `windows`, builds for Windows (in build/windows-package) and makes a zip with the DLL, its header and
import library, the command line, sample data, examples and licences.
With --build FOLDER, packages what another build folder holds, as it is: for trying the packages.
TEXT
}

build=
system=debian
output=packages
while [ $# -gt 0 ]; do
    case "$1" in
        -h | --help) usage; exit 0 ;;
        --build) build=${2:?"--build wants a folder"}; shift 2 ;;
        windows) system=windows; shift ;;
        -*) usage >&2; exit 2 ;;
        *) output=$1; shift ;;
    esac
done

# The copyright files of Debian packages whose code is in the DLL and the program.
licences() {
    local package file
    mkdir -p "$1"
    cp LICENSE "$1/palpate.txt"
    for package in libeigen3-dev nlohmann-json3-dev libcli11-dev libfmt-dev libboost-dev \
        libz-mingw-w64 mingw-w64-common gcc-mingw-w64-base; do
        file=/usr/share/doc/$package/copyright
        [ -s "$file" ] || { echo "package.sh: $file is missing: run scripts/install_packages.sh windows" >&2; exit 1; }
        cp "$file" "$1/$package.txt"
    done
}

package_for_windows() {
    local version name stage component
    version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
    name=palpate-$version-windows
    stage=$build/$name
    rm -rf "$stage"
    for component in palpate-c palpate-c-dev palpate-program palpate-io-helper; do
        cmake --install "$build" --prefix "$stage" --component "$component" --strip >/dev/null
    done
    mkdir -p "$stage/examples"
    cp examples/c/game_loop.c "$stage/examples/"
    cp docs/windows.md "$stage/README.md"
    licences "$stage/licences"
    (cd "$build" && cmake -E tar cf "$output/$name.zip" --format=zip "$name")
    ls -l "$output/$name.zip"
}

tried=yes
if [ -z "$build" ]; then
    tried=no
    if [ "$system" = debian ]; then
        build=build/package
        scripts/install_packages.sh viewer package
    else
        build=build/windows-package
        scripts/install_packages.sh windows
    fi
    cmake --preset "$(basename "$build")"
    cmake --build "$build"
fi
mkdir -p "$output"
output=$(cd "$output" && pwd)
umask 022
if [ "$system" = windows ]; then
    package_for_windows
    exit
fi
# xz takes minutes for what is made to be tried.
compression=$([ "$tried" = yes ] && echo gzip || echo xz)
(cd "$build" && cpack -G DEB -D CPACK_DEBIAN_COMPRESSION_TYPE="$compression" -B "$output")
rm -rf "$output/_CPack_Packages"
ls -l "$output"/*.deb
