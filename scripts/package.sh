#!/usr/bin/env bash
# Makes the Debian packages (docs/packages.md).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'TEXT'
usage: scripts/package.sh [--build FOLDER] [OUTPUT]

Builds Palpate for /usr (in build/package; a quarter of an hour on two cores) and makes the Debian
packages palpate, palpate-io-helper, libpalpate-c0 and libpalpate-dev, in OUTPUT (default: packages).
With --build FOLDER, packages what another build folder holds, as it is: for trying the packages.
TEXT
}

build=
output=packages
while [ $# -gt 0 ]; do
    case "$1" in
        -h | --help) usage; exit 0 ;;
        --build) build=${2:?"--build wants a folder"}; shift 2 ;;
        -*) usage >&2; exit 2 ;;
        *) output=$1; shift ;;
    esac
done

if [ -z "$build" ]; then
    build=build/package
    cmake --preset package
    cmake --build "$build"
fi
mkdir -p "$output"
output=$(cd "$output" && pwd)
umask 022
(cd "$build" && cpack -G DEB -B "$output")
rm -rf "$output/_CPack_Packages"
ls -l "$output"/*.deb
