#!/usr/bin/env bash
# Checks that the same input gives the same output, bit for bit: the golden hashes hold with gcc and
# clang, without optimisation and with it.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/golden.sh

Compiles the core, the scenes and the golden tests in one go with gcc and clang at -O0 and -O3 (in
build/golden) and runs the tests whose name says that they compare with a golden hash.
TEXT
}

case "${1:-}" in
    '') ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=build/golden
mkdir -p "$build"
find src scenes tests/core/proxy_golden_test.cpp -name '*.cpp' | sort |
    sed "s|.*|#include \"$PWD/&\"|" >"$build/golden.cpp"

# golden COMPILER LEVEL: builds and runs one configuration; its output comes as a whole.
golden() {
    local program=build/golden/golden-$1-$2 result
    # What cmake/PalpateTarget.cmake sets for every target: no fused multiply-add.
    if ! result=$("$1" "-$2" -std=c++20 -ffp-contract=off -Iinclude -Isrc -I. -Itests \
        -isystem /usr/include/eigen3 build/golden/golden.cpp -o "$program" \
        -lgtest_main -lgtest -pthread 2>&1 &&
        "$program" --gtest_brief=1 --gtest_filter='*olden*' 2>&1); then
        printf '== %s -%s: FAILED\n%s\n' "$1" "$2" "$result"
        return 1
    fi
    # GoogleTest is content when a filter matches nothing; we are not.
    if grep -q 'PASSED.* 0 tests' <<<"$result"; then
        echo "golden.sh: no test has 'golden' in its name"
        return 1
    fi
    printf '== %s -%s\n%s\n' "$1" "$2" "$(tail -n 1 <<<"$result")"
}
export -f golden

printf '%s\n' 'g++ O0' 'g++ O3' 'clang++ O0' 'clang++ O3' |
    xargs -P "$(nproc)" -I{} bash -c 'golden {}'
