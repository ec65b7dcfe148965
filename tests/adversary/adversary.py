#!/usr/bin/env python3
"""Attacks the program from outside, as an adversary would: with difficult data, hands, files, services,
signals and disks. It shares no code with the program. Every round has a seed of its own. A finding is printed
with the command that repeats it, and its files are kept.

    adversary.py --program build/dev/apps/palpate/palpate --seeds 12,readers=48     the same rounds everywhere
    adversary.py --program ... --minutes 60                               as many as the machine has time for
    adversary.py --program ... --only readers --seed 4711 --seeds 1       one round again
"""

import argparse
import collections
import importlib
import math
import random
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import Finding, Program  # noqa: E402

ATTACKS = ("proxies", "lives", "readers", "texts", "recordings", "services", "signals", "outputs",
           "sessions", "kills")


def one_round(name, program, seed, keep):
    """A round of an attack. Returns its counts and what it found, if anything."""
    counts = collections.Counter(rounds=1)
    folder = Path(tempfile.mkdtemp(prefix=f"palpate-adversary-{name}-"))
    found = None
    try:
        importlib.import_module(name).one(program, random.Random(f"{name} {seed}"), folder, counts)
    except Finding as finding:
        found = f"{name} --seed {seed}: {finding}"
        if keep:
            kept = Path(keep) / f"{name}-{seed}"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(folder, kept, symlinks=True, ignore=only_files)
            found += f"\n  files: {kept}"
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return counts, found


def only_files(folder, names):
    """Pipes and sockets cannot be copied."""
    paths = [Path(folder) / name for name in names]
    return [p.name for p in paths if not (p.is_file() or p.is_dir())]


def attack(name, program, options, rounds, deadline):
    """Rounds of one attack, at most so many and none begun after the deadline, several at a time. Returns
    counts and findings."""
    total, found, seed = collections.Counter(), [], options.seed
    with ThreadPoolExecutor(options.jobs) as pool:
        running = set()
        more = lambda: (time.monotonic() < deadline and seed - options.seed < rounds
                        and len(found) < options.most_findings)
        while running or more():
            while len(running) < options.jobs and more():
                running.add(pool.submit(one_round, name, program, seed, options.keep))
                seed += 1
            for done in [r for r in running if r.done()]:
                running.discard(done)
                counts, what = done.result()
                total += counts
                if what:
                    found.append(what)
                    print(f"FOUND {what}", flush=True)
            time.sleep(0.005)
    return total, found


def seeds_from(text):
    """How many seeds each attack gets: {attack: count} from "12,readers=48", one number for the others."""
    counts = {}
    for part in text.split(","):
        name, _, count = part.rpartition("=")
        if name and name not in ATTACKS:
            raise argparse.ArgumentTypeError(f"no attack {name}")
        counts[name] = int(count)
    return {name: counts.get(name, counts.get("", 1)) for name in ATTACKS}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program", required=True, help="palpate, built")
    amount = parser.add_mutually_exclusive_group(required=True)
    amount.add_argument("--seeds", type=seeds_from, metavar="N[,ATTACK=N...]",
                        help="rounds of each attack, however long they take")
    amount.add_argument("--minutes", type=float, help="for all attacks together, however many rounds that is")
    parser.add_argument("--seed", type=int, default=1, help="of the first round")
    parser.add_argument("--only", default="", help=f"attacks, comma between: {', '.join(ATTACKS)}")
    parser.add_argument("--most-findings", type=int, default=20, help="of an attack; then it ends")
    parser.add_argument("--keep", help="folder for the files of what is found")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--load", type=int, default=0, help="processes that only compute, beside the attacks")
    parser.add_argument("--slower", type=float, default=1.0, help="factor on all time limits")
    parser.add_argument("--counts", help="CSV to write the counts to")
    options = parser.parse_args()
    sys.setswitchinterval(0.0005)  # stand-ins for services answer while others compute
    names = options.only.split(",") if options.only else ATTACKS
    unknown = set(names) - set(ATTACKS)
    if unknown:
        parser.error(f"no attack {', '.join(sorted(unknown))}")
    program = Program(options.program, options.slower)
    burners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(options.load)]
    try:
        return report(names, program, options)
    finally:
        for burner in burners:
            burner.kill()


def report(names, program, options):
    """Runs the attacks, prints what came of each, and says whether anything was found."""
    findings, rows = [], []
    for i, name in enumerate(names):
        begun = time.monotonic()
        if options.seeds:
            rounds, deadline = options.seeds[name], math.inf
        else:
            left = 60 * options.minutes * (i + 1) / len(names) - sum(row[2] for row in rows)
            rounds, deadline = math.inf, begun + left
        counts, found = attack(name, program, options, rounds, deadline)
        findings += found
        rows.append((name, counts, time.monotonic() - begun, len(found)))
        print(f"{name}: {dict(counts)}, {len(found)} found, {rows[-1][2]:.0f} s", flush=True)
    if options.counts:
        with open(options.counts, "w") as file:
            file.write("attack,what,count\n")
            for name, counts, seconds, found in rows:
                for what, count in [*sorted(counts.items()), ("seconds", round(seconds)), ("found", found)]:
                    file.write(f"{name},{what},{count}\n")
    print(f"{program.runs} runs of the program, {len(findings)} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
