#!/usr/bin/env python3
"""A million live ticks while everything changes: is anything lost, and is it the same bit for bit again?

    benchmarks/million_ticks.py PALPATE VOLUME [--seconds S]

Two sessions at once, on the smooth field, with a simulated hand that explores: `synthetic:beating`, playing at
speeds that change, and VOLUME with a brush that follows the hand, and undo. In both the isovalue sweeps, 20 commands a
second, and friction and penetrability are switched. Each is recorded, and the recording rendered again. Prints
a table. The status is 1 if ticks were lost or a recording does not give the same again.
"""

import argparse
import concurrent.futures
import csv
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

PARTS = ("p50", "p99", "p99.9", "max")


def common_commands(seconds, chance):
    """Of both sessions, as pairs of seconds and words."""
    for k in range(int(20 * seconds)):
        at = k / 20 + 0.013
        wave = math.sin(2 * math.pi * at / 7) + math.sin(2 * math.pi * at / 0.9)
        yield at, f"isovalue {35 + 12.5 * wave:.3f}%"
    for k in range(int(seconds / 3)):
        yield 3 * k + chance.random(), chance.choice(
            ("penetrability off", "penetrability threshold 0.5", "penetrability threshold 1 20%",
             "penetrability ranges 0.7 10%:30% 45%:90%"))
        yield 3 * k + 1 + chance.random(), chance.choice(("friction 0,0", "friction 0.4,0.3"))


def playing(seconds, chance):
    for k in range(int(seconds / 2)):
        at = 2 * k + chance.random()
        yield at, f"play {chance.uniform(-3, 3):.3f}"
        if k % 5 == 0:
            yield at + 1, chance.choice(("pause", "step 3", "step -1", "seek 0.31"))


def editing(seconds, chance):
    for k in range(int(seconds / 2)):
        at = 2 * k + chance.random()
        kind = chance.choice(("carve", "add", "smooth", "paint"))
        rate = chance.choice(("5", "20", "inf"))
        yield at, f"brush {kind} {chance.uniform(2, 6):.2f} {rate}"
        for _ in range(chance.randrange(4)):
            yield at + 1 + 0.5 * chance.random(), chance.choice(("undo", "undo", "redo"))


def ticks_of(recording):
    """Tetrahedra that the updates entered, sorted; those of the update that took longest; the share in contact."""
    with open(recording, encoding="ascii") as file:
        ticks = csv.DictReader(line for line in file if not line.startswith("#"))
        work = [(int(tick["update_ns"]), int(tick["tetrahedra"]), tick["mode"]) for tick in ticks]
    return {"tetrahedra": sorted(tetrahedra for _, tetrahedra, _ in work), "in_longest": max(work)[1],
            "contact": sum(mode == "constrained" for *_, mode in work) / len(work)}


def session(palpate, volume, own_commands, seconds, folder):
    """A row of the table: what the program said of the session, and whether its recording gives the same."""
    chance = random.Random(1)
    lines = sorted([*common_commands(seconds, chance), *own_commands(seconds, chance)])
    name = pathlib.Path(volume).stem.replace(":", "-")
    commands, recording = folder / f"{name}.txt", folder / f"{name}.csv"
    commands.write_text("".join(f"{at:.4f} {words}\n" for at, words in lines if at < seconds))
    ran = subprocess.run(
        [palpate, "touch", volume, "--isovalue", "35%", "--device", f"simulated:seconds={seconds:g}",
         "--commands", commands, "--record", recording, "--json", "--quiet"], capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"million_ticks.py: {volume}: {ran.stderr.strip()}")
    again = subprocess.run([palpate, "replay", recording, "--validate", "--quiet"],
                           capture_output=True, text=True)
    if again.returncode != 0:
        print(f"{volume}: {again.stderr.strip()}", file=sys.stderr)
    return {"volume": volume, "commands": len(lines), "same": again.returncode == 0, **ticks_of(recording),
            **json.loads(ran.stdout)}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("palpate")
    options.add_argument("volume")
    options.add_argument("--seconds", type=float, default=1002)
    chosen = options.parse_args()
    try:  # before the other session has run for a quarter of an hour
        subprocess.run([chosen.palpate, "info", chosen.volume, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    except OSError as e:
        sys.exit(f"million_ticks.py: {chosen.palpate}: {e.strerror}")
    except subprocess.CalledProcessError as e:
        sys.exit(e.returncode)
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor() as both:
        rows = list(both.map(
            lambda of: session(chosen.palpate, *of, chosen.seconds, pathlib.Path(scratch)),
            (("synthetic:beating", playing), (chosen.volume, editing))))

    def line(title, cell):
        print("| " + " | ".join([title, *(cell(row) for row in rows)]) + " |")

    line("", lambda row: pathlib.Path(row["volume"]).name)
    print("|---" * (len(rows) + 1) + "|")
    line("ticks, commands", lambda row: f"{row['ticks']:,}, {row['commands']:,}")
    line("in contact", lambda row: f"{row['contact']:.0%}")
    line("ticks that the recording lost", lambda row: f"{row['unrecorded']}")
    line("rendered again", lambda row: "the same bit for bit" if row["same"] else "DIFFERS")
    for kind in ("compute", "lateness"):
        line(f"{kind} {' / '.join(PARTS)} [us]",
             lambda row: " / ".join(f"{row[kind + '_ns'][part] / 1e3:,.1f}" for part in PARTS))
    line("tetrahedra per update, p50 / p99 / p99.9 / max, and of the longest update",
         lambda row: " / ".join(f"{row['tetrahedra'][int(part * (len(row['tetrahedra']) - 1))]:,}"
                                for part in (0.5, 0.99, 0.999, 1)) + f", {row['in_longest']:,}")
    line("forces cancelled (overruns)", lambda row: f"{row['overruns']}")
    line("missed deadlines", lambda row: f"{row['missed']:,}")
    return 0 if all(row["same"] and row["unrecorded"] == 0 for row in rows) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
