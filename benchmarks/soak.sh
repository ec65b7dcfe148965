#!/usr/bin/env bash
# The runs and the figure of docs/results/soak.md: the live loop with all that it can have on, the
# same alone, and what the machine does to a loop that only multiplies.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: benchmarks/soak.sh BUILD VOLUME ISOVALUE [SECONDS] [FOLDER]

  BUILD     a build folder with PALPATE_IO=ON and PALPATE_BENCHMARKS=ON
  VOLUME    a file, or synthetic:NAME
  ISOVALUE  the level to feel
  SECONDS   of the long run (default: 600)
  FOLDER    for soak.csv, soak.svg and soak.txt (default: the current one)

Status 1 if events were lost, memory grew or the recording does not validate.
TEXT
}

case "${1:-}" in
    -h | --help) usage; exit 0 ;;
esac
if [ $# -lt 3 ]; then
    usage >&2
    exit 2
fi
programs=$1/benchmarks
volume=$2
isovalue=$3
seconds=${4:-600}
folder=${5:-.}
if [ ! -x "$programs/palpate_soak" ]; then
    echo "soak.sh: no $programs/palpate_soak; build it with PALPATE_BENCHMARKS=ON first" >&2
    exit 2
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# run TITLE ARGUMENT...: a run of palpate_soak, its first failure kept for the end.
failed=0
run() {
    echo
    echo "== $1"
    shift
    "$programs/palpate_soak" "$volume" --isovalue "$isovalue" "$@" || failed=$?
}

short=$((seconds < 60 ? seconds : 60))
{
    run "all on, $seconds s" --seconds "$seconds" --csv "$folder/soak.csv"
    run "no commands, $short s" --seconds $short --csv "$scratch/1.csv" --without commands
    run "alone, $short s" --seconds $short --csv "$scratch/2.csv" --without viewer,commands,recording
    run "all on, and a reader that never rests, $short s" --seconds $short \
        --csv "$scratch/3.csv" --fast-reader
    echo
    echo "== a loop that only multiplies"
    "$programs/palpate_soak_ruler"
    exit "$failed"
} | tee "$folder/soak.txt" || failed=$?

if ! command -v gnuplot >/dev/null; then
    echo "soak.sh: gnuplot is not installed, so there is no figure (Debian: apt install gnuplot-nox)" >&2
    exit 0
fi
gnuplot <<PLOT
set terminal svg size 900,1000 dynamic background rgb 'white' font 'Helvetica,14'
set output '$folder/soak.svg'
set datafile separator ','
set multiplot layout 3,1
set key outside right top
set lmargin 10
set rmargin 30
set xlabel 'time [min]'
set xrange [0:*]
set title 'Resident memory'
set ylabel '[MB]'
set yrange [0:*]
plot '$folder/soak.csv' every ::1 using (\$1/60):(\$4/1024) with lines lw 2 title 'resident'
set logscale y
set ylabel '[us]'
set yrange [1:*]
set title 'Lateness of ticks (the machine), each 10 s'
plot for [i=0:3] '$folder/soak.csv' every ::1 using (\$1/60):(column(9+i)/1000) with lines lw 2 \\
     title word('p50 p99 p99.9 max', i+1)
set title 'CPU time of the servo thread per tick, with sleeping and waking, each 10 s'
plot for [i=0:3] '$folder/soak.csv' every ::1 using (\$1/60):(column(13+i)/1000) with lines lw 2 \\
     title word('p50 p99 p99.9 max', i+1), \\
     '$folder/soak.csv' every ::1 using (\$1/60):(\$19/1000) with lines lw 2 dt 2 lc rgb 'black' \\
     title 'compute p99.9 so far', \\
     20 with lines dt 3 lc rgb 'gray' title 'its target'
PLOT
exit "$failed"
