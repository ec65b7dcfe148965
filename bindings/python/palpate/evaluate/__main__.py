"""The command palpate evaluate."""

import contextlib
import importlib.util
import json
import os
import shlex
import sys
from pathlib import Path

from ..command_line import Kind, Parser, Stop, one_of, remark, say, tell, whole
from ..command_line import run as command

EXPERIMENTS = ("drift", "fall-through", "performance", "scaling", "fidelity", "stability", "walk-through",
               "penetration", "layers", "tools", "streaming", "notice", "recorded", "needle")  # in the order of docs/evaluation.md
MOST_SEEDS = 1000
PACKAGES = ("numpy", "scipy", "matplotlib")  # Debian: python3-NAME
USERS = {"range": ("penetration",), "seeds": ("fall-through", "layers", "tools", "recorded"), "method": ("walk-through",),
         "seed": ("fall-through", "performance", "scaling", "layers", "tools", "streaming", "recorded",
                  "needle"),
         "data": ("drift", "performance", "scaling", "penetration", "layers", "notice", "recorded")}  # of options that few use
CLAIMS_BROKEN, BAD_OUTPUT = 1, 5  # exit status, docs/command_line.md


def interval(text):
    """A function that gives the range in a volume, from 'LOW:HIGH'."""
    ends = text.split(":")
    try:
        low, high = (float(end.removesuffix("%")) for end in ends)
        if not low <= high or len({end.endswith("%") for end in ends}) == 2:
            raise ValueError
    except ValueError as error:
        raise ValueError(f"'{text}' is no range such as 12%:20% or 300:900") from error
    if not text.endswith("%"):
        return lambda volume: (low, high)
    return lambda volume: tuple(volume.minimum + part / 100 * (volume.maximum - volume.minimum) for part in (low, high))


PARSER = Parser("evaluate", "Run experiments, each with a table, figures and checked claims", (
    "drift --output results", "fall-through --volume head.nrrd@34.5 --volume synthetic:torus",
    "penetration --volume head.nrrd@12% --range 12%:20% --range 45%:100%", "all --quick"))
PARSER.add("experiment", kind=one_of((*EXPERIMENTS, "all")), help="Name of the experiment, or all to run every one and to write "
           "report.html and report.pdf, which need no other file. If a claim does not hold, the exit status is 1")
PARSER.add("-o", "--output", kind=Kind("FOLDER"), default="palpate-evaluation", help="Folder for the results")
PARSER.add("--volume", kind=Kind("VOLUME@ISOVALUE"), action="append", help="Volume to use instead of the experiment's own. May be given again")
PARSER.add("--data", kind=Kind("FOLDER"), help="Folder with the real volumes that some experiments use, such as lobster.nrrd, and with "
           "recordings, such as plane0/probe.traj (default: environment PALPATE_DATA)")
PARSER.add("--method", kind=one_of(("exact", "paper", "gradient", "gradient-improved")), default="exact", help="Proxy method, for walk-through")
PARSER.add("--seed", kind=whole(0, 2**64 - 1), default=1, help="Seed of everything random")
PARSER.add("--seeds", kind=whole(1, MOST_SEEDS), default=3, help="How many seeds draw their own lines, from the first one on, for "
           f"fall-through, layers, tools and recorded. At most {MOST_SEEDS}")
PARSER.add("--range", kind=Kind("LOW:HIGH", interval), action="append", help="Range of interest, in the data's units or in percent of its "
           "range, for penetration. May be given again")
PARSER.add_argument("--quick", action="store_true", help="Seconds instead of minutes, with every claim checked")
PARSER.add_argument("--json", action="store_true", help="Print paragraphs and claims as JSON")
PARSER.add_argument("-q", "--quiet", action="store_true", help="Print nothing")


def arguments(words):
    chosen = PARSER.arguments(words)
    if chosen.range:
        PARSER.given.add("range")
    if chosen.data is not None and not Path(chosen.data).is_dir():
        PARSER.error(f"--data {chosen.data}: there is no such folder")
    chosen.data = chosen.data or os.environ.get("PALPATE_DATA") or None
    missing = [f"python3-{package}" for package in PACKAGES if not importlib.util.find_spec(package)]
    if missing:
        raise Stop(BAD_OUTPUT, f"experiments need NumPy, SciPy and Matplotlib: apt install {' '.join(missing)}")
    return chosen


