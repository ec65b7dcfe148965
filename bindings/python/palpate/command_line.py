"""Commands of the program palpate that are written in Python: options, help and complaints as those of the commands in C++
(apps/options), signals and exit status as docs/command_line.md says."""

import argparse
import difflib
import io
import math
import os
import re
import signal
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NoReturn, Optional, TextIO

from .errors import DeviceError, Error, InputError

ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
STATUS = ((InputError, 3), (DeviceError, 4), (OSError, 5))  # docs/command_line.md
READER_GONE = 141
EMPTY = "the value is empty"
_USER = re.compile(r"(?<=://)[^/?#\s]*@")
_QUERY = re.compile(r"(://[^\s'\"<>?]*\?)[^\s'\"<>]*?(?=[:,;)]*(?:[\s'\"<>]|$))")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf)", re.IGNORECASE)


class Stop(Exception):
    """The end of the program with this exit status and, if there is one, a line on standard error."""

    def __init__(self, status: int, text: str = "") -> None:
        super().__init__(text)
        self.status = status


class Kind:
    """What an option takes: as --help shows it, and how its text is read, with a ValueError for what it does not take."""

    def __init__(self, shown: str, read: Callable[[str], Any] = str) -> None:
        self.shown, self.read = shown, read

    def __call__(self, text: str) -> Any:
        if not text:
            raise argparse.ArgumentTypeError(EMPTY)
        try:
            return self.read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error


def number(words: str = "", fits: Callable[[float], bool] = math.isfinite) -> Kind:
    """A number that fits; `words` say which do."""
    def read(text: str) -> float:
        if not _NUMBER.fullmatch(text):
            comma = ": its decimals follow a point, as in 1.5" if re.search(r"\d,\d", text) else ""
            raise ValueError(f"'{text}' is not a number{comma}")
        if not fits(float(text)):
            raise ValueError(f"{text} is not {words or 'a finite number'}")
        return float(text)
    return Kind(f"FLOAT:{words}" if words else "FLOAT", read)


ABOVE_ZERO = number("a number above 0", lambda x: 0 < x < math.inf)


def whole(least: int = 0, most: int = 2**31 - 1) -> Kind:
    def read(text: str) -> int:
        if not re.fullmatch(r"[+-]?\d+", text):
            raise ValueError(f"'{text}' is not a whole number")
        if not least <= int(text) <= most:
            raise ValueError(f"{text} is not a whole number from {least} to {most}")
        return int(text)
    return Kind("UINT", read)


def one_of(names: Sequence[str]) -> Kind:
    def read(text: str) -> str:
        if text not in names:
            raise ValueError(f"there is no '{text}': use one of {', '.join(names)}{_meant(text, names)}")
        return text
    return Kind(f"TEXT:{{{','.join(names)}}}", read)


def _meant(word: str, names: Sequence[str]) -> str:
    near = difflib.get_close_matches(word, names, 1, 0.65)
    return f" (did you mean {near[0]}?)" if near else ""


class _Once(argparse.Action):
    def __call__(self, parser: Any, namespace: Any, values: Any, option: Optional[str] = None) -> None:
        if self.dest in parser.given:
            raise argparse.ArgumentError(self, "it is given more than once")
        parser.given.add(self.dest)
        setattr(namespace, self.dest, values)


