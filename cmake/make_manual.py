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


class Values:
    """What may follow an option, or stand for a positional, as its type in --help says."""

    def __init__(self, kind, about):
        files = re.findall(r"FILE(?:\.(\{[^}]*\}|\w+))?", kind)
        rest = re.sub(r"FILE\.(\{[^}]*\}|\w+)", "", kind)
        found = re.search(r"\{([^}]*)\}", rest)
        self.words = found.group(1).split(",") if found else []
        volumes = re.search(r"synthetic:\{([^}]*)\}", about)
        if volumes:
            self.words += [f"synthetic:{name}" for name in volumes.group(1).split(",")]
        self.endings = [ending for file in files for ending in file.strip("{}").split(",") if ending]
        self.action = "folder" if "FOLDER" in kind else "file" if files or "VOLUME" in kind else ""

    def as_shell(self):
        words, endings = " ".join(self.words), " ".join(self.endings)
        return f"words='{words}' action='{self.action}' endings='{endings}'"


def values_of(lines):
    """The values by name, of options that have some and of positionals."""
    values, section = {}, ""
    entries = []
    for line in lines:
        heading = SECTION.match(line)
        section = heading.group(1) if heading else section if line.strip() else ""
        if section in ("Options", "Positionals") and line[:2] == "  ":
            if line[2:3].strip():
                entries.append(line.strip())
            else:
                entries[-1] += "  " + line.strip()
    for entry in entries:
        head, _, about = entry.partition("  ")
        names, _, kind = head.partition(" ")
        if kind:
            values.update({name: Values(kind, about) for name in names.split(",")})
    return values


def completion(options, values, commands):
    """`options`: those of each command by its name, of palpate itself under ''; `values` too."""
    cases = []
    for command in commands:
        positional = [each for name, each in values[command].items() if name[:1] != "-"]
        more = positional[0].as_shell() if positional else f"words='{' '.join(options[command])}'"
        after = {}
        for name, each in values[command].items():
            if name[:1] == "-":
                after.setdefault(each.as_shell(), []).append(name)
        after = [f"                {'|'.join(names)}) {shell} ;;" for shell, names in after.items()]
        cases += [f"        {command})", f"            options='{' '.join(options[command])}'",
                  '            case "$before" in', *after, f"                *) {more} ;;",
                  "            esac ;;"]
    return COMPLETION.replace("CASES", "\n".join(cases)).replace(
        "COMMANDS", " ".join([*commands, *options[""]]))


COMPLETION = r"""# Completion for bash: palpate's commands, their options, and the values of these.
_palpate() {
    local line=${COMP_LINE:0:COMP_POINT} typed current before words='' action='' endings='' options=''
    read -ra typed <<< "$line"
    [[ $line == *[[:space:]] ]] && typed+=('')
    current=${typed[-1]} before=${typed[-2]}
    if [[ $current == --*=* ]]; then
        before=${current%%=*} current=${current#*=}
    fi
    case "${typed[1]}" in
CASES
    esac
    if ((${#typed[@]} < 3)); then
        words='COMMANDS' action='' endings=''
    elif [[ $current == -* ]]; then
        words=$options action='' endings=''
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    if [[ $action ]]; then
        compopt -o filenames 2> /dev/null
        [[ $action == file && ! $endings ]] && mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$current")
        for ending in $endings; do
            mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -X "!*.$ending" -- "$current")
        done
        [[ $action == folder || $endings ]] && mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -d -- "$current")
    fi
    # Bash takes what follows a colon for a word of its own.
    if [[ $current == *:* && $COMP_WORDBREAKS == *:* ]]; then
        COMPREPLY=("${COMPREPLY[@]#"${current%"${current##*:}"}"}")
    fi
    [[ ${COMPREPLY[*]} == *: ]] && compopt -o nospace 2> /dev/null
    return 0
}
complete -F _palpate palpate
"""


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: make_manual.py PROGRAM VERSION FOLDER")
    program, version, folder = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    pages = folder / "man1"
    pages.mkdir(parents=True, exist_ok=True)
    lines = help_of(program)
    commands = commands_of(lines)
    options, values = {"": options_of(lines)}, {}
    (pages / "palpate.1").write_text(page("palpate", lines, version))
    for command in commands:
        lines = help_of(program, command)
        options[command], values[command] = options_of(lines), values_of(lines)
        (pages / f"palpate-{command}.1").write_text(page(f"palpate-{command}", lines, version))
    (folder / "palpate").write_text(completion(options, values, commands))


if __name__ == "__main__":
    main()
