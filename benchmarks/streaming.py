#!/usr/bin/env python3
"""Feels a virtual volume of 1.9 TB over a slow and unreliable network and judges every tick.

    benchmarks/streaming.py PALPATE [--delay MS] [--failures PART] [--rate HZ] [--seconds S] [--memory MB]

Starts tests/stream/volume_server.py, records a live session for each speed of the hand, compares
each SCP, and the way between two, with the formula of the volume, and prints a row for each speed:
ticks, how many touched, how many waited for data, the deepest SCP in the solid, memory, time from
starting the program to the first contact in the recording, bytes and requests (the server needs Debian's python3-numpy). With --validate each recording is rendered
again bit for bit.
"""

import argparse
import csv
import math
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SERVER = Path(__file__).resolve().parent.parent / "tests/stream/volume_server.py"
VOXEL, PERIOD, RADIUS = 0.001, 768, 256  # of the virtual volume: mm, voxels, voxels
LEVEL = 128                              # at the balls' radius, which rounding moves by a voxel
MARGIN = 4                               # voxels that rounding and interpolation may take
LONGEST_LINE = 32                        # voxels: cuts 0.5 voxels off a ball
COARSE_MARGIN = 24                       # the same at levels of up to 128 voxels, which cut balls off


def depth(point):
    """How deep a point [voxel] lies in the nearest ball [voxel]."""
    square = sum(((p - PERIOD / 2 + PERIOD / 2) % PERIOD - PERIOD / 2) ** 2 for p in point)
    return RADIUS - math.sqrt(square)


def write_hand(path, speed, seconds):
    """A straight way through a row of balls, there and back, at `speed` [mm/s]."""
    begin, end = (1.54, 5.0, 5.1), (9.98, 5.1, 4.9)
    length = math.dist(begin, end)
    with open(path, "w", encoding="ascii") as out:
        out.write("t,x,y,z\n")
        for tick in range(int(seconds * 200)):
            t = tick / 200
            part = speed * t / length % 2
            part = min(part, 2 - part)
            x, y, z = (b + part * (e - b) for b, e in zip(begin, end))
            out.write(f"{t},{x},{y},{z}\n")


def judge(recording):
    ticks = touching = waiting = 0
    deepest, before, first, outside = -math.inf, None, None, False
    with open(recording, encoding="utf-8") as lines:
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        for row in rows:
            ticks += 1
            status = int(row["status"])
            waiting += status == 5
            at = tuple(float(row["scp_" + a]) / VOXEL for a in "xyz")
            hip = tuple(float(row["hip_" + a]) / VOXEL for a in "xyz")
            if status == 2 or (status == 5 and at == hip):  # recovery, or not placed yet
                before, outside = None, False
                continue
            touches = row["mode"] == "constrained" and status in (0, 1)
            touching += touches
            if touches and first is None:
                first = float(row["t"])
            places = [at]
            # A proxy that catches up slides round a ball in one tick: the line would cut it off.
            if before and math.dist(before, at) <= LONGEST_LINE:
                steps = int(math.dist(before, at)) + 1
                places = [tuple(b + (a - b) * n / steps for a, b in zip(at, before))
                          for n in range(1, steps + 1)]
            # A hand may begin in a ball, and come out of it when the bricks are there.
            outside = outside or depth(at) <= MARGIN
            if outside:
                deepest = max(deepest, *map(depth, places), -RADIUS)
            before = at
    return ticks, touching, waiting, deepest, first


def feel(options, port, speed, folder):
    hand, recording = folder / "hand.csv", folder / "recording.csv"
    recording.unlink(missing_ok=True)
    write_hand(hand, speed, options.seconds + 5)
    words = [options.palpate, "record", f"http://127.0.0.1:{port}/virtual.zarr", "--isovalue", str(LEVEL),
             "--device", f"simulated:file={hand}", "--rate", str(options.rate), "--seconds",
             str(options.seconds), "--memory", f"{options.memory}MB", "--output", str(recording)]
    if options.coarse_first:
        words.append("--coarse-first")
    begin = time.monotonic()
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    most, contact = 0, None
    while process.poll() is None:
        try:
            status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
            found = re.search(r"VmRSS:\s+(\d+)", status)
            most = max(most, int(found.group(1)) / 1024) if found else most
        except OSError:
            pass
        if contact is None and recording.exists() and ",constrained," in recording.read_text():
            contact = time.monotonic() - begin
        time.sleep(0.1)
    out, err = process.communicate()
    if process.returncode != 0:
        sys.exit(f"{' '.join(words)}: status {process.returncode}\n{out}{err}")
    ticks, touching, waiting, deepest, _ = judge(recording)
    network = re.search(r"(\d+) requests, ([\d.]+) MB", out)
    requests, megabytes = network.groups() if network else ("?", "?")
    print(f"| {speed:g} | {ticks} | {100 * touching / ticks:.1f} | {100 * waiting / ticks:.1f} | {deepest:.2f} "
          f"| {most:.0f} | {contact if contact is None else round(contact, 1)} | {requests} | {megabytes} |",
          flush=True)
    if options.validate:
        subprocess.run([options.palpate, "replay", "--validate", str(recording)], check=True)
    if most > 1.05 * options.memory:
        sys.exit(f"{most:.0f} MB are more than --memory and 5 %")
    return deepest <= (COARSE_MARGIN if options.coarse_first else MARGIN)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("palpate")
    parser.add_argument("--delay", type=float, default=200, help="of each request [ms]")
    parser.add_argument("--failures", type=float, default=0.05, help="part of the requests")
    parser.add_argument("--rate", type=int, default=1000, help="[Hz]")
    parser.add_argument("--seconds", type=float, default=20, help="a speed")
    parser.add_argument("--memory", type=int, default=256, help="[MB]")
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.1, 0.5, 2, 10],
                        help="of the hand [mm/s]; 1 mm/s is a voxel a tick at 1 kHz")
    parser.add_argument("--coarse-first", action="store_true")
    parser.add_argument("--validate", action="store_true")
    options = parser.parse_args()
    server = subprocess.Popen(["/usr/bin/python3", str(SERVER), "--delay", str(options.delay), "--failures",
                               str(options.failures)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    port = server.stdout.readline().strip()
    print("| mm/s | ticks | touching % | waiting % | deepest [voxel] | MB | contact after [s] | requests | MB read |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        good = [feel(options, port, speed, Path(folder)) for speed in options.speeds]
    server.stdin.close()
    server.wait()
    if not all(good):
        sys.exit("an SCP was in the solid")


if __name__ == "__main__":
    main()