def names_of(chosen):
    return EXPERIMENTS if chosen.experiment == "all" else (chosen.experiment,)


def warn_of_no_effect(chosen, names):
    for option, users in USERS.items():
        if not set(users) & set(names):
            PARSER.warn_of_no_effect([option], f"it is for {', '.join(users)}")
    if chosen.quick and "recorded" not in names and set(USERS["data"]) & set(names):
        PARSER.warn_of_no_effect(["data"], "--quick uses no real volume")


def options_of(chosen, name):
    from palpate.evaluate.experiment import Options
    from palpate.evaluate.subjects import of_texts

    def progress(part):
        if sys.stderr.isatty() and not (chosen.quiet or chosen.json):
            remark(f"\r{name} {part:4.0%} ", end="\n" if part >= 1 else "")

    def note(text):
        if not chosen.quiet:
            tell(f"note: {name}: {text}")

    return Options(quick=chosen.quick, seed=chosen.seed, seeds=chosen.seeds, method=chosen.method,
                   ranges=tuple(chosen.range or ()), subjects=of_texts(chosen.volume or ()), progress=progress, note=note,
                   data=Path(chosen.data) if chosen.data else None)



def module_of(name):
    return importlib.import_module(f"palpate.evaluate.{name.replace('-', '_')}")


def run(name, chosen, folder, words):
    """The Report of an experiment whose files are written."""
    from palpate.evaluate import machine, report
    options, module = options_of(chosen, name), module_of(name)
    result = module.run(options)
    result.data = options.used
    options.progress(1)
    typed = shlex.join(["palpate", "evaluate", *(Path(word).name if word.startswith("/") else word for word in words)])
    made = report.Report(name, module.PAGE.title, result, f"{machine.described(typed)} Seed {chosen.seed}, " + (
        "quick mode (too short for the times to mean anything)." if chosen.quick else "full run."))
    report.write_files(made, folder)
    return made


def shown(made):
    lines = [f"{made.name}: {made.title}", *made.result.paragraphs]
    lines += [f"  {'holds:' if c.held else 'DOES NOT HOLD:'} {c.statement} ({c.measured})" for c in made.result.claims]
    return "\n".join(lines) + "\n"



def evaluate(chosen, words):
    from palpate import _palpate
    from palpate.evaluate import report
    from palpate.evaluate.experiment import DoesNotApply
    names = names_of(chosen)
    options_of(chosen, chosen.experiment)  # refuses volumes before any work
    warn_of_no_effect(chosen, names)
    path, reports = Path(chosen.output), []
    with contextlib.closing(_palpate._ResultFolder(path)) as results:
        for name in names:
            try:
                reports.append(run(name, chosen, results.part, words))
            except DoesNotApply as error:
                if len(names) == 1:
                    raise
                tell(f"note: {name} is left out: {error}")
                continue
            results.complete()
            if not (chosen.quiet or chosen.json):
                say(shown(reports[-1]), last=len(names) == 1)
        if chosen.experiment == "all":
            if not report.write_pages(reports, path, results.part):
                tell("note: without report.pdf: it needs WeasyPrint (apt install weasyprint)")
            results.complete()
    if chosen.json:
        say(json.dumps([{"experiment": r.name, "paragraph": " ".join(r.result.paragraphs), "claims": [
            {"statement": c.statement, "holds": c.held, "measured": c.measured} for c in r.result.claims],
            "circumstances": r.circumstances} for r in reports], indent=2), last=True)
    elif not chosen.quiet:
        say(f"Results: {chosen.output}{' (open report.html)' if chosen.experiment == 'all' else ''}", last=True)
    broken = sum(not claim.held for made in reports for claim in made.result.claims)
    if broken:
        raise Stop(CLAIMS_BROKEN, f"{broken} of the claims do not hold (see above)")


def main(words):
    def load():
        nonlocal chosen
        chosen = arguments(words)
        for name in ("report", "machine", "figures", *names_of(chosen)):
            module_of(name)  # with everything that it uses
    chosen = None
    return command(lambda: evaluate(chosen, words), load=load)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
