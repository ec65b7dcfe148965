#!/usr/bin/env python3
"""Everything that says which version this is says the same, and the same day."""

import re
import sys
from datetime import datetime
from pathlib import Path

ROOT = Path(sys.argv[1])


def found(path, pattern):
    match = re.search(pattern, (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)
    if match is None:
        sys.exit(f"{path}: has nothing like {pattern}")
    return match.groups()


(version,) = found("CMakeLists.txt", r"^project\(palpate VERSION (\d+\.\d+\.\d+) ")
minor = version.rpartition(".")[0]
problems = []


def agree(path, what, said, expected):
    if said != expected:
        problems.append(f"{path}: {what} is {said}, but {expected} in CMakeLists.txt or CHANGELOG.md")


# The newest section with a date; above it is only what comes next.
changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
headings = re.findall(r"^## (.*)$", changes, re.MULTILINE)
# Branches that add lines are merged as a union of both sides, which may bring released notes back.
if re.search(r"[^\n]\n#+ ", changes):
    problems.append("CHANGELOG.md: a heading without an empty line before it: what has a merge done here?")
if headings[0] != "Unreleased":
    problems.append("CHANGELOG.md: does not begin with a section Unreleased")
newest, day = re.fullmatch(r"(\d+\.\d+\.\d+) - (\d{4}-\d{2}-\d{2})", headings[1]).groups()
agree("CHANGELOG.md", "the newest section", newest, version)
agree("CITATION.cff", "version", found("CITATION.cff", r"^version: (.*)$")[0], version)
agree("CITATION.cff", "date-released", found("CITATION.cff", r"^date-released: (.*)$")[0], day)
metainfo = "apps/viewer/desktop/palpate.metainfo.xml"
release = found(metainfo, r'<release version="(.*?)" date="(.*?)"/>')
agree(metainfo, "the first release", release, (version, day))
debian = "cmake/debian/changelog.in"
said = datetime.strptime(found(debian, r"  (\w{3}, \d\d \w{3} \d{4}) ")[0], "%a, %d %b %Y")
agree(debian, "the day", said.strftime("%Y-%m-%d"), day)
for path in ("docs/package.md", *sorted(str(p.relative_to(ROOT)) for p in
                                        (ROOT / "tests/consumer").rglob("CMakeLists.txt"))):
    for asked in re.findall(r"find_package\(palpate (\d[\d.]*)", (ROOT / path).read_text(encoding="utf-8")):
        agree(path, "find_package(palpate ...)", asked, minor)
print("\n".join(problems) or f"version {version} of {day}, everywhere")
sys.exit(1 if problems else 0)
