#!/usr/bin/env python3
"""complete.py LUPDATE TOP: every word in the sources of the viewer has a translation, and every
translation a word. lupdate collects the words into a scratch folder; nothing in TOP is written."""

import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET

SOURCES = "apps/viewer"
TRANSLATIONS = "apps/viewer/translations"
PLURALS_ONLY = {"en"}  # what stands in the sources is English


def collected(lupdate, top, folders, scratch, plurals_only):
    """The words of these folders as a .ts file, and what lupdate has to say against the sources."""
    fresh = pathlib.Path(scratch) / "fresh.ts"
    fresh.unlink(missing_ok=True)
    run = subprocess.run(
        [lupdate, "-I", str(top), *(["-pluralonly"] if plurals_only else []), *map(str, folders),
         "-ts", str(fresh)], capture_output=True, text=True, check=True)
    problems = []
    for line in (run.stdout + run.stderr).splitlines():
        found = re.match(r"(.*?\.[ch]pp):\d+: ", line)
        # lupdate does not know digit separators, and loses the words behind one.
        if found and re.search(r"\btr\(|TR_NOOP|TRANSLATE_NOOP", pathlib.Path(found[1]).read_text()):
            problems.append(line)
    return fresh, problems


def messages(path):
    """(context, words, comment, plural) -> (translations, whether they are in use and finished)"""
    found = {}
    for context in ET.parse(path).getroot().iter("context"):
        for message in context.iter("message"):
            key = (context.findtext("name"), message.findtext("source"),
                   message.findtext("comment") or "", message.get("numerus") == "yes")
            translation = message.find("translation")
            texts = [form.text or "" for form in translation.iter("numerusform")]
            found[key] = (texts or [translation.text or ""], translation.get("type") is None)
    return found


def places(text):
    return sorted(re.findall(r"%L?[1-9n]|%Ln", text))


def incomplete(fresh, kept):
    """What is wrong with the translations `kept`, where the sources have the words `fresh`."""
    problems = []
    wanted, have = messages(fresh), messages(kept)
    for key in sorted(wanted.keys() - have.keys()):
        problems.append(f"not translated: {key[1]!r} of {key[0]}")
    for key in sorted(have.keys() - wanted.keys()):
        problems.append(f"no longer used: {key[1]!r} of {key[0]}")
    for key in sorted(wanted.keys() & have.keys()):
        texts, finished = have[key]
        if not finished or not all(texts):
            problems.append(f"not finished: {key[1]!r} of {key[0]}")
        elif not key[3] and places(texts[0]) != places(key[1]):
            problems.append(f"other places for values: {key[1]!r}: {texts[0]!r}")
        elif key[1].count("&") == 1 and texts[0].count("&") != 1:
            problems.append(f"no mnemonic: {key[1]!r}: {texts[0]!r}")
    return [f"{kept.name}: {problem}" for problem in problems]


def notices_a_new_word(lupdate, top, scratch):
    """Plants a word without a translation beside the sources."""
    planted = pathlib.Path(scratch) / "planted"
    planted.mkdir()
    (planted / "planted.cpp").write_text(
        'struct Planted {\n    Q_DECLARE_TR_FUNCTIONS(Planted)\n};\n'
        'QString words() {\n    return Planted::tr("not in any language");\n}\n')
    fresh, _ = collected(lupdate, top, [top / SOURCES, planted], scratch, False)
    german = top / TRANSLATIONS / "palpate_de.ts"
    return any("'not in any language' of Planted" in problem for problem in incomplete(fresh, german))


def main():
    lupdate, top = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    problems = []
    with tempfile.TemporaryDirectory() as scratch:
        for kept in sorted((top / TRANSLATIONS).glob("palpate_*.ts")):
            plurals_only = kept.stem.removeprefix("palpate_") in PLURALS_ONLY
            fresh, complaints = collected(lupdate, top, [top / SOURCES], scratch, plurals_only)
            problems += complaints + incomplete(fresh, kept)
        if not notices_a_new_word(lupdate, top, scratch):
            problems.append("a word without a translation is not noticed")
    for problem in problems:
        print(problem)
    print(f"translations: {len(problems)} problem(s)")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
