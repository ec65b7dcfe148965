#!/usr/bin/env bash
# Installs the Debian packages in a bare Debian 12 by apt, uses them as a newcomer would, removes them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'TEXT'
usage: scripts/try_packages.sh [PACKAGES]

Makes a bare Debian 12 by debootstrap in a temporary folder (as root; about 2 GB, from the network) and
there: apt installs the packages of the folder PACKAGES (default: packages, from scripts/package.sh)
with what they depend on; `palpate demo` draws its pictures; Python feels a NumPy array; a C program
that pkg-config compiles runs; apt removes all, which leaves nothing.
TEXT
}

case "${1:-}" in
    -h | --help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
esac
packages=${1:-packages}
compgen -G "$packages/palpate_*.deb" >/dev/null || { echo "try_packages.sh: no palpate_*.deb in $packages" >&2; exit 2; }
[ "$(id -u)" = 0 ] || exec sudo -- "$0" "$packages"
command -v debootstrap >/dev/null || DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap >/dev/null

root=$(mktemp -d)
chmod 755 "$root"  # apt reads its lists as another user
at_exit() {
    umount "$root/proc" "$root/dev" 2>/dev/null || true
    rm -rf --one-file-system "$root"
}
trap at_exit EXIT

inside() {
    chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}
files() {  # all but what apt, dpkg and ldconfig keep for themselves
    (cd "$root" && find . -xdev \( -path ./var/lib/dpkg -o -path ./var/lib/apt -o -path ./var/cache -o -path ./var/log \
        -o -path ./tmp -o -path ./proc -o -path ./dev -o -name 'ld.so.cache' \) -prune -o -print | sort)
}

echo "== a bare Debian 12 in $root"
debootstrap --variant=minbase bookworm "$root" http://deb.debian.org/debian >"$root.log" 2>&1 ||
    { tail "$root.log" >&2; rm -f "$root.log"; exit 1; }
rm -f "$root.log"
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
# apt would keep what is only recommended, and what it brought along, when it removes.
printf 'APT::Install-Recommends "false";\nAPT::AutoRemove::RecommendsImportant "false";\n' >"$root/etc/apt/apt.conf.d/90try"
inside apt-get update -q >/dev/null
mkdir "$root/tmp/packages"
cp "$packages"/*.deb "$root/tmp/packages"
rm -f "$root"/tmp/packages/*-dbgsym_*.deb
files >"$root/tmp/before"

echo "== apt install"
inside sh -c 'apt-get install -y -q /tmp/packages/palpate_*.deb /tmp/packages/palpate-io-helper_*.deb >/tmp/apt.log 2>&1 || { tail /tmp/apt.log; exit 1; }'
inside palpate --version

echo "== palpate demo"
inside sh -c 'cd /tmp && palpate demo --quiet --output demo && ls demo/*.png'

echo "== Python feels a NumPy array"
inside sh -c 'apt-get install -y -q python3 /tmp/packages/python3-palpate_*.deb >/tmp/apt.log 2>&1 || { tail /tmp/apt.log; exit 1; }'
inside python3 - <<'PYTHON'
import numpy
import palpate

z, y, x = numpy.mgrid[-16:17, -16:17, -16:17]
ball = (100 - 5 * numpy.sqrt(x * x + y * y + z * z)).astype(numpy.float32)
volume = palpate.Volume(ball)
time = numpy.arange(1000) / 1000
hand = numpy.column_stack([numpy.full(1000, 16.0), numpy.full(1000, 16.0), numpy.linspace(0, 8, 1000)])
trace = palpate.replay(palpate.Field(volume), 50, time, hand)
print(f"in contact {trace.constrained.mean():.0%} of the time, at most {numpy.linalg.norm(trace.force, axis=1).max():.2f} N")
assert trace.constrained.any()
PYTHON

echo "== C by pkg-config"
inside sh -c 'apt-get install -y -q gcc libc6-dev pkgconf /tmp/packages/lib*.deb >/tmp/apt.log 2>&1 || { tail /tmp/apt.log; exit 1; }'
cp tests/project/installed.c "$root/tmp"
# shellcheck disable=SC2016  # it expands inside
inside sh -c 'cd /tmp && gcc installed.c -o installed $(pkg-config --cflags --libs palpate-c) && ./installed /usr/share/palpate/visible_human_head.nrrd'

echo "== apt purge"
inside sh -c 'apt-get purge -y -q "*palpate*" gcc libc6-dev pkgconf python3 >/tmp/apt.log 2>&1 && apt-get autoremove --purge -y -q >>/tmp/apt.log 2>&1 || { tail /tmp/apt.log; exit 1; }'
files >"$root/tmp/after"
if left=$(comm -13 "$root/tmp/before" "$root/tmp/after" | grep -i palpate); then
    printf 'try_packages.sh: left behind:\n%s\n' "$left" >&2
    exit 1
fi
echo "nothing of Palpate is left; of what it depends on, $(comm -13 "$root/tmp/before" "$root/tmp/after" | wc -l) files"
