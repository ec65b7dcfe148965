#!/usr/bin/env bash
# Checks that the same input gives the same output, bit for bit: the golden hashes hold with gcc and
# clang, without optimisation and with it, and on Windows.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'TEXT'
usage: scripts/golden.sh [windows]

Compiles the core, the scenes and the golden tests in one go with gcc and clang at -O0 and -O3 (in
build/golden) and runs the tests whose name says that they compare with a golden hash. With `windows`,
MinGW compiles, at -O1 and -O3 (an object of -O0 is too large for it), and Wine runs them.
TEXT
}

compilers=(g++ clang++)
least=O0
gtest=(-lgtest_main -lgtest -pthread)
run=()
alone=()
# Of two sources for two systems, that of the other one (cmake/PalpateTarget.cmake).
other='_windows[.]cpp$'
case "${1:-}" in
    '') ;;
    windows)
        least=O1
        compilers=(x86_64-w64-mingw32-g++-posix)
        here=/usr/src/googletest/googletest
        gtest=("-I$here" "-I$here/include" "$here/src/gtest-all.cc" "$here/src/gtest_main.cc" -D_WIN32_WINNT=0x0A00
            -DNOMINMAX -DWIN32_LEAN_AND_MEAN "-Wa,-mbig-obj" -static -lwinmm -lavrt)
        run=(cmake/windows/wine.sh)
        export WINEPREFIX=$PWD/build/windows/wine
        # By themselves: windows.h defines words such as far.
        mapfile -t alone < <(find src scenes -name '*_windows.cpp')
        other+="|$(printf '%s\n' "${alone[@]}" | sed 's/_windows//' | paste -sd '|')"
        ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
esac

build=build/golden
mkdir -p "$build"
find src scenes tests/core/proxy_golden_test.cpp -name '*.cpp' | grep -Ev "$other" | sort |
    sed "s|.*|#include \"$PWD/&\"|" >"$build/golden.cpp"

# golden COMPILER LEVEL: builds and runs one configuration; its output comes as a whole.
golden() {
    local program=$build/golden-$1-$2.exe result
    # What cmake/PalpateTarget.cmake sets for every target: no fused multiply-add.
    if ! result=$("$1" "-$2" -std=c++20 -ffp-contract=off -Iinclude -Isrc -I. -Itests \
        -isystem /usr/include/eigen3 "$build/golden.cpp" "${alone[@]}" "${gtest[@]}" -o "$program" 2>&1 &&
        "${run[@]}" "$program" --gtest_brief=1 --gtest_filter='*olden*' 2>&1); then
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

status=0
for compiler in "${compilers[@]}"; do
    golden "$compiler" "$least" & first=$!
    golden "$compiler" O3 || status=1
    wait "$first" || status=1
done
exit "$status"
