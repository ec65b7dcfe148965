#!/usr/bin/env python3
"""Checks a built site: every link leads to a file of it, and to a place that is there; nothing (style,
script, font, picture) is loaded from elsewhere. Links to other sites are not followed.

usage: check_links.py SITE
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlparse

LOADS = {("script", "src"), ("img", "src"), ("iframe", "src"), ("link", "href"), ("source", "src")}

DOXYGEN_FORGETS = "nested-classes"  # of classes whose nested ones are private; version 1.9.4


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.places, self.links, self.loaded, self.base = {""}, [], [], path.parent
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.places.update(filter(None, (given.get("id"), given.get("name") if tag == "a" else None)))
        for attribute in ("href", "src"):
            target = given.get(attribute)
            if target is None:
                continue
            external = bool(urlparse(target).netloc)
            if not external:
                self.links.append(target)
            elif (tag, attribute) in LOADS and given.get("rel") not in ("canonical", "author"):
                self.loaded.append(target)


def check(site):
    pages = {path: Page(path) for path in sorted(site.rglob("*.html"))}
    problems = []
    for path, page in pages.items():
        name = path.relative_to(site)
        problems += [f"{name}: loads {address} from elsewhere" for address in page.loaded]
        for link in page.links:
            if urlparse(link).scheme:  # mailto:, javascript:, data:
                continue
            file, place = urldefrag(link)
            file = unquote(file).split("?")[0]
            start = site if file.startswith("/") else page.base
            target = (start / file.lstrip("/")).resolve() if file else path
            if target.is_dir():
                target /= "index.html"
            if not target.exists():
                problems.append(f"{name}: {link} leads nowhere")
            elif (target in pages and unquote(place) not in pages[target].places
                  and place != DOXYGEN_FORGETS):
                problems.append(f"{name}: {link}: there is no such place in {target.relative_to(site)}")
    for path in sorted(site.rglob("*.css")):
        for address in re.findall(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\"')\s]+)",
                                  path.read_text(encoding="utf-8")):
            problems.append(f"{path.relative_to(site)}: loads {address} from elsewhere")
    return pages, problems


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: check_links.py SITE")
    pages, problems = check(Path(sys.argv[1]).resolve())
    print("\n".join(problems + [f"site: {len(pages)} pages, {len(problems)} problem(s)"]))
    sys.exit(1 if problems or not pages else 0)
