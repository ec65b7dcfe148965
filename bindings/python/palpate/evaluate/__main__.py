"""The command line: palpate evaluate NAME, or python3 -m palpate.evaluate NAME."""

import argparse
import contextlib
import difflib
import importlib.util
import json
import os
import re
import shlex
import shutil
import signal
import sys
import uuid
from pathlib import Path

if not __package__:  # run as a folder, by the program palpate: this folder's modules are no top-level ones
    sys.path[0] = str(Path(__file__).resolve().parents[2])

EXPERIMENTS = ("drift", "fall-through", "performance", "scaling", "fidelity", "stability", "walk-through",
               "penetration", "layers", "tools", "streaming", "notice", "recorded", "needle")  # in the order of docs/evaluation.md
MOST_SEEDS = 1000
METHODS = ("exact", "paper", "gradient", "gradient-improved")
PACKAGES = ("numpy", "scipy", "matplotlib")  # Debian: python3-NAME
USERS = {"--range": ("penetration",), "--seeds": ("fall-through", "layers", "tools", "recorded"), "--method": ("walk-through",),
         "--seed": ("fall-through", "performance", "scaling", "layers", "tools", "streaming", "recorded",
                    "needle")}  # of options that few use
CLAIMS_BROKEN, WRONG_USE, BAD_INPUT, BAD_OUTPUT, READER_GONE = 1, 2, 3, 5, 141  # exit status, docs/command_line.md
ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
HELP = (Path(__file__).parent / "pages" / "help.txt").read_text(encoding="utf-8").rstrip().format(
    experiments=",".join(EXPERIMENTS), methods=",".join(METHODS), most_seeds=MOST_SEEDS)


class Stop(Exception):
    """The end of the program, with a line on standard error."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


def wrong(text):
    return Stop(WRONG_USE, f"{text} (see palpate evaluate --help)")


def meant(word, names):
    """The names that a misspelt word may stand for, at most one."""
    small = word.lower().lstrip("-")
    bare = {name.lstrip("-"): name for name in names}
    begun = [name for name in bare if len(small) > 1 and name.startswith(small)]
    return [bare[name] for name in (begun or difflib.get_close_matches(small, bare, 1, 0.65))[:1]]


def text_of(text):
    if not text:
        raise argparse.ArgumentTypeError("the value is empty")
    return text


def one_of(names):
    def check(word):
        if text_of(word) not in names:
            hint = "".join(f" (did you mean {name}?)" for name in meant(word, names))
            raise argparse.ArgumentTypeError(f"there is no '{word}': use one of {', '.join(names)}{hint}")
        return word
    return check


def whole_number(least, most):
    def check(text):
        if not re.fullmatch(r"-?[0-9]+", text_of(text)):
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number")
        if not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"{text} is not a whole number from {least} to {most}")
        return int(text)
    return check


def interval(text):
    """A pair of functions of a volume, from 'LOW:HIGH'."""
    ends = text_of(text).split(":")
    try:
        low, high = (float(end.removesuffix("%")) for end in ends)
        if not low <= high or len({end.endswith("%") for end in ends}) == 2:
            raise ValueError
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{text}' is no range such as 12%:20% or 300:900") from error
    if not text.endswith("%"):
        return (lambda volume: low), (lambda volume: high)
    return tuple((lambda volume, part=part: volume.minimum + part / 100 * (volume.maximum - volume.minimum))
                 for part in (low, high))


def complaint(error):
    """What is wrong with an option's value, in the words of the other commands."""
    name = error.argument_name.rpartition("/")[2]
    if error.message.startswith("expected"):
        return f"{name} needs a value: " + re.search(rf"{name} \S+\s+(.*)", HELP).group(1)
    if error.message.startswith("ignored explicit argument"):
        return f"{name}: this option takes no value"
    return f"{name}: {error.message}"


def experiment_of(words, options):
    """The word that is left when the options are taken."""
    end = words.index("--") if "--" in words else len(words)
    for word in words[:end]:
        if word.startswith("-"):
            hint = "".join(f": did you mean {name}?" for name in meant(word.partition("=")[0], options))
            raise wrong(f"there is no option {word}{hint}")
    names = words[:end] + words[end + 1:]
    if not names:
        raise wrong("EXPERIMENT: it is needed, as in palpate evaluate drift")
    try:
        name = one_of((*EXPERIMENTS, "all"))(names[0])
    except argparse.ArgumentTypeError as error:
        raise wrong(f"EXPERIMENT: {error}") from error
    if names[1:]:
        raise wrong(f"'{names[1]}' is one argument too many")
    return name


