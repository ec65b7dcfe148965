#!/usr/bin/env python3
"""Follows a tutorial as a reader would: saves its files, runs its commands and programs in an empty folder,
and compares their output with that of the page.

usage: tutorial.py PAGE PREFIX (where Palpate is installed)

Blocks of the page: bash runs `sh`. `python` is run, and neighbouring blocks are one program. If the
first line of a block is a comment that begins with a file name ("// hand.cpp", "# CMakeLists.txt"), the
block is that file, or, if the page has named it before, its continuation. `text` is a part of the output
of the block before it, in which `...` stands for anything.
"""

import os
import re
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

NAME = re.compile(r"(?://|/\*|#|%)\s*([\w./-]+\.\w+)\b")
MARK = "==== the next block ===="


def blocks_of(page):
    """(language, text, line) of each fenced block."""
    fenced, language, lines, begun = False, "", [], 0
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if not line.startswith("```"):
            if fenced:
                lines.append(line)
        elif fenced:
            yield language, "\n".join(lines) + "\n", begun
            fenced = False
        else:
            fenced, language, lines, begun = True, line[3:].strip(), [], number


def environment(prefix, port):
    extra = {"PATH": prefix / "bin", "PYTHONPATH": prefix / "lib/python3/dist-packages",
             "PKG_CONFIG_PATH": prefix / "lib/pkgconfig", "LD_LIBRARY_PATH": prefix / "lib",
             "CMAKE_PREFIX_PATH": prefix}
    merged = dict(os.environ, PYTHONDONTWRITEBYTECODE="1", PORT=str(port))
    for name, path in extra.items():
        merged[name] = ":".join(filter(None, (str(path), os.environ.get(name))))
    return merged


class Reader:
    def __init__(self, page, prefix, folder):
        # Reserved for a server that reuses the address. This socket itself does not listen.
        self.reserved = socket.socket()
        self.reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.reserved.bind(("127.0.0.1", 0))
        self.page, self.folder, self.known = page, folder, environment(prefix, self.reserved.getsockname()[1])
        # `python3` is the one that the module was built for.
        tools = folder / ".tools"
        tools.mkdir()
        (tools / "python3").symlink_to("/usr/bin/python3")
        self.known["PATH"] = f"{tools}:{self.known['PATH']}"
        self.files, self.ran = set(), 0

    def run(self, command, program, line):
        done = subprocess.run(command, input=program, cwd=self.folder, env=self.known,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.ran += 1
        if done.returncode != 0:
            sys.exit(f"{self.page}:{line}: status {done.returncode}\n{program}\nprinted:\n{done.stdout}")
        return done.stdout

    def compare(self, expected, printed, line):
        pattern = ".*".join(re.escape(part) for part in expected.strip().split("..."))
        if not re.search(pattern, printed, re.DOTALL):
            sys.exit(f"{self.page}:{line}: expected:\n{expected}\nprinted:\n{printed}")

    def save(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a" if name in self.files else "w", encoding="utf-8") as file:
            file.write(text)
        self.files.add(name)

    def run_python(self, programs):
        """Neighbouring blocks as one program; what each printed."""
        joined = f"\nprint({MARK!r}, flush=True)\n".join(text for text, _ in programs)
        printed = self.run(["python3", "-"], joined, programs[0][1])
        return printed.split(MARK + "\n")

    def read(self):
        """Runs all; with each program goes what the page says that it prints."""
        pending, expected = [], {}

        def finish():
            if pending:
                for (_, line), printed in zip(pending, self.run_python(pending)):
                    if line in expected:
                        self.compare(expected[line], printed, line)
            pending.clear()

        last = None  # of the block before: its line, or what it printed
        for language, text, line in blocks_of(self.page):
            named = NAME.match(text)
            if language == "text":
                if isinstance(last, int):
                    expected[last] = text
                elif last is not None:
                    self.compare(text, last, line)
                last = None
                continue
            if language == "python" and not named:
                pending.append((text, line))
                last = line
                continue
            finish()
            if named:
                self.save(named[1], text)
                last = None
            elif language == "sh":
                last = self.run(["bash", "-euo", "pipefail"], text, line)
            else:
                sys.exit(f"{self.page}:{line}: a block of '{language}' that is no file is not run by "
                         "anybody: name it in its first line, or mark it as sh, python or text")
        finish()


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: tutorial.py PAGE PREFIX")
    page, prefix = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory(prefix="palpate-tutorial-") as folder:
        reader = Reader(page, prefix, Path(folder))
        reader.read()
        print(f"{page.name}: {reader.ran} programs, {len(reader.files)} files")
        sys.exit(0 if reader.ran else f"{page}: has nothing to run")


if __name__ == "__main__":
    main()
