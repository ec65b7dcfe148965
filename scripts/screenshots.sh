#!/usr/bin/env bash
# Takes the pictures of the viewer that README and docs show, so that they never age.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/screenshots.sh DATA_FOLDER [BUILD_FOLDER]

Opens the viewer of BUILD_FOLDER (build/dev) on a virtual display, on volumes of DATA_FOLDER
(cthead_unc.nrrd, lobster.nrrd, daisy_pollen.nrrd), and writes docs/images/viewer-*.png.
TEXT
}

case "${1:-}" in
    '' | -h | --help) usage; exit 2 ;;
esac
data=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=$(pwd)/${2:-build/dev}/apps/viewer/palpate-viewer
sessions=$(mktemp -d)
trap 'rm -rf "$sessions"' EXIT
# Nobody's window sizes or recent files.
export XDG_CONFIG_HOME=$sessions XDG_RUNTIME_DIR=$sessions

# shot NAME AFTER REST: REST are members of a session besides the volume.
shot() {
    local name=$1 after=$2 rest=$3 session=$sessions/$1.json
    printf '{"format": "palpate-session", "version": 1, %s}\n' "${rest//DATA/$data}" >"$session"
    echo "== viewer-$name.png"
    scripts/with_display.sh "$program" --session "$session" --after "$after" \
        --window 1400x880 --screenshot "docs/images/viewer-$name.png"
}

shot cthead 2.5 '"volume": {"volume": "DATA/cthead_unc.nrrd"}, "isovalue": 1150,
    "device": "simulated:hand=press",
    "look": {"box": false}'
shot lobster 2 '"volume": {"volume": "DATA/lobster.nrrd"}, "isovalue": 35,
    "device": "simulated:hand=press",
    "look": {"tetrahedra": true, "planes": true}'
shot daisy 2 '"volume": {"volume": "DATA/daisy_pollen.nrrd"}, "isovalue": 60,
    "device": "simulated:hand=slide",
    "look": {"surface": false, "volume": true}'
