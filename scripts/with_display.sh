#!/usr/bin/env bash
# Runs a command on a virtual display of its own (Xvfb, software OpenGL), whether or not there is a
# real one.
set -euo pipefail

if [ $# -eq 0 ] || [ "$1" = -h ] || [ "$1" = --help ]; then
    cat <<'TEXT'
usage: scripts/with_display.sh COMMAND [ARGUMENT...]

Starts Xvfb on a free display (PALPATE_SCREEN, default 1600x1200x24), runs the command on it, and
ends it. The exit status is the command's.
TEXT
    exit 2
fi

# Xvfb picks a number that is free and tells it: several of these may start at once.
number=$(mktemp)
log=$(mktemp)
Xvfb -displayfd 3 -screen 0 "${PALPATE_SCREEN:-1600x1200x24}" -nolisten tcp -noreset \
    3>"$number" >"$log" 2>&1 &
server=$!
trap 'kill "$server" 2>/dev/null; wait "$server" 2>/dev/null; rm -f "$number" "$log"' EXIT
until [ -s "$number" ]; do
    if ! kill -0 "$server" 2>/dev/null; then
        echo "with_display.sh: Xvfb did not start:" >&2
        cat "$log" >&2
        exit 1
    fi
    sleep 0.05
done
DISPLAY=":$(cat "$number")"
export DISPLAY QT_QPA_PLATFORM=xcb LIBGL_ALWAYS_SOFTWARE=1
unset WAYLAND_DISPLAY
status=0
"$@" || status=$?
exit "$status"
