#!/usr/bin/env bash
# Builds Palpate and runs its tests, from nothing but a Debian 12 system.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/test.sh [--no-packages] [--target TARGET] [PRESET] [CTEST OPTION...]

Installs the packages that are missing, builds a preset in build/PRESET and runs its tests.

presets (default: unity)
  unity    optimised, assertions on, warnings are errors; the sources of a folder are compiled together,
           which is quickest from nothing
  dev      the same, each source alone: quickest after an edit
  release  what is installed
  clang    release with clang
  core     the core alone: standard library and Eigen, no ITK, no VTK
  asan     address and undefined-behaviour sanitizers (clang), and the fuzz targets
  tsan     thread sanitizer

  --no-packages     do not install packages
  --target TARGET   build that only; threaded_tests, memory_tests and bytes_tests are those with
                    the labels `threaded`, `memory` and `bytes`

With a sanitizer a test program is one test or two (NAME_1, NAME_2), and one for the tests that keep real
time (NAME_paced); GTEST_FILTER chooses among the cases of the former.

examples: scripts/test.sh dev -R Surface
          GTEST_FILTER='*Surface*' scripts/test.sh --target memory_tests asan -R core_tests
TEXT
}

packages=yes
preset=unity
target=all
while [ $# -gt 0 ]; do
    case "$1" in
        -h | --help) usage; exit 0 ;;
        --no-packages) packages=no; shift ;;
        --target) target=$2; shift 2 ;;
        dev | unity | release | clang | core | asan | tsan) preset=$1; shift; break ;;
        -*) break ;;
        *) echo "test.sh: no preset '$1'" >&2; usage >&2; exit 2 ;;
    esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ "$packages" = yes ]; then
    case "$preset" in
        core) scripts/install_packages.sh core ;;
        asan) scripts/install_packages.sh io dev ;;
        tsan) scripts/install_packages.sh io ;;
        clang) scripts/install_packages.sh viewer test dev ;;
        *) scripts/install_packages.sh viewer test ;;
    esac
fi

# gcc 12's thread sanitizer cannot place its shadow memory where the kernel randomises addresses
# widely; test programs run during the build too, so all of it runs without.
fixed=()
if [ "$preset" = tsan ] && setarch --addr-no-randomize true 2>/dev/null; then
    fixed=(setarch --addr-no-randomize)
fi

echo "== configure ($preset)"
cmake --preset "$preset"
echo "== build ($preset)"
"${fixed[@]}" cmake --build --preset "$preset" --target "$target" --parallel "$(nproc)"
echo "== test ($preset)"
"${fixed[@]}" ctest --preset "$preset" "$@"
