"""The command line: palpate evaluate NAME, or python3 -m palpate.evaluate NAME."""

import argparse
import importlib.util
import json
import os
import shlex
import shutil
import signal
import sys
import tempfile
from pathlib import Path

if not __package__:  # run as a folder, by the program palpate: this folder's modules are no top-level ones
    sys.path[0] = str(Path(__file__).resolve().parents[2])

EXPERIMENTS = ("drift", "fall-through", "performance", "scaling", "fidelity", "stability", "walk-through",
               "penetration", "layers", "tools", "streaming")  # in the order of docs/evaluation.md
IN_PYTHON = ("drift", "fall-through", "walk-through", "penetration", "fidelity")
METHODS = ("exact", "paper", "gradient", "gradient-improved")
PACKAGES = ("numpy", "scipy", "matplotlib")  # Debian: python3-NAME
CLAIMS_BROKEN, WRONG_USE, BAD_INPUT, BAD_OUTPUT = 1, 2, 3, 5  # exit status, docs/command_line.md
HELP = f"""Run experiments; each gives a table, figures and checked claims

Usage: palpate evaluate [OPTIONS] EXPERIMENT

Positionals:
  EXPERIMENT                  Which experiment, or all

Options:
  -h,--help                   Print this help message and exit
  --version                   Display program version information and exit
  -o,--output FOLDER          Folder for the results [palpate-evaluation]
  --volume VOLUME@ISOVALUE    Volume to use instead of the experiment's own; may be given again
  --data FOLDER               Folder with the real volumes that some experiments use, such as lobster.nrrd (default: environment PALPATE_DATA)
  --method METHOD             Proxy method, for experiments that show one: {', '.join(METHODS)} [exact]
  --seed N                    Seed of everything random [1]
  --seeds N                   How many seeds draw their own lines, from the first one on; for fall-through [3]
  --range LOW:HIGH            Range of interest, in the data's units or in percent of its range, for penetration; may be given again
  --quick                     Seconds instead of minutes; every claim is checked all the same
  --json                      Print paragraphs and claims as JSON
  -q,--quiet                  Print nothing

Experiments: {', '.join(EXPERIMENTS)}.
all runs every experiment and adds report.html, which needs no other file.
Exit status 1: a claim does not hold.

Examples:
  palpate evaluate drift --output results
  palpate evaluate fall-through --volume head.nrrd@34.5 --volume synthetic:torus
  palpate evaluate penetration --volume head.nrrd@12% --range 12%:20% --range 45%:100%
  palpate evaluate all --quick"""