def arguments(words):
    values = {"-o,--output": text_of, "--volume": text_of, "--data": text_of, "--method": one_of(METHODS), "--range": interval,
              "--seed": whole_number(0, 2**64 - 1), "--seeds": whole_number(1, MOST_SEEDS)}
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False, argument_default=argparse.SUPPRESS)
    options = [parser.add_argument(*names.split(","), action="append", type=value) for names, value in values.items()]
    options += [parser.add_argument(*names.split(","), action="store_true") for names in ("--quick", "--json", "-q,--quiet")]
    try:
        given, rest = parser.parse_known_args(words)
    except argparse.ArgumentError as error:
        raise wrong(complaint(error)) from error
    chosen = argparse.Namespace(output="palpate-evaluation", volume=[], data=None, method="exact", seed=1, seeds=3, range=[], quick=False,
                                json=False, quiet=False, given=[f"--{name}" for name in vars(given)])
    for name, found in vars(given).items():
        once = isinstance(found, list) and not isinstance(getattr(chosen, name), list)
        if once and found[1:]:
            raise wrong(f"--{name}: it is given more than once")
        setattr(chosen, name, found[0] if once else found)
    chosen.name = experiment_of(rest, ["--help", "--version", *(option.option_strings[-1] for option in options)])
    if chosen.data is not None and not Path(chosen.data).is_dir():
        raise Stop(WRONG_USE, f"--data {chosen.data}: there is no such folder")
    chosen.data = chosen.data or os.environ.get("PALPATE_DATA") or None
    missing = [f"python3-{package}" for package in PACKAGES if not importlib.util.find_spec(package)]
    if missing:
        raise Stop(BAD_OUTPUT, f"experiments need NumPy, SciPy and Matplotlib: apt install {' '.join(missing)}")
    return chosen


