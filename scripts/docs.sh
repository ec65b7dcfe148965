#!/usr/bin/env bash
# Builds the documentation as a site, with the API reference, and checks its links.
set -euo pipefail

usage() {
    cat <<'TEXT'
usage: scripts/docs.sh [--no-packages] [--serve [PORT]]

Makes build/docs/site from the pages of the repository (MkDocs) and the public headers (Doxygen).
Warnings are errors: links that lead nowhere, pages that are not in the navigation, mistakes in the
comments of headers. If scripts/deep/web has built the page for the browser, it becomes part of the site and can be
touched on its first page. If a build has the Python module, its reference becomes part of the site. Open
build/docs/site/index.html: the pages need no network and no server. The search box and the page to touch need
one: --serve shows the site at http://127.0.0.1:8000 (PORT) until Ctrl-C.
TEXT
}

packages=yes port=''
while [ $# -gt 0 ]; do
    case $1 in
        --no-packages) packages=no ;;
        --serve)
            port=8000
            if [[ ${2:-} =~ ^[0-9]+$ ]]; then port=$2; shift; fi
            ;;
        -h | --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ "$packages" = no ] || scripts/install_packages.sh docs
out=build/docs
rm -rf "$out"
mkdir -p "$out/pages"
python=/usr/bin/python3 # Debian's, which has MkDocs
"$python" docs/site/by_stage.py --groups include >"$out/groups.dox"
doxygen docs/site/Doxyfile
mv "$out/doxygen/html" "$out/pages/api"
web=build/web/bindings/web/package # scripts/deep/web builds it
if [ -f "$web/palpate_core.wasm.gz" ]; then
    cp -r "$web" "$out/pages/touch"
    rm "$out/pages/touch/README.md" # it would become a page
fi
"$python" docs/site/stage.py . "$out/pages"
mkdir "$out/pages/python"
module=$(find build/*/bindings/python/palpate -name __init__.pyi 2>/dev/null | head -n 1 || true)
if [ -n "$module" ]; then
    PYTHONPATH=${module%/palpate/*} "$python" -B docs/site/python_reference.py "$out/pages/python"
else
    printf '# Python reference\n\nThis site was built without the Python module. %s\n' \
        'Build the module, then build the site again.' >"$out/pages/python/index.md"
fi
version=$(sed -n 's/^project(.*VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
export PALPATE_SITE_NAME="Palpate ${version:?CMakeLists.txt names no version}"
"$python" -m mkdocs build --strict --quiet --config-file docs/site/mkdocs.yml
"$python" docs/site/check_links.py "$out/site"
echo "site: $out/site/index.html"
if [ -n "$port" ]; then
    exec "$python" -m http.server --bind 127.0.0.1 --directory "$out/site" "$port"
fi