class Stop(Exception):
    """The end of the program, with a line on standard error."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Stop(WRONG_USE, f"{message} (see palpate evaluate --help)")


def whole_number(text):
    if not text.isdecimal() or int(text) >= 2**64:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number of 0 or more")
    return int(text)


def interval(text):
    """A pair of functions of a volume, from 'LOW:HIGH'."""
    ends = text.split(":")
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


def arguments(words):
    parser = Parser(add_help=False, allow_abbrev=False)
    parser.add_argument("name", metavar="EXPERIMENT", choices=(*EXPERIMENTS, "all"))
    parser.add_argument("-o", "--output", default="palpate-evaluation")
    parser.add_argument("--volume", action="append", default=[])
    parser.add_argument("--data", default=None)
    parser.add_argument("--method", choices=METHODS, default="exact")
    parser.add_argument("--seed", type=whole_number, default=1)
    parser.add_argument("--seeds", type=whole_number, default=3)
    parser.add_argument("--range", type=interval, action="append", default=[])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("-q", "--quiet", action="store_true")
    chosen = parser.parse_args(words)
    if chosen.data is not None and not Path(chosen.data).is_dir():
        raise Stop(WRONG_USE, f"--data {chosen.data}: there is no such folder")
    chosen.data = chosen.data or os.environ.get("PALPATE_DATA") or None
    missing = [f"python3-{name}" for name in PACKAGES if not importlib.util.find_spec(name)]
    if missing:
        raise Stop(BAD_OUTPUT, f"experiments need NumPy, SciPy and Matplotlib: apt install {' '.join(missing)}")
    return chosen


class Folder:
    """The folder of the results; what is not complete leaves nothing behind."""

    def __init__(self, path):
        self.path = Path(path)
        self.is_new = not self.path.exists()
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self.part = Path(tempfile.mkdtemp(prefix=".palpate-", dir=self.path))
        except OSError as error:
            raise Stop(BAD_OUTPUT, f"{path}: {error.strerror}: choose another folder with --output") from error

    def complete(self):
        for file in sorted(self.part.iterdir()):
            file.replace(self.path / file.name)
        self.is_new = False

    def close(self):
        shutil.rmtree(self.part, ignore_errors=True)
        if self.is_new:
            self.path.rmdir()


def options_of(chosen, name):
    from palpate.evaluate.experiment import Options
    from palpate.evaluate.subjects import of_text

    def progress(part):
        if sys.stderr.isatty() and not (chosen.quiet or chosen.json):
            print(f"\r{name} {part:4.0%} ", end="\n" if part >= 1 else "", file=sys.stderr, flush=True)

    def note(text):
        if not chosen.quiet:
            print(f"palpate: note: {name}: {text.removeprefix(name + ': ')}", file=sys.stderr)

    return Options(quick=chosen.quick, seed=chosen.seed, seeds=max(1, chosen.seeds), method=chosen.method,
                   ranges=tuple(chosen.range),
                   subjects=tuple(map(of_text, chosen.volume)), progress=progress, note=note,
                   data=Path(chosen.data) if chosen.data else None)


def command_of(words):
    """Without the folders of this machine."""
    return shlex.join(["palpate", "evaluate",
                       *(Path(word).name if word.startswith("/") else word for word in words)])


def run(name, chosen, folder, words):
    """The Report of an experiment whose files are written."""
    from palpate.evaluate import compiled, machine, report
    options = options_of(chosen, name)
    if name in IN_PYTHON:
        module = importlib.import_module(f"palpate.evaluate.{name.replace('-', '_')}")
        title, result = module.TITLE, module.run(options)
    else:
        title, result = compiled.TITLES[name], compiled.run(name, options, chosen.volume, folder)
    options.progress(1)
    made = report.Report(name, title, result, f"{machine.described(command_of(words))} Seed {chosen.seed}; " + (
        "quick mode: too short for the times to mean anything." if chosen.quick else "full run."))
    report.write_files(made, folder)
    return made


def shown(made):
    lines = [f"{made.name}: {made.title}", *made.result.paragraphs]
    lines += [f"  {'holds:' if c.held else 'DOES NOT HOLD:'} {c.statement} ({c.measured})" for c in made.claims]
    return "\n".join(lines) + "\n"


def as_json(reports):
    return json.dumps([{"experiment": r.name, "paragraph": " ".join(r.result.paragraphs), "claims": [
        {"statement": c.statement, "holds": bool(c.held), "measured": c.measured} for c in r.claims],
        "circumstances": r.circumstances} for r in reports], indent=2)


def evaluate(chosen, words):
    from palpate.evaluate import compiled, report
    names = EXPERIMENTS if chosen.name == "all" else (chosen.name,)
    options_of(chosen, chosen.name)  # refuses volumes before any work
    folder, reports = Folder(chosen.output), []
    try:
        for name in names:
            try:
                reports.append(run(name, chosen, folder.part, words))
            except (ValueError, compiled.Failed) as error:
                if len(names) == 1 or getattr(error, "status", WRONG_USE) != WRONG_USE:
                    raise
                print(f"palpate: note: {name} is left out: {error}", file=sys.stderr)
                continue
            folder.complete()
            if not (chosen.quiet or chosen.json):
                print(shown(reports[-1]))
        if chosen.name == "all":
            report.write_html(reports, folder.path, folder.part / "report.html")
            folder.complete()
    finally:
        folder.close()
    if chosen.json:
        print(as_json(reports))
    elif not chosen.quiet:
        print(f"Results: {chosen.output}{' (open report.html)' if chosen.name == 'all' else ''}")
    broken = sum(not claim.held for made in reports for claim in made.claims)
    if broken:
        raise Stop(CLAIMS_BROKEN, f"{broken} of the claims do not hold (see above)")


def interrupt(number, frame):
    raise Stop(128 + number, "interrupted")


def main(words):
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, interrupt)
    if "--help" in words or "-h" in words:
        print(HELP)
        return 0
    try:
        if "--version" in words:
            import palpate
            print(f"palpate {palpate.__version__}")
            return 0
        chosen = arguments(words)
        import palpate
        try:
            evaluate(chosen, words)
        except palpate.InputError as error:
            raise Stop(BAD_INPUT, str(error)) from error
        except (ValueError, OSError) as error:
            raise Stop(BAD_OUTPUT if isinstance(error, OSError) else WRONG_USE, str(error)) from error
    except Exception as error:
        if not hasattr(error, "status"):
            raise
        print(f"palpate: {error}", file=sys.stderr)
        return error.status
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
