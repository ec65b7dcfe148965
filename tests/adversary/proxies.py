"""Attacks the proxy with difficult data and hands. Every path is checked with the field evaluated from its
definition: never inside the solid (G1), on the surface in contact (G2), and all numbers finite."""

import csv
import math

from fields import KINDS, Grid, rotation, samples_of
from program import Finding, judge
from smooth_fields import SmoothGrid
from volume_files import nrrd, packed

G = 1e-9  # of the range


def grid_of(random):
    size = tuple(random.randint(1, 9) for _ in range(3))
    kind = random.choice(KINDS)
    stored = random.choice(("uint8", "int16")) if kind in ("bytes", "two-levels", "box") else "float32"
    samples = samples_of(kind, size, random)
    if stored == "float32":  # as they are read again
        samples = list(memoryview(packed(samples, "float32")).cast("f"))
    spacing = tuple(random.choice((1, 0.5, 2, 0.01, 30)) for _ in range(3))
    origin = tuple(random.choice((0, -100, random.uniform(-1000, 1000))) for _ in range(3))
    axes = rotation(random) if random.random() < 0.5 else None
    make = random.choice((Grid, SmoothGrid))
    return make(size, samples, spacing, origin, axes), stored, kind


def level_of(grid, random):
    """A level within the range: anywhere, on a sample, or a hair from one."""
    if random.random() < 0.4:
        level = random.choice(grid.samples)
        return level if random.random() < 0.5 else math.nextafter(level, random.choice((-1e300, 1e300)))
    return grid.low + random.random() * (grid.high - grid.low)


def hand_of(grid, random, ticks):
    """Positions in index space: slow strokes, leaps, rests, samples, the far outside."""
    at = [random.uniform(-1, n) for n in grid.size]
    yield at
    style = random.choice(("slow", "leaps", "lattice", "far", "mixed"))
    for _ in range(ticks):
        how = style if style != "mixed" else random.choice(("slow", "leaps", "lattice", "rest"))
        if how == "slow":
            at = [x + random.gauss(0, 0.1) for x in at]
        elif how == "leaps":
            at = [random.uniform(-2, n + 1) for n in grid.size]
        elif how == "lattice":  # corners, middles of edges, faces and cells
            at = [random.randint(-2, 2 * n + 1) / 2 for n in grid.size]
        elif how == "far":
            far = 10 ** random.uniform(0, 4)
            at = [random.uniform(-far, far) for _ in grid.size]
        at = [min(max(x, -1e5), 1e5) for x in at]
        yield at


def one(program, random, folder, counts):
    grid, stored, kind = grid_of(random)
    above = random.random() < 0.7
    if not above:
        grid.background = grid.high
    level = level_of(grid, random)
    (folder / "v.nrrd").write_bytes(nrrd(grid, stored))
    ticks = random.choice((200, 1000))
    with open(folder / "t.csv", "w") as file:
        file.write("t,x,y,z\n")
        for i, at in enumerate(hand_of(grid, random, ticks)):
            file.write(f"{i / 1000!r},{','.join(repr(x) for x in grid.physical(at))}\n")
    words = ["replay", "v.nrrd", "--trajectory", "t.csv", f"--isovalue={level!r}", "--output", "o.csv",
             "--path", "p.csv", "--quiet", "--solid", "above" if above else "below"]
    if isinstance(grid, SmoothGrid):
        counts["smooth"] += 1  # the program's default
    else:
        words += ["--field", "linear"]
    if random.random() < 0.3:
        words += ["--friction", "0.6,0.3"]
    if random.random() < 0.2:
        words += ["--step-budget", str(random.randint(1, 200))]
    ended = judge(program.run(words, folder), {0, 2})
    if ended.status == 2:
        if "solid" not in ended.err:  # all of space is solid: nothing to move in
            raise Finding(f"refused without a reason: {ended}")
        counts["refused"] += 1
        return
    check(grid, level, 1 if above else -1, folder, f"{kind} {' '.join(words)}", counts)


def check(grid, level, sign, folder, what, counts):
    """Raises a Finding where a path or a contact breaks a guarantee."""
    with open(folder / "o.csv") as file:
        rows = list(csv.DictReader(file))
    path = {}
    with open(folder / "p.csv") as file:
        for row in csv.DictReader(file):
            path.setdefault(int(row["tick"]), []).append([float(row[c]) for c in "xyz"])
    if grid.range == 0:
        counts["constant"] += 1  # no range to measure by; that all numbers are finite is what is left
    scale = grid.range or max(abs(grid.low), 1e-300)
    inside = lambda point: sign * (grid.value(grid.index(point)) - level) / scale
    recovering = True  # a session may begin inside the solid and has to come out first
    before = None
    for tick, row in enumerate(rows):
        numbers = {k: float(v) for k, v in row.items() if k not in ("mode", "density")}
        if not all(math.isfinite(v) for v in numbers.values()):
            raise Finding(f"tick {tick} has a number that is none: {row}; {what}")
        scp = [numbers[f"scp_{c}"] for c in "xyz"]
        depth = inside(scp)
        counts["ticks"] += 1
        if recovering and depth > G:
            before = scp
            counts["recovering"] += 1
            continue
        recovering = False
        if depth > G:
            raise Finding(f"G1: tick {tick}: the SCP is {depth:.3g} of the range inside; {what}")
        if row["mode"] == "constrained" and abs(depth) > G:
            raise Finding(f"G2: tick {tick}: the SCP is {-depth:.3g} of the range off; {what}")
        counts["constrained"] += row["mode"] == "constrained"
        corners = [before, *path.get(tick, [])] if before and inside(before) <= G else []
        for a, b in zip(corners, corners[1:]):
            a, b = grid.index(a), grid.index(b)
            if grid.is_background(a, b) or max(abs(x - y) for x, y in zip(a, b)) > 300:
                continue
            worst = max(sign * (v - level) for v in grid.along(a, b, level, sign)) / scale
            if worst > G:
                raise Finding(f"G1: tick {tick}: the path is {worst:.3g} of the range inside; {what}")
            counts["stretches"] += 1
        before = scp
