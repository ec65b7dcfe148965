#!/usr/bin/env bash
# Same input, same output, bit for bit: the golden hashes hold with both compilers and with and
# without optimisation.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/golden.sh

Builds the core and its tests with gcc and clang at -O0 and -O3 (in build/golden-COMPILER-LEVEL)
and runs the tests whose name says that they compare with a golden hash.
TEXT
}

case "${1:-}" in
    '') ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

for compiler in g++ clang++; do
    for level in O0 O3; do
        build=build/golden-$compiler-$level
        echo "== $compiler -$level"
        cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
            -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-$level" \
            -DPALPATE_IO=OFF -DPALPATE_VIEWER=OFF >/dev/null
        cmake --build "$build" --parallel "$(nproc)" --target golden_tests | tail -n 1
        result=$("$build/tests/core/golden_tests" --gtest_brief=1 --gtest_filter='*olden*') || {
            echo "$result"
            exit 1
        }
        # GoogleTest is content when a filter matches nothing; we are not.
        if grep -q 'PASSED.* 0 tests' <<<"$result"; then
            echo "golden.sh: golden_tests has no test with 'golden' in its name" >&2
            exit 1
        fi
        tail -n 1 <<<"$result"
    done
done
