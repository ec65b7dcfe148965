#!/usr/bin/env python3
"""Counts patterns that make prose hard to read: in the documentation, the comments of public headers and
the first comment of every source. The counts of a file may only fall: prose_counts.json has them, and a
file without an entry there must be clean. `prose.py ROOT --write` writes the counts as they are now."""

import bisect
import json
import re
import sys
from pathlib import Path

import repository

COUNTS = Path(__file__).with_name("prose_counts.json")
LONG = 35  # words
SEMICOLONS = 0.5  # per 100 words; a file with fewer needs no entry
UNITS = ("update|tick|tetrahedron|voxel|sample|thread|cell|brick|frame|step|file|core|machine|backend|experiment|command|"
         "folder|image|page|line|call|point|contact|piece|run|layer|slice|chunk|request|axis|cube|store|device")
ASKED = re.compile(r"\b(?:says?|said|tells?|told|asks?|asked|know|knows|sees?|shows?|explains?|decides?|matter)"
                   r"(?: \w+)? $", re.IGNORECASE)  # before a "what" that is a question
LEFT_OUT = {"CHANGELOG.md"}  # a record of the past

# What is counted, the remedy, and the pattern within a sentence.
RULES = {
    "long": (f"more than {LONG} words; write one idea per sentence, rarely more than 25 words", None),
    "fronted": ("begin with subject and verb: 'For stores, the viewer shows ...', not 'Of a store, ...'",
                re.compile(r"^(?:Of|Beside|Where)\s(?!to\b)(?!.*\?$)")),
    "is not": ("write 'unknown members', not 'members that there are not'",
               re.compile(r"\b(?:that|which|what) (?:there|it|they) (?:is|are|has|have) not\b")),
    "per": ("write '30 ns per tetrahedron', not '30 ns a tetrahedron'",
            re.compile(rf"(?:\d[\w.,]*|\b(?:ns|us|µs|ms|MB|\w+seconds?|bytes?|[Oo]ne (?:row|{UNITS})|updates|ticks)) an? (?:{UNITS})\b")),
    "what": ("write a noun, not a what-clause: 'missing fields', not 'what a file lacks'",
             re.compile(r"\b[Ww]hat (?!to\b|(?:\w+ ){0,1}\w+$)(?=\w)(?!.*\?$)")),
    "semicolons": ("split the sentence at the semicolon", re.compile(";")),
}


def plain(text):
    """A line of Markdown without its marks: code is one word, links are their text."""
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)|<!--.*?-->", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"`[^`]*`", "code", text))
    text = re.sub(r"https?://\S+", "link", re.sub(r"[*]+|</?\w[^>]*>|&\w+;", "", text))
    return re.sub(r"\b(e\.g|i\.e|et al|Figs?|Eqs?|vs|cf|approx)\.", r"\1", text)


def markdown(text):
    """Paragraphs, list items and cells of tables, each as [(line, text)], without code and headings."""
    block, fenced = [], False
    for number, line in enumerate(text.splitlines() + [""], 1):
        start = line.strip()
        fence, item = start.startswith("```"), re.match(r"(?:[-*]|\d+\.)\s+", start)
        fenced ^= fence
        code = fenced or fence or not block and line.startswith("    ") and not item
        if code or item or not start or start[0] in "#|":
            yield block
            block = []
        if start.startswith("|") and not code:
            yield from ([(number, plain(cell))] for cell in re.split(r"(?<!\\)\|", start.strip("|")))
        elif start and not code and start[0] != "#":
            block.append((number, plain(start[item.end() if item else 0:])))


def comments(text, everywhere):
    """Blocks of comments: all of a public header, the first of any other file."""
    block = []
    for number, line in enumerate(text.splitlines() + [""], 1):
        whole = re.match(r"\s*(?://+<?|/\*+|\*+/?|#(?= ))(.*)$", line)
        trailing = re.search(r"[;,{}].*?(?<!:)//+<?\s(.*)$", line) if everywhere and not whole else None
        if whole and whole.group(1).strip(" */"):
            block.append((number, plain(whole.group(1).replace("*/", "").strip())))
            continue
        yield block
        if block and not whole and not everywhere:
            return
        block = []
        if trailing:
            yield [(number, plain(trailing.group(1)))]