class Parser(argparse.ArgumentParser):
    """Of one command. Options take a Kind as their type; `optional` positionals are checked by the command."""

    def __init__(self, name: str, about: str, examples: Sequence[str]) -> None:
        super().__init__(prog=f"palpate {name}", description=about, add_help=False, allow_abbrev=False, exit_on_error=False)
        self.examples, self.given = [f"palpate {name} {words}" for words in examples], set[str]()
        self.needed: list[argparse.Action] = []  # asked for after misspelt options, so argparse does not ask
        for store in (None, "store"):
            self.register("action", store, _Once)
        self.add_argument("-h", "--help", action="store_true", help="Print this help message and exit")
        self.add_argument("--version", action="store_true", help="Display program version information and exit")

    def add(self, *names: str, kind: Kind, optional: bool = False, **more: Any) -> None:
        action = self.add_argument(*names, type=kind, metavar=kind.shown, **more)
        if not action.option_strings:
            action.metavar, action.required = names[0].upper(), not optional
        if action.required:
            self.needed.append(action)
            action.required = False

    def arguments(self, words: Sequence[str]) -> argparse.Namespace:
        """Ends the program after help, the version or a complaint."""
        # Closed streams: what is written fails for standard output, and is lost for standard error.
        sys.stdout = sys.stdout or open(os.open(os.devnull, os.O_RDONLY), "w", encoding="utf-8")
        sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors="surrogateescape")  # names of files may be any bytes
        if "-h" in words or "--help" in words:
            self.exit(0, self.format_help())
        if "--version" in words:
            from . import __version__
            self.exit(0, f"palpate {__version__}")
        self.given.clear()
        try:
            chosen, rest = self.parse_known_args(words)
        except argparse.ArgumentError as error:
            if not str(error.argument_name).startswith("-"):
                self._refuse_misspelt(words)
            self.error(self._complaint(error))
        self._refuse_misspelt(words)
        if rest := [word for word in rest if word != "--"]:
            self.error(f"'{rest[0]}' is one argument too many")
        for action in self.needed:
            if action.dest not in self.given:
                self.error(f"{(action.option_strings or [str(action.metavar)])[-1]}: it is needed, as in {self.examples[0]}")
        return chosen

    def warn_of_no_effect(self, options: Sequence[str], why: str) -> None:
        """Options, without dashes, that change nothing beside the others."""
        useless = [f"--{option}" for option in options if option.replace("-", "_") in self.given]
        if useless:
            tell(f"warning: {', '.join(useless)} {'does' if len(useless) == 1 else 'do'} nothing: {why}")

    def _refuse_misspelt(self, words: Sequence[str]) -> None:
        known = self._option_string_actions
        for word in words[:words.index("--") if "--" in words else None]:
            name = word.partition("=")[0]
            if word.startswith("-") and not _NUMBER.fullmatch(word) and name not in known and (name[:2] == "--" or name[:2] not in known):
                near = _meant(name, [action.option_strings[-1] for action in self._actions if action.option_strings]).strip(" ()")
                self.error(f"there is no option {word}" + (f": {near}" if near else ""))

    def _complaint(self, error: argparse.ArgumentError) -> str:
        name = str(error.argument_name).rpartition("/")[2]
        if error.message.startswith("expected"):
            about = next(action.help for action in self._actions if name in (*action.option_strings, action.metavar))
            return f"{name} needs a value: {about}"
        if error.message.startswith("ignored explicit argument"):
            return f"{name}: this option takes no value"
        return f"{name}: {error.message}"

    def error(self, message: str) -> NoReturn:
        tell(f"{message} (see {self.prog} --help)")
        sys.exit(2)

    def exit(self, status: int = 0, message: Optional[str] = None) -> NoReturn:
        try:
            say(str(message), last=True)
        except Stop as stop:
            tell(stop)
            status = stop.status
        sys.exit(status)

    def format_help(self) -> str:
        positionals = [action for action in self._actions if not action.option_strings]
        usage = ["[OPTIONS]", *(f"{action.metavar}" if action in self.needed else f"[{action.metavar}]" for action in positionals)]
        lines = [str(self.description), f"Usage: {self.prog} {' '.join(usage)}"]
        for title, actions in (("Positionals", positionals), ("Options", [a for a in self._actions if a.option_strings])):
            if actions:
                lines += ["", f"{title}:", *(line for action in actions for line in _entry(action, action in self.needed))]
        return "\n".join([*lines, "", "Examples:", *(f"  {words}" for words in self.examples)])


