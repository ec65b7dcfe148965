#!/usr/bin/env bash
# Makes the pictures of the viewer in README and docs.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/screenshots.sh DATA_FOLDER [BUILD_FOLDER]

Opens the viewer of BUILD_FOLDER (build/dev) on a virtual display, on volumes of DATA_FOLDER
(cthead_unc.nrrd, lobster.nrrd, visible_human_head.nrrd), and writes docs/images/viewer-*.png.
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
# Window size and recent files of no user.
export XDG_CONFIG_HOME=$sessions XDG_RUNTIME_DIR=$sessions

# screenshot NAME AFTER REST OPTIONS...: REST are the members of the session file.
screenshot() {
    local name=$1 after=$2 rest=$3 session=$sessions/$1.json
    shift 3
    printf '{"format": "palpate-session", "version": 1, %s}\n' "${rest//DATA/$data}" >"$session"
    echo "== viewer-$name.png"
    scripts/with_display.sh "$program" --session "$session" --after "$after" \
        --window 1400x880 --screenshot "docs/images/viewer-$name.png" "$@"
}

palpate=${program%/viewer/*}/palpate/palpate
screenshot lobster 2.2 '"volume": {"volume": "DATA/lobster.nrrd"}, "field": "cubic", "isovalue": 35,
    "device": "simulated:hand=slide,seed=4", "look": {"box": false},
    "camera": {"focus": [150, 175, 39], "up": [0, -1, 0],
        "towards_viewer": [0.25, 0.35, 0.9], "half_height": 170}'
echo "== viewer-layers.png"
scripts/with_display.sh "$program" data/visible_human_head.nrrd --layers sample-head \
    --device simulated:hand=press --after 3 --window 1400x880 --screenshot docs/images/viewer-layers.png
echo "== viewer-two-hands.png"
scripts/with_display.sh "$program" data/visible_human_head.nrrd -i 34.5 --device simulated:hand=hold,seconds=60 \
    --device simulated:omega6,hand=press,seed=3,seconds=60 --after 3 --window 1400x880 \
    --screenshot docs/images/viewer-two-hands.png
# This head was stored upside down, and its file has no orientation.
screenshot surfaces 2 '"volume": {"volume": "DATA/cthead_unc.nrrd", "orientation": "RPI"}, "field": "cubic", "isovalue": 500,
    "device": "simulated:hand=press", "look": {"box": false, "surface_opacity": 0.35,
        "surfaces": [{"level": 1150, "colour": [0.84, 0.37, 0.25], "opacity": 1, "shown": true}],
        "cut": "plane", "cut_plane": {"point": [-127.5, 127.5, -60], "normal": [0, 0, 1]}},
    "measurements": [{"kind": "length", "points": [[-62, 127, -112], [-190, 127, -112]]}],
    "camera": {"focus": [-127.5, 127.5, -112], "up": [0, 0, 1],
        "towards_viewer": [0.6, -0.6, 0.5], "half_height": 130}'
screenshot local 2 '"volume": {"volume": "synthetic:sphere:14x14x14"}, "isovalue": 100,
    "device": "simulated:hand=press", "slices_shown": false,
    "look": {"surface_opacity": 0.4, "tetrahedra": true, "planes": true},
    "camera": {"focus": [-3.9, -0.4, -1.4], "up": [0, 0, 1],
        "towards_viewer": [-0.55, -0.75, 0.4], "half_height": 1.3}'
"$palpate" convert "$data/visible_human_head.nrrd" --orientation LPS "$sessions/head.zarr" --quiet
screenshot store 2 '"volume": {"volume": "'"$sessions"'/head.zarr"}, "field": "cubic", "isovalue": 110,
    "device": "simulated:hand=press", "look": {"box": false},
    "camera": {"focus": [255, 200, 110], "up": [0, 0, 1],
        "towards_viewer": [-0.3, -0.9, 0.1], "half_height": 54}'
screenshot tool 3 '"volume": {"volume": "'"$(pwd)"'/data/visible_human_head.nrrd"}, "field": "cubic", "isovalue": 110,
    "device": "simulated:sigma7,hand=press,turn=25", "look": {"box": false},
    "camera": {"focus": [196, 222, 100], "up": [0, 0, 1],
        "towards_viewer": [-0.75, -0.6, 0.1], "half_height": 42}' --tool burr:6 --tool-spacing 1

# What a burr leaves that drills and turns, ball and shank.
echo "== drilling"
"$palpate" touch data/visible_human_head.nrrd --isovalue 40 --tool burr:8 --tool-spacing 1 \
    --device simulated:sigma7,hand=press,turn=25 --brush 'carve tool' --seconds 12 --headless --quiet \
    --save "$sessions/drilled.nrrd"
screenshot drilled 4 '"volume": {"volume": "'"$sessions"'/drilled.nrrd"}, "field": "cubic", "isovalue": 40,
    "look": {"box": false}, "slices_shown": false,
    "camera": {"focus": [175, 225, 104], "up": [0, 0, 1],
        "towards_viewer": [-0.8, -0.55, 0.25], "half_height": 60}'
