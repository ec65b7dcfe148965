#!/usr/bin/env bash
# Packs the sources of a commit: the same commit gives the same bytes, on every machine.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/source_archive.sh [--commit COMMIT] [FOLDER]

Writes FOLDER/palpate-VERSION.tar.gz (default: the working folder) with the files of COMMIT (default:
HEAD), and its SHA-256 beside it. What is not committed is not packed.
TEXT
}

commit=HEAD
folder=.
while [ $# -gt 0 ]; do
    case "$1" in
        --commit) commit=${2:?--commit needs a commit}; shift 2 ;;
        -h | --help) usage; exit 0 ;;
        -*) echo "source_archive.sh: no option $1" >&2; usage >&2; exit 2 ;;
        *) folder=$1; shift ;;
    esac
done

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if ! git -C "$root" rev-parse --verify --quiet "$commit^{commit}" >/dev/null; then
    echo "source_archive.sh: there is no commit '$commit' in $root" >&2
    exit 1
fi
version=$(git -C "$root" show "$commit:CMakeLists.txt" |
    sed -n 's/^project(palpate VERSION \([0-9.]*\).*/\1/p')
name=palpate-$version
target=$folder/$name.tar.gz
part=$target.part
trap 'rm -f "$part"' EXIT
# Times are the commit's and names are sorted; modes, ends of lines, and a header of gzip without time and name,
# are said here, so that nobody's settings change them.
git -C "$root" -c tar.umask=0022 -c core.autocrlf=false -c core.eol=lf archive --format=tar --prefix="$name/" "$commit" |
    gzip --no-name -9 >"$part"
mv "$part" "$target"
(cd "$folder" && sha256sum "$name.tar.gz" | tee "$name.tar.gz.sha256")