def lost(stream):
    """For a stream that cannot be written: Python flushes once more at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def say(text, last=False):
    """On standard output. last: the work is done, so a reader that has gone has all that it wanted."""
    try:
        print(text, flush=True)
    except OSError as error:
        lost(sys.stdout)
        if not isinstance(error, BrokenPipeError):
            raise Stop(BAD_OUTPUT, f"standard output: {error.strerror}") from error
        if not last:
            raise Stop(READER_GONE, "") from error


def tell(text):
    """On standard error, in a line."""
    try:
        print(f"palpate: {text}", file=sys.stderr, flush=True)
    except OSError:
        lost(sys.stderr)


def warn_of_no_effect(chosen, names):
    for option, users in USERS.items():
        if option in chosen.given and not set(users) & set(names):
            tell(f"warning: {option} does nothing: it is for {', '.join(users)}")


@contextlib.contextmanager
def unfinished(path):
    """A folder within that of the results, which nothing is left of at the end. Names are known before they are made, so that an interrupt
    while they are made leaves nothing, either."""
    is_new, part = not path.exists(), path / f".palpate-{uuid.uuid4().hex}"
    try:
        try:
            path.mkdir(parents=True, exist_ok=True)
            part.mkdir(mode=0o700)
        except OSError as error:
            raise Stop(BAD_OUTPUT, f"{path}: {error.strerror}: choose another folder with --output") from error
        yield part
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if is_new and path.exists() and not any(path.iterdir()):
            path.rmdir()


def complete(part):
    for file in sorted(part.iterdir()):
        file.replace(part.parent / file.name)


def options_of(chosen, name):
    from palpate.evaluate.experiment import Options
    from palpate.evaluate.subjects import of_texts

    def progress(part):
        if sys.stderr.isatty() and not (chosen.quiet or chosen.json):
            print(f"\r{name} {part:4.0%} ", end="\n" if part >= 1 else "", file=sys.stderr, flush=True)

    def note(text):
        if not chosen.quiet:
            tell(f"note: {name}: {text}")

    return Options(quick=chosen.quick, seed=chosen.seed, seeds=chosen.seeds, method=chosen.method,
                   ranges=tuple(chosen.range), subjects=of_texts(chosen.volume), progress=progress, note=note,
                   data=Path(chosen.data) if chosen.data else None)


def command_of(words):
    """Without the folders of this machine."""
    return shlex.join(["palpate", "evaluate", *(Path(word).name if word.startswith("/") else word for word in words)])


def module_of(name):
    return importlib.import_module(f"palpate.evaluate.{name.replace('-', '_')}")


def run(name, chosen, folder, words):
    """The Report of an experiment whose files are written."""
    from palpate.evaluate import machine, report
    options, module = options_of(chosen, name), module_of(name)
    result = module.run(options)
    result.data = options.used
    options.progress(1)
    made = report.Report(name, module.PAGE.title, result, f"{machine.described(command_of(words))} Seed {chosen.seed}, " + (
        "quick mode (too short for the times to mean anything)." if chosen.quick else "full run."))
    report.write_files(made, folder)
    return made


def shown(made):
    lines = [f"{made.name}: {made.title}", *made.result.paragraphs]
    lines += [f"  {'holds:' if c.held else 'DOES NOT HOLD:'} {c.statement} ({c.measured})" for c in made.claims]
    return "\n".join(lines) + "\n"


def as_json(reports):
    return json.dumps([{"experiment": r.name, "paragraph": " ".join(r.result.paragraphs), "claims": [
        {"statement": c.statement, "holds": c.held, "measured": c.measured} for c in r.claims],
        "circumstances": r.circumstances} for r in reports], indent=2)


def evaluate(chosen, words):
    from palpate.evaluate import report
    names = EXPERIMENTS if chosen.name == "all" else (chosen.name,)
    options_of(chosen, chosen.name)  # refuses volumes before any work
    warn_of_no_effect(chosen, names)
    path, reports = Path(chosen.output), []
    with unfinished(path) as part:
        for name in names:
            try:
                reports.append(run(name, chosen, part, words))
            except ValueError as error:
                if len(names) == 1:
                    raise
                tell(f"note: {name} is left out: {error}")
                continue
            complete(part)
            if not (chosen.quiet or chosen.json):
                say(shown(reports[-1]), last=len(names) == 1)
        if chosen.name == "all":
            if not report.write_pages(reports, path, part):
                tell("note: without report.pdf: it needs WeasyPrint (apt install weasyprint)")
            complete(part)
    if chosen.json:
        say(as_json(reports), last=True)
    elif not chosen.quiet:
        say(f"Results: {chosen.output}{' (open report.html)' if chosen.name == 'all' else ''}", last=True)
    broken = sum(not claim.held for made in reports for claim in made.claims)
    if broken:
        raise Stop(CLAIMS_BROKEN, f"{broken} of the claims do not hold (see above)")


def interrupt(number, frame):
    raise Stop(128 + number, "interrupted")


def main(words):
    for number in ENDS:
        signal.signal(number, interrupt)
    # An interrupt while NumPy or a module of pybind11 is imported would come out of it as an ImportError, or not at all.
    # So the signals wait; the program palpate has blocked them before it became this one.
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ENDS)
    # Closed streams: what is written fails for standard output, and is lost for standard error.
    sys.stdout = sys.stdout or open(os.open(os.devnull, os.O_RDONLY), "w", encoding="utf-8")
    sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")
    try:
        if "--help" in words or "-h" in words:
            say(HELP, last=True)
            return 0
        if "--version" in words:
            import palpate
            say(f"palpate {palpate.__version__}", last=True)
            return 0
        chosen = arguments(words)
        import palpate
        for name in ("report", "machine", "figures", *(EXPERIMENTS if chosen.name == "all" else (chosen.name,))):
            module_of(name)  # with everything that it uses
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDS)
        try:
            evaluate(chosen, words)
        except palpate.InputError as error:
            raise Stop(BAD_INPUT, str(error)) from error
        except (ValueError, OSError) as error:
            raise Stop(BAD_OUTPUT if isinstance(error, OSError) else WRONG_USE, str(error)) from error
    except Exception as error:
        if not hasattr(error, "status"):
            raise
        if error.status != READER_GONE:
            tell(error)
        return error.status
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
