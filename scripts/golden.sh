#!/usr/bin/env bash
# Checks that the same input gives the same output, bit for bit: the golden hashes hold with gcc and
# clang, without optimisation and with it, and on Windows.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'TEXT'
usage: scripts/golden.sh [extremes | windows]

Runs the tests that compare with a golden hash, compiled by gcc and clang at -O0 and at -O3. For gcc at
-O3 it builds what is missing of the preset core; for the others it compiles the core, the scenes and the
tests in one go, in build/golden. With `extremes` only gcc at -O3 and clang at -O0 run. With `windows` MinGW compiles, at -O1 and -O3 (an object of -O0 is too
large for it), and Wine runs the tests.
TEXT
}

# The longest first.
tasks=('golden g++ O0' 'golden clang++ O3' 'golden clang++ O0' golden_of_core)
gtest=(-lgtest_main -lgtest -pthread)
run=()
alone=()
# Of two sources for two systems, that of the other one (cmake/PalpateTarget.cmake).
other='_windows[.]cpp$'
case "${1:-}" in
    '') ;;
    extremes) tasks=('golden clang++ O0' golden_of_core) ;;
    windows)
        tasks=('golden x86_64-w64-mingw32-g++-posix O3' 'golden x86_64-w64-mingw32-g++-posix O1')
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
find src scenes baselines/paper.cpp tests/core/proxy_golden_test.cpp -name '*.cpp' | grep -Ev "$other" | sort |
    sed "s|.*|#include \"$PWD/&\"|" >"$build/golden.cpp"

# golden COMPILER LEVEL: builds and runs one configuration; its output comes as a whole.
golden() {
    local program=$build/golden-$1-$2.exe result
    # What cmake/PalpateTarget.cmake sets for every target: no fused multiply-add.
    if ! result=$("$1" "-$2" -std=c++20 -ffp-contract=off -Iinclude -Isrc -I. -Itests \
        -isystem /usr/include/eigen3 "$build/golden.cpp" "${alone[@]}" "${gtest[@]}" -o "$program" 2>&1); then
        printf '== %s -%s: FAILED\n%s\n' "$1" "$2" "$result"
        return 1
    fi
    compare "$1 -$2" "$program"
}

# compare NAME PROGRAM: runs the golden tests of a program.
compare() {
    local result
    if ! result=$("${run[@]}" "$2" --gtest_brief=1 --gtest_filter='*olden*' 2>&1); then
        printf '== %s: FAILED\n%s\n' "$1" "$result"
        return 1
    fi
    # GoogleTest is content when a filter matches nothing; we are not.
    if grep -q 'PASSED.* 0 tests' <<<"$result"; then
        echo "golden.sh: no test has 'golden' in its name"
        return 1
    fi
    printf '== %s\n%s\n' "$1" "$(tail -n 1 <<<"$result")"
}

# golden_of_core: the tests with the library of the preset core, which CI has built before.
golden_of_core() {
    local result
    [ -f build/core/CMakeCache.txt ] || cmake --preset core >/dev/null
    if ! grep -q 'CXX_COMPILER_ID "GNU"' build/core/CMakeFiles/*/CMakeCXXCompiler.cmake ||
        ! grep -q -e ' -O3 ' build/core/compile_commands.json; then
        echo 'golden.sh: build/core is not of gcc at -O3; remove it and run this again'
        return 1
    fi
    if ! result=$(cmake --build --preset core --target golden_tests 2>&1); then
        printf '== preset core: FAILED\n%s\n' "$result"
        return 1
    fi
    compare 'g++ -O3' build/core/tests/core/golden_tests
}

# As many at a time as there are processors.
rm -f "$build/failed"
for task in "${tasks[@]}"; do
    while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
    { $task || touch "$build/failed"; } &
done
wait
[ ! -e "$build/failed" ]
