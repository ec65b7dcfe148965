#!/usr/bin/env python3
"""Makes manual pages and completion for bash from what `palpate --help` says."""

import re
import subprocess
import sys
from pathlib import Path

ENTRY = re.compile(r"^  (\S.*?)(?:\s{2,}(\S.*))?$")
SECTION = re.compile(r"^([A-Z][A-Za-z ]*):$")


def help_of(program, *command):
    text = subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True)
    return text.stdout.replace(str(program), "palpate").rstrip().splitlines()


def roff(text):
    """Text that troff takes as it is."""
    escaped = text.replace("\\", r"\e").replace("-", r"\-")
    return r"\&" + escaped if escaped[:1] in (".", "'") else escaped


def commands_of(lines):
    """The names in the list of subcommands."""
    begin = lines.index("Subcommands:")
    names = []
    for line in lines[begin + 1:]:
        if not line.strip():
            break
        if line[2:3].strip():
            names.append(line.split()[0])
    return names


def options_of(lines):
    return sorted(set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", "\n".join(entries_of(lines)))))


def entries_of(lines):
    """The first lines of the entries of all sections, with the options' names."""
    return [line.split("  ")[1] for line in lines if line.startswith("  -")]


def page(name, lines, version):
    """A manual page, section 1."""
    usage = next(i for i, line in enumerate(lines) if line.startswith("Usage:"))
    about = [line for line in lines[:usage] if line.strip()]
    title = about[0].rstrip(".") if about else name
    out = [f'.TH {name.upper()} 1 "" "palpate {version}" "Palpate"', ".SH NAME",
           rf"{roff(name)} \- {roff(title)}", ".SH SYNOPSIS", roff(lines[usage][len("Usage: "):])]
    if about[1:]:
        out += [".SH DESCRIPTION", *map(roff, about[1:])]
    entries = False
    for line in lines[usage + 1:]:
        section = SECTION.match(line)
        if section:
            entries = section.group(1) in ("Options", "Positionals", "Subcommands")
            out += ([] if entries else [".fi"]) + [f".SH {section.group(1).upper()}"]
            out += [] if entries else [".nf"]
        elif not line.strip():
            out.append(".PP" if not entries else "")
        elif entries and line.startswith("  ") and line[2:3].strip():
            word, what = ENTRY.match(line).groups()
            out += [".TP", f".B {roff(word)}"] + ([roff(what)] if what else [])
        else:
            out.append(roff(line.strip() if entries else line))
    return "\n".join(line for line in out if line) + "\n.fi\n"


def completion(options, commands):
    """`options`: those of each command by its name, of palpate itself under ''."""
    cases = "\n".join(f'        {name}) words="{" ".join(found)}" ;;'
                      for name, found in options.items() if name)
    return f"""# Completion for bash: palpate's commands, their options, files.
_palpate() {{
    local words
    case "${{COMP_WORDS[1]}}" in
{cases}
        *) words="{' '.join([*commands, *options[''], ])}" ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}
complete -o default -F _palpate palpate
"""


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: make_manual.py PROGRAM VERSION FOLDER")
    program, version, folder = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    pages = folder / "man1"
    pages.mkdir(parents=True, exist_ok=True)
    lines = help_of(program)
    commands = commands_of(lines)
    options = {"": options_of(lines)}
    (pages / "palpate.1").write_text(page("palpate", lines, version))
    for command in commands:
        lines = help_of(program, command)
        options[command] = options_of(lines)
        (pages / f"palpate-{command}.1").write_text(page(f"palpate-{command}", lines, version))
    (folder / "palpate").write_text(completion(options, commands))


if __name__ == "__main__":
    main()
