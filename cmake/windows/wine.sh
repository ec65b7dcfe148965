#!/usr/bin/env bash
# Runs a Windows program under Wine, without a display. Wine's own files are in $WINEPREFIX, or in
# the build folder that holds the program.
set -euo pipefail

build=$(dirname "$(realpath "$1")")
while [ "$build" != / ] && [ ! -e "$build/CMakeCache.txt" ]; do
    build=$(dirname "$build")
done
[ "$build" != / ] || build=$PWD
export WINEPREFIX=${WINEPREFIX:-$build/wine}
# Nothing here needs Mono and Gecko, and programs that crash on purpose need no debugger.
export WINEDEBUG=-all WINEDLLOVERRIDES="mscoree=;mshtml=;winedbg.exe="
unset DISPLAY WAYLAND_DISPLAY

wine=/usr/lib/wine/wine64
mkdir -p "$WINEPREFIX"
(
    flock 9
    [ -e "$WINEPREFIX/ready" ] || { "$wine" wineboot --init >&2 && touch "$WINEPREFIX/ready"; }
) 9>"$WINEPREFIX/lock"
exec "$wine" "$@"