def _entry(action: argparse.Action, is_needed: bool) -> Iterator[str]:
    names = ",".join(action.option_strings) or str(action.metavar)
    kind = action.type.shown if isinstance(action.type, Kind) else ""
    head = " ".join(filter(None, (names, kind, "..." if action.nargs == "+" else "", "REQUIRED" if is_needed else "")))
    usual = f"{action.default:g}" if isinstance(action.default, float) else str(action.default)
    about = f"{action.help}{f' [{usual}]' if action.type and action.default not in (None, (), math.inf) else ''}"
    yield from ([f"  {head:<27} {about}"] if len(head) < 28 else [f"  {head}", f"{'':30}{about}"])


def _lost(stream: TextIO) -> None:
    """For a stream that cannot be written: Python flushes once more at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def say(text: str, last: bool = False, end: str = "\n") -> None:
    """On standard output. last: the work is done, so a reader that has gone has all that it wanted."""
    try:
        print(text, end=end, flush=True)
    except OSError as error:
        _lost(sys.stdout)
        if not isinstance(error, BrokenPipeError):
            raise Stop(5, f"standard output: {error.strerror}") from error
        if not last:
            raise Stop(READER_GONE) from error


def answer_to(text: str) -> str:
    """A line of standard input."""
    say(text, end="")
    return input()


def without_secrets(text: str) -> str:
    """The text without user, password and query of its addresses, as io::without_secrets() in palpate/io/error.hpp."""
    return _QUERY.sub(r"\1...", _USER.sub("", text))


def remark(text: str, end: str = "\n") -> None:
    """On standard error, where nothing depends on it. Without what gives access to addresses in the text."""
    try:
        print(without_secrets(text), end=end, file=sys.stderr, flush=True)
    except OSError:
        _lost(sys.stderr)


def tell(text: object) -> None:
    """On standard error, in a line."""
    shown = str(text).encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")  # words may be any bytes
    shown = _CONTROL.sub(" ", shown)
    remark(f"palpate: {shown if len(shown) <= 6000 else f'{shown[:5500]}...{shown[-500:]}'}")


def _tell_warning(message: object, *place: object) -> None:
    tell(f"warning: {message}")


def _end(number: int, frame: Any) -> NoReturn:
    raise KeyboardInterrupt(number)


def _end_at_once(number: int, frame: Any) -> NoReturn:
    tell("interrupted")
    os._exit(128 + number)


def run(work: Callable[[], Any], interrupted: str = "interrupted", load: Callable[[], Any] = lambda: None) -> int:
    """Does the work of a command. Returns its exit status; what goes wrong is one line on standard error. Modules are loaded by `load`:
    an interrupt while NumPy or a module of pybind11 is imported would come out of it as an ImportError, or not at all. There is nothing to
    put in order yet, so it ends the program."""
    def handle_ends(by: Callable[[int, Any], NoReturn]) -> None:
        for end in ENDS:
            signal.signal(end, by)

    warnings.showwarning = _tell_warning
    try:
        handle_ends(_end_at_once)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDS)
        load()
        handle_ends(_end)
        work()
        sys.stdout.flush()
    except KeyboardInterrupt as error:
        tell(interrupted)
        return 128 + (error.args or (signal.SIGINT,))[0]
    except BrokenPipeError:
        _lost(sys.stdout)
        return READER_GONE
    except Stop as stop:
        if str(stop):
            tell(stop)
        return stop.status
    except (Error, ValueError, OSError, RuntimeError) as error:
        tell(error)
        return next((status for kind, status in STATUS if isinstance(error, kind)), 2)
    except EOFError:
        tell("standard input ended before an answer")
        return 2
    except MemoryError:
        tell("not enough memory: use a smaller volume, or one of fewer bits")
        return 3
    except Exception as error:
        if os.environ.get("PALPATE_TRACEBACK"):
            traceback.print_exc()
        tell(f"{type(error).__name__}: {error} (PALPATE_TRACEBACK=1 shows where)")
        return 2
    return 0
