#!/usr/bin/env bash
# Instructions per update, counted by callgrind: the figure that repeats on any machine, however
# busy, as long as compiler and options are the same.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: benchmarks/instructions.sh [BUILD] [CASE...]

Counts the instructions of an update with valgrind's callgrind, as the difference of two run
lengths over the difference of their updates.

  BUILD   a build folder with PALPATE_BENCHMARKS=ON (default: build/core)
  CASE    cases to count (default: all; BUILD/benchmarks/palpate_instructions --list)
TEXT
}

case "${1:-}" in
    -h | --help) usage; exit 0 ;;
esac
build=${1:-build/core}
[ $# -gt 0 ] && shift
driver=$build/benchmarks/palpate_instructions

if ! command -v valgrind >/dev/null; then
    echo "instructions.sh: valgrind is not installed (Debian: apt install valgrind)" >&2
    exit 1
fi
if [ ! -x "$driver" ]; then
    echo "instructions.sh: no $driver; build with PALPATE_BENCHMARKS=ON first" >&2
    exit 1
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# count CASE UPDATES: instructions of the whole run.
count() {
    valgrind --tool=callgrind --callgrind-out-file="$scratch/out" "$driver" "$1" "$2" \
        >/dev/null 2>"$scratch/log" || { cat "$scratch/log" >&2; exit 1; }
    awk '$1 == "summary:" || $1 == "totals:" { print $2; exit }' "$scratch/out"
}

if [ $# -eq 0 ]; then
    mapfile -t cases < <("$driver" --list)
else
    cases=("$@")
fi
printf '%-30s %s\n' case 'instructions per update'
for name in "${cases[@]}"; do
    few=1000 many=21000
    [[ $name == tool/* ]] && few=100 many=1100  # of a thousand points each
    first=$(count "$name" $few)
    second=$(count "$name" $many)
    awk -v name="$name" -v a="$first" -v b="$second" -v n=$((many - few)) \
        'BEGIN { printf "%-30s %.1f\n", name, (b - a) / n }'
done
