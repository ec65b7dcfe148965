"""Attack on everything that changes during a session: levels, layers, tools, edits and bricks that come and go,
at random moments. Each tick of the recording is judged with the field evaluated from its definition. No surface
that holds is ever passed, forces stay within the limit, and a replay has the same bits."""

import json
import math

from fields import Grid, samples_of
from program import Finding, judge
from proxies import G, hand_of, level_of
from smooth_fields import SmoothGrid
from volume_files import nrrd

MOST_FORCE = 3.3
TICK = 0.001
STATUSES = ("done", "out of budget", "recovering", "refused", "not finite", "waiting")


def grid_of(random):
    size = tuple(random.randint(4, 9) for _ in range(3))
    make = random.choice((Grid, SmoothGrid))
    samples = samples_of(random.choice(("bytes", "box", "ball")), size, random)
    return make(size, [min(255, int(20 * s) if s < 13 else int(s)) for s in samples])


def layers_of(grid, random):
    """Levels in rising order, of which some give way."""
    levels = sorted({level_of(grid, random) for _ in range(random.randint(1, 4))})
    holds = random.random() < 0.6
    layers = [{"name": f"layer {i}", "level": level, "stiffness": random.uniform(0, 1),
               "puncture_force": "inf" if holds else random.choice(("inf", 0.2, 1))}
              for i, level in enumerate(levels)]
    return {"palpate_layers": 1, "name": "random", "about": "lives.py", "layers": layers}


def events_of(grid, random, ticks, has_tool, folder):
    """Lines of a command file, in the order of their times."""
    lines = []
    times = sorted(random.sample(range(20, ticks - 20), 8))
    for n, tick in enumerate(times):
        kind = random.choice(("isovalue", "fill", "undo", "friction") if has_tool else
                             ("isovalue", "fill", "undo", "friction", "layers", "layers", "off"))
        if kind == "isovalue":
            what = f"isovalue {level_of(grid, random)!r}"
        elif kind == "fill":
            low = [random.randrange(n) for n in grid.size]
            high = [random.randrange(a, n) for a, n in zip(low, grid.size)]
            box = ":".join(",".join(map(str, corner)) for corner in (low, high))
            what = f"fill {box} {random.randrange(256)}"
        elif kind == "layers":
            (folder / f"l{n}.json").write_text(json.dumps(layers_of(grid, random)))
            what = f"layers l{n}.json"
        else:
            what = {"undo": "undo", "friction": "friction 0.5,0.3", "off": "layers off"}[kind]
        lines.append(f"{tick * TICK} {what}\n")
    return lines


def one(program, random, folder, counts):
    grid = grid_of(random)
    if grid.range == 0:
        counts["constant"] += 1
        return
    (folder / "v.nrrd").write_bytes(nrrd(grid, "uint8"))
    ticks = 600
    with open(folder / "t.csv", "w") as file:
        file.write("t,x,y,z\n")
        for i, at in enumerate(hand_of(grid, random, ticks)):
            at = [min(max(x, -40), 60) for x in at]
            file.write(f"{i * TICK!r},{','.join(repr(x) for x in grid.physical(at))}\n")
    smooth = isinstance(grid, SmoothGrid)
    has_tool = smooth and random.random() < 0.3
    (folder / "c.txt").write_text("".join(events_of(grid, random, ticks, has_tool, folder)))
    words = ["touch", "v.nrrd", "--device", "recorded:t.csv", "--unpaced", "--headless", "--quiet", "--commands",
             "c.txt", "--record", "s.csv", f"--isovalue={level_of(grid, random)!r}", "--force-limit",
             str(MOST_FORCE), "--ramp", "0", "--field", "cubic" if smooth else "linear", "--rate", "1000",
             "--scale", "1", "--background", repr(grid.background)]
    if has_tool:
        words += ["--tool", random.choice(("rod:2", "rod:5"))]  # its reference point is its tip
    if random.random() < 0.3:
        words += ["--level", "0"]  # in bricks, which come and go
        counts["in bricks"] += 1
    ended = judge(program.run(words, folder), {0, 2})
    if ended.status == 2:
        if "solid" not in ended.err:
            raise Finding(f"refused without a reason: {ended}")
        counts["refused"] += 1
        return
    check(grid, folder, " ".join(words), counts)
    judge(program.run(["replay", "s.csv", "--validate", "--quiet"], folder), {0})


