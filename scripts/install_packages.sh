#!/usr/bin/env bash
# Installs the Debian packages that Palpate is built with (Debian 12).
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/install_packages.sh [--check] [GROUP...]

Installs the Debian 12 packages that Palpate is built with, as root or with sudo. Installed packages
are left as they are; when nothing is missing, apt is not run.

  --check  install nothing; exit with 1 when one is missing

groups (default: all)
  core     compiler, CMake, Eigen, GoogleTest, Google Benchmark; Python and Git for the rule checks
  program  core, and what reads and writes files and reaches devices: ITK, VTK, CLI11, fmt, JSON,
           EGL and Mesa for pictures without a display, PNG, zlib, gnuplot, Boost, codecs of
           chunks, libcurl
  io       program; for the Python module pybind11, NumPy, SciPy, Matplotlib, WeasyPrint, Dask, pip, nibabel; for tests zarr, h5py, pydicom, tifffile, teem
           and OpenIGTLink
  viewer   io, and VTK's and Qt's windows and translations, Xvfb to test them
  package  what scripts/package.sh uses in addition to viewer
  test     package, and what only the tests use: lintian and pkg-config for the Debian packages, Mono for C#,
           umockdev and libftdi for devices, ROS 1, and Cyclone DDS and Fast DDS for ROS 2
  dev      clang, lld, its sanitizers and fuzzer, clang-format, clang-tidy, shellcheck
  docs     MkDocs and Doxygen, for the documentation as a site
  web      core, emscripten, and Chromium for the tests of the page; not in all
  windows  core, MinGW and Wine, and the headers that the libraries for Windows are built with; not in all
  all      everything above
TEXT
}

core=(g++ cmake ninja-build ccache libeigen3-dev libgtest-dev libgmock-dev libbenchmark-dev python3 git)
python=(python3-dev pybind11-dev python3-numpy python3-pytest python3-nibabel python3-zarr
        python3-h5py python3-pydicom python3-tifffile teem-apps python3-setuptools python3-wheel
        python3-pip python3-venv strace python3-dask python3-distributed python3-scipy python3-matplotlib weasyprint mypy)
program=("${core[@]}" libinsighttoolkit5-dev libvtk9-dev libcli11-dev libfmt-dev nlohmann-json3-dev
    libgdcm-dev libhdf5-dev libtiff-dev libpugixml-dev libpng-dev zlib1g-dev gnuplot-nox libboost-dev libegl-dev libegl1
    libgl1-mesa-dri libembree-dev libblosc-dev libzstd-dev liblz4-dev libxxhash-dev libcurl4-openssl-dev)
io=("${program[@]}" libopenigtlink-dev "${python[@]}")
viewer=("${io[@]}" libvtk9-qt-dev qtbase5-dev qttools5-dev qttools5-dev-tools qttranslations5-l10n xvfb)
package=(dpkg-dev file)
test=("${package[@]}" lintian pkg-config mono-mcs mono-runtime umockdev libftdi1-2
    python3-rospy python3-rosmaster python3-geometry-msgs python3-sensor-msgs python3-diagnostic-msgs
    libddsc0debian libfastrtps-dev)
dev=(clang lld clang-format-14 clang-tidy libclang-rt-14-dev shellcheck)
docs=(mkdocs doxygen python3-pygments libjs-jquery)
web=("${core[@]}" emscripten node-acorn nlohmann-json3-dev googletest chromium python3-pydicom python3-zarr)
windows=("${core[@]}" g++-mingw-w64-x86-64-posix wine64 libz-mingw-w64-dev nlohmann-json3-dev
    libboost-dev libcli11-dev libfmt-dev)

check=no
if [ "${1:-}" = --check ]; then
    check=yes
    shift
fi
wanted=()
for group in "${@:-all}"; do
    case "$group" in
        core) wanted+=("${core[@]}") ;;
        program) wanted+=("${program[@]}") ;;
        io) wanted+=("${io[@]}") ;;
        viewer) wanted+=("${viewer[@]}") ;;
        package) wanted+=("${package[@]}") ;;
        test) wanted+=("${test[@]}") ;;
        dev) wanted+=("${dev[@]}") ;;
        docs) wanted+=("${docs[@]}") ;;
        windows) wanted+=("${windows[@]}") ;;
        web) wanted+=("${web[@]}") ;;
        all) wanted+=("${viewer[@]}" "${test[@]}" "${dev[@]}" "${docs[@]}") ;;
        -h | --help) usage; exit 0 ;;
        *) echo "install_packages.sh: no group '$group'" >&2; usage >&2; exit 2 ;;
    esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "install_packages.sh: this system has no apt; install the contents of these Debian packages:" >&2
    printf '%s\n' "${wanted[@]}" | sort -u >&2
    exit 1
fi

missing=()
while read -r package; do
    status=$(dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null || true)
    # A package of two architectures has a line for each.
    grep -qx installed <<<"$status" || missing+=("$package")
done < <(printf '%s\n' "${wanted[@]}" | sort -u)

if [ ${#missing[@]} -eq 0 ]; then
    echo "packages: all installed (${*:-all})"
    exit 0
fi
if [ "$check" = yes ]; then
    echo "packages: missing ${missing[*]}"
    exit 1
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "install_packages.sh: run it as root, or install sudo; missing: ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
echo "packages: installing ${missing[*]}"
"${as_root[@]}" apt-get update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "${missing[@]}"
