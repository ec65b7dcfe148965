"""The commands of the program palpate that are written in Python. The program starts this folder. python3 -m palpate NAME does the same."""

import sys

if not __package__:  # this folder's modules are no top-level ones
    sys.path[0] = sys.path[0].rpartition("/")[0]

import importlib  # noqa: E402

COMMANDS = {"evaluate": "evaluate.__main__", "study": "trials", "ros": "ros.__main__", "distribute": "distributed"}


def main(words: list[str]) -> int:
    if not words or words[0] not in COMMANDS:
        print(f"palpate: use one of {', '.join(COMMANDS)}, as in python3 -m palpate study --help", file=sys.stderr)
        return 2
    try:
        return importlib.import_module(f"palpate.{COMMANDS[words[0]]}").main(words[1:])
    except ImportError as error:
        first = error.__cause__ or error
        if not isinstance(first, ModuleNotFoundError):
            raise
        print(f"palpate: {words[0]} needs {first.name} (Debian: python3-{first.name})", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
