#!/usr/bin/env bash
# Builds the documentation as a site, with the API reference, and checks its links.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/docs.sh [--no-packages]

Makes build/docs/site from the pages of the repository (MkDocs) and the public headers (Doxygen).
Warnings are errors: links that lead nowhere, pages that are not in the navigation, mistakes in the
comments of headers. Open build/docs/site/index.html; the site needs no network and no server.
TEXT
}

packages=yes
case "${1:-}" in
    '') ;;
    --no-packages) packages=no ;;
    -h | --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ "$packages" = no ] || scripts/install_packages.sh docs
out=build/docs
rm -rf "$out"
mkdir -p "$out/pages"
python=/usr/bin/python3 # Debian's, which has MkDocs
"$python" docs/site/by_stage.py --groups include >"$out/groups.dox"
doxygen docs/site/Doxyfile
mv "$out/doxygen/html" "$out/pages/api"
"$python" docs/site/stage.py . "$out/pages"
"$python" -m mkdocs build --strict --quiet --config-file docs/site/mkdocs.yml
"$python" docs/site/check_links.py "$out/site"
echo "site: $out/site/index.html"