def opening(text):
    """The docstring that opens a Python file."""
    match = re.match(r'(?:#[^\n]*\n|\s*\n)*"""(.*?)"""', text, re.DOTALL)
    first = text.count("\n", 0, match.start(1)) if match else 0
    return markdown("\n" * first + match.group(1)) if match else ()


def sentences(block):
    """(line, sentence) of every sentence of a block."""
    starts, text = [], ""
    for _, line in block:
        starts.append(len(text))
        text += line.strip() + " "
    for match in re.finditer(r"\S.*?(?:[.!?][)\"']*(?=\s+[\"'(\[]?(?:[A-Z0-9]|code))|$)", text.rstrip()):
        yield block[bisect.bisect_right(starts, match.start()) - 1][0], match.group()


def blocks(root):
    """(file, blocks of prose) of everything that is checked."""
    for path in repository.files(root, (".md", ".cpp", ".hpp", ".h", ".py", ".sh", ".cmake")):
        name, text = str(path.relative_to(root)), path.read_text(encoding="utf-8")
        if path.suffix == ".md":
            yield name, () if name in LEFT_OUT else markdown(text)
        else:
            yield name, opening(text) if path.suffix == ".py" else comments(text, name.startswith("include/"))


def hits(rule, sentence):
    """How often a sentence breaks a rule."""
    if rule == "long":
        return int(len(sentence.split()) > LONG)
    return sum(rule != "what" or not ASKED.search(sentence[:match.start()]) for match in RULES[rule][1].finditer(sentence))


def found_in(parts):
    """{rule: [(line, sentence)]} of the blocks of a file, its words and its sentences."""
    found, words, total = {}, 0, 0
    for line, sentence in (pair for block in parts if block for pair in sentences(block)):
        words, total = words + len(sentence.split()), total + (" " in sentence)
        for rule in RULES:
            for _ in range(hits(rule, sentence)):
                found.setdefault(rule, []).append((line, sentence))
    if len(found.get("semicolons", ())) <= SEMICOLONS * words / 100:
        found.pop("semicolons", None)
    return found, words, total


def main():
    write = sys.argv[2:] == ["--write"]
    root = Path(sys.argv[1]).resolve() if len(sys.argv) == 2 + write else sys.exit("usage: prose.py ROOT [--write]")
    before = json.loads(COUNTS.read_text(encoding="utf-8")) if not write else {}
    now, problems, all_words, all_sentences = {}, [], 0, 0
    for name, parts in blocks(root):
        found, words, total = found_in(parts)
        all_words, all_sentences = all_words + words, all_sentences + total
        now[name] = {rule: len(places) for rule, places in found.items()}
        for rule, places in found.items():
            allowed = before.get(name, {}).get(rule, 0)
            if len(places) > allowed:
                problems += [f"{name}:{line}: {rule} ({len(places)}, at most {allowed}): {RULES[rule][0]}\n    {text[:100]}"
                             for line, text in places]
    problems += [f"prose_counts.json: {name} is no file: prose.py ROOT --write" for name in before if name not in now]
    if write:
        rows = (f"{json.dumps(name)}: {json.dumps(counts)}" for name, counts in sorted(now.items()) if counts)
        COUNTS.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")
        problems = []
    sums = {rule: sum(counts.get(rule, 0) for counts in now.values()) for rule in RULES}
    print(f"{all_words} words, {all_sentences} sentences ({100 * sums['long'] / all_sentences:.1f} % long), "
          f"{100 * sums['semicolons'] / all_words:.2f} semicolons per 100 words:", sums)
    repository.finish(problems, "prose")


if __name__ == "__main__":
    main()
