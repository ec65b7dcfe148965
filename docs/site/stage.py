#!/usr/bin/env python3
"""Lays out the pages of the site as the repository has them, so that links between pages hold as
they stand. A linked file that is no page becomes one that shows it, a linked folder one that lists it.

usage: stage.py ROOT OUT
"""

import html
import os
import re
import shutil
import sys
from pathlib import Path

PAGES = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "data/README.md")
LINK = re.compile(r"(?<=\]\()([^)\s#]+)")
FENCED = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)  # where a lambda of C++ looks like a link
TOUCH = """
<p><a class="touch-here" href="touch/page/index.html">Touch a CT head here, in your browser</a></p>
"""
PROGRAM = re.compile(r"^```js\n(.*?)^```$", re.MULTILINE | re.DOTALL)
ITEM = re.compile(r"( *)([-*]|\d+[.)]) +")
LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".c": "c", ".h": "c", ".py": "python", ".cs": "csharp",
             ".sh": "sh", ".json": "json"}


def for_markdown(text):
    """GitHub's Markdown as Python's reads it: a blank line before lists and tables, and what belongs
    to an item indented by four."""
    lines, items, fenced, paragraph = [], [], False, False  # items: (indent, where its text begins)
    for line in text.splitlines():
        bare = line.lstrip()
        indent = len(line) - len(bare)
        fence = bare.startswith("```")
        item = None if fenced or fence else ITEM.match(line)
        if fenced or fence or not bare:
            paragraph = False
        elif item:
            while items and items[-1][0] >= indent:
                items.pop()
            if paragraph and not items:
                lines.append("")
            line = "    " * len(items) + bare
            items.append((indent, len(item[0])))
            paragraph = False
        elif indent and items:
            while items and items[-1][1] > indent:
                items.pop()
            line = "    " * len(items) + line[items[-1][1] if items else 0:]
        else:
            if bare.startswith("|") and paragraph and not lines[-1].startswith("|"):
                lines.append("")
            if not lines or not lines[-1].strip():
                items = []
            paragraph = not items
        fenced ^= fence
        lines.append(line)
    return "\n".join(lines) + "\n"


class Site:
    def __init__(self, root, out):
        self.root, self.out = root, out
        self.shown = set()  # files and folders that get a page because something links to them

    def run(self):
        pages = [self.root / name for name in PAGES]
        for path in sorted((self.root / "docs").rglob("*")):
            if path.is_file() and "site" not in path.relative_to(self.root).parts:
                if path.suffix == ".md":
                    pages.append(path)
                else:
                    self.copy(path)
        navigation = (self.root / "docs/site/mkdocs.yml").read_text(encoding="utf-8")
        left_out = [name for page in pages if (name := str(page.relative_to(self.root))) not in navigation]
        if left_out:
            sys.exit(f"docs/site/mkdocs.yml: its navigation lacks {', '.join(left_out)}")
        for page in pages:
            self.write(page.relative_to(self.root), self.linked(page))
        if (self.out / "touch").is_dir():
            self.embed()
        for path in sorted(self.shown):
            self.show(path)
        for name in ("site.css", "cell.js"):
            shutil.copy(self.root / "docs/site" / name, self.out)
        (self.out / "js").mkdir()
        shutil.copy(self.root / "docs/site/theme_extra.js", self.out / "js")
        # The name by which Debian's theme asks for it, which is not in its package.
        shutil.copy("/usr/share/javascript/jquery/jquery.min.js", self.out / "js/jquery-3.6.0.min.js")

    def embed(self):
        """Puts the page for the browser below the first paragraph of the site, and lets programs in JavaScript run."""
        for page in sorted(self.out.rglob("*.md")):
            text = page.read_text(encoding="utf-8")
            if PROGRAM.search(text):
                page.write_text(self.with_cells(text, "../" * (len(page.relative_to(self.out).parts) - 1)), encoding="utf-8")
        title, first, rest = (self.out / "README.md").read_text(encoding="utf-8").split("\n\n", 2)
        self.write("README.md", "\n\n".join((title, first, TOUCH.strip(), rest)))

    def with_cells(self, text, top):
        """Programs of a page become fields that cell.js runs; `top` leads to the top of the site."""
        def cell(match):
            program = html.escape(match[1].rstrip("\n"))
            return (f'<div class="cell" data-module="{top}touch/palpate.js"><textarea aria-label="Program" spellcheck="false" '
                    f'rows="{program.count(chr(10)) + 1}">\n{program}</textarea></div>')
        return PROGRAM.sub(cell, text) + f'\n<script type="module" src="{top}cell.js"></script>\n'

    def write(self, relative, text):
        to = self.out / relative
        to.parent.mkdir(parents=True, exist_ok=True)
        to.write_text(text, encoding="utf-8")

    def copy(self, path):
        to = self.out / path.relative_to(self.root)
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, to)

    def linked(self, page):
        """The page's text; links to files and folders that are no pages lead to those that show them."""
        def target(match):
            link = match[1]
            if ":" in link:
                return link
            path = Path(os.path.normpath(page.parent / link))
            if not path.exists():
                sys.exit(f"{page.relative_to(self.root)}: links to {link}, which is not there")
            if path.suffix == ".md" or self.root / "docs" in path.parents:
                return link
            self.shown.add(path)
            return link.rstrip("/") + ("/index.md" if path.is_dir() else ".md")
        parts = FENCED.split(page.read_text(encoding="utf-8"))
        parts[::2] = (LINK.sub(target, part) for part in parts[::2])
        return for_markdown("".join(parts))

    def show(self, path):
        relative = path.relative_to(self.root)
        if path.is_dir():
            files = [p for p in sorted(path.rglob("*"))
                     if p.is_file() and "__pycache__" not in p.parts]
            names = "".join(f"- [{p.relative_to(path)}]({p.relative_to(path)}.md)\n" for p in files)
            self.write(relative / "index.md", f"# {relative}\n\n{names}")
            for file in files:
                if file not in self.shown:
                    self.show(file)
            return
        text = path.read_text(encoding="utf-8")
        language = LANGUAGES.get(path.suffix, "text")
        self.write(Path(str(relative) + ".md"), f"# {relative}\n\n```{language}\n{text}\n```\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip().splitlines()[-1])
    Site(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()).run()