class Felt:
    """What is felt at a tick, from the commands so far."""

    def __init__(self, grid, isovalue):
        self.grid, self.isovalue, self.layers = grid, isovalue, None
        self.versions = {0: list(grid.samples)}

    def obey(self, command):
        (kind, what), = command.items()
        if kind == "isovalue":
            self.isovalue = what["value"]
        elif kind == "layers":
            self.layers = what["layers"]["layers"] if "layers" in what else None
        elif kind == "samples":
            version, before = what["version"], self.versions.get(what.get("of"), self.grid.samples)
            if "edit" in what:
                before = self.filled(before, **what["edit"]["fill"])
            self.use(self.versions.setdefault(version, before))  # bricks change no sample

    def filled(self, before, low, high, value):
        samples = list(before)
        nx, ny, _ = self.grid.size
        for k in range(low[2], high[2] + 1):
            for j in range(low[1], high[1] + 1):
                for i in range(low[0], high[0] + 1):
                    samples[i + nx * (j + ny * k)] = value
        return samples

    def use(self, samples):
        self.grid.samples = samples
        if isinstance(self.grid, SmoothGrid):
            self.grid.known.clear()

    def bounds(self, inside):
        """The levels between which a proxy is held inside so many layers; any where one gives way."""
        if self.layers is None:
            return -math.inf, self.isovalue
        if any(layer["puncture_force"] != "inf" for layer in self.layers):
            return -math.inf, math.inf
        levels = [-math.inf, *(layer["level"] for layer in self.layers), math.inf]
        return levels[inside], levels[inside + 1]


def check(grid, folder, what, counts):
    felt, bounds, names = None, None, None
    head = []
    with open(folder / "s.csv") as file:
        for line in file:
            if line.startswith("# command "):
                felt.obey(json.JSONDecoder().raw_decode(line[len("# command "):])[0])
                bounds = None
                counts["commands"] += 1
            elif line.startswith("#"):
                head.append(line[1:])
            elif names is None:
                names = line.strip().split(",")
                text = "".join(head)
                felt = Felt(grid, json.JSONDecoder().raw_decode(text[text.index("{"):])[0]["isovalue"])
            else:
                bounds = judged(felt, dict(zip(names, line.strip().split(","))), bounds, what, counts)
    if felt is None or counts["ticks"] == 0:
        raise Finding(f"nothing was recorded: {what}")


def judged(felt, row, bounds, what, counts):
    """The bounds for the next tick."""
    number = {name: float(row[name]) for name in ("scp_x", "scp_y", "scp_z", "force_x", "force_y", "force_z")}
    if not all(math.isfinite(v) for v in number.values()):
        raise Finding(f"t {row['t']} has a number that is none: {row}; {what}")
    force = math.hypot(*(number[f"force_{c}"] for c in "xyz"))
    if force > MOST_FORCE * (1 + 1e-12):
        raise Finding(f"t {row['t']}: a force of {force} N; {what}")
    counts["ticks"] += 1
    status = STATUSES[int(row["status"])]
    if status != "done":
        counts[status] += 1
        return bounds if status in ("waiting", "refused", "out of budget") else None
    grid, scale = felt.grid, max(felt.grid.range, 1.0)
    density = grid.value(grid.index([number[f"scp_{c}"] for c in "xyz"]))
    bounds = bounds or felt.bounds(int(row["layers_inside"]))
    counts["judged"] += 1
    counts["constrained"] += row["mode"] == "constrained"
    low, high = bounds
    if max(density - high, low - density) > G * scale:
        raise Finding(f"t {row['t']}: a density of {density!r} beyond {bounds}; {what}")
    return bounds


