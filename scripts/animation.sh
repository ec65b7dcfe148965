#!/usr/bin/env bash
# Makes the animation of the README: a simulated hand slides over a CT head, then drills.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/animation.sh [BUILD_FOLDER]

Films the viewer of BUILD_FOLDER (build/release) on a virtual display and writes
docs/images/viewer-touch.gif. Needs Debian's xvfb, xdotool and ffmpeg. An idle machine gives the smoothest picture.
TEXT
}

# film PROGRAM SESSION FILM: on the display, switches the brush on in the menu after some seconds.
film() {
    "$1" --session "$2" --window 960x600 &
    viewer=$!
    trap 'kill "$viewer"' EXIT
    sleep 12 # until the surface has been drawn
    xdotool mousemove 800 34
    ffmpeg -loglevel error -f x11grab -framerate 8 -video_size 960x600 -i "$DISPLAY" -t 14 -c:v ffv1 "$3" &
    camera=$!
    sleep 3.5
    xdotool mousemove 125 10 click 1 # the menu Data
    sleep 0.7
    xdotool mousemove 145 34 # its first line, the brush
    sleep 0.3
    xdotool click 1
    xdotool mousemove 800 34
    wait "$camera"
}

case "${1:-}" in
    -h | --help) usage; exit 2 ;;
    --film) shift; film "$@"; exit ;;
esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Window size and recent files of no user.
export XDG_CONFIG_HOME=$folder XDG_RUNTIME_DIR=$folder PALPATE_SCREEN=960x600x24
cat >"$folder/session.json" <<JSON
{"format": "palpate-session", "version": 1, "volume": {"volume": "$PWD/data/visible_human_head.nrrd"},
 "field": "cubic", "isovalue": 40, "device": "simulated:hand=slide,seed=4", "look": {"box": false},
 "slices_shown": false, "camera": {"focus": [262, 190, 132], "up": [0, 0, 1],
    "towards_viewer": [0.25, -0.95, 0.15], "half_height": 82}}
JSON
scripts/with_display.sh scripts/animation.sh --film \
    "${1:-build/release}/apps/viewer/palpate-viewer" "$folder/session.json" "$folder/film.mkv"
ffmpeg -loglevel error -y -i "$folder/film.mkv" -filter_complex \
    'scale=800:-1:flags=lanczos,split[a][b];[a]palettegen=max_colors=96:stats_mode=diff[p];[b][p]paletteuse=dither=none:diff_mode=rectangle' \
    docs/images/viewer-touch.gif
ls -l docs/images/viewer-touch.gif
