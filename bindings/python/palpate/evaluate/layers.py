"""layers: what is felt of several surfaces in one stroke?

Straight insertions and a needle against closed forms, the energy of closed loops, and the cost of a tick.
"""

import numpy
import palpate

from . import figures, sampling
from .experiment import Claim, Figure, Result, Table, largest
from .heads import SETS, claims_of_heads, draw_heads, heads_of, press_into, sentences_of_heads
from .subjects import synthetic
from .tissues import (BALL_RADIUS, DEEPEST, DRAG, LEVEL, PUNCTURE, RATE, STIFFNESS, TISSUES, Way, balls, drag, flat, layers,
                      lengths, renderer, spring, times)

TITLE = "What is felt of several surfaces in one stroke?"
FIELDS = ("linear", "cubic")
SPEEDS = (5, 50, 250, 1000)  # [mm/s] of insertions
NEEDLE_SPEEDS = (10, 100)
PHASES = ("insertion", "rest", "withdrawal")
FEELS = ("one level, no layers", "one surface", "five surfaces")
HANDS = ("slides on the skin", "goes in and out")
MOST_ERROR = 0.01  # [N] RMS, claimed against closed forms
MOST_OFF = 2  # [%] of a puncture force, claimed
MOST_GAINED = 1e-6  # [J] claimed
RESOLUTION = 0.1  # [mm] of the curves that are written
PARTS, ROUNDS = 16, 5  # of a tick's way, to find where a surface gave way to a millionth of it


def thinned(depth, is_apart=lambda one, last: one >= last + RESOLUTION):
    """Rows at least RESOLUTION apart."""
    kept, last = [], -numpy.inf
    for row, one in enumerate(depth):
        if is_apart(one, last):
            kept.append(row)
            last = one
    return kept


# Straight insertions.

def gives_way_at(before, way, time, low, high):
    """Where between two depths a surface gives way, found with copies of the renderer as it was at the first."""
    for _ in range(ROUNDS):
        depth = low + (high - low) * numpy.arange(PARTS + 1) / PARTS
        gone = before.follow(numpy.full(PARTS - 1, time), way.at(depth[1:-1]), alternatives=True)["punctured"] > 0
        part = int(numpy.append(gone, True).argmax())
        low, high = depth[part], depth[part + 1]
    return high


def punctures_of(start, way, depth, trace, force):
    """(tissue, force extended along the spring to where it gave way, the last force that was sampled)."""
    done, time = 0, times(len(depth))
    for tick in numpy.flatnonzero(trace["punctured"] > 0):
        tissue = trace["layer"][tick - 1]
        start.follow(time[done:tick], way.at(depth[done:tick]))
        done = tick
        if tick < 2 or tissue < 0 or trace["layer"][tick - 2] != tissue:
            continue
        at = gives_way_at(start, way, time[tick], depth[tick - 1], depth[tick])
        slope = (force[tick - 1] - force[tick - 2]) / (depth[tick - 1] - depth[tick - 2])
        yield tissue, force[tick - 1] + slope * (at - depth[tick - 1]), force[tick - 1]


def insert(fresh, way, start, speed):
    """(depths, forces, errors [N], punctures) of a hand that goes straight in, by copies of a renderer."""
    step = speed / RATE
    depth = start + step * numpy.arange(int(numpy.ceil((DEEPEST - start) / step)))
    trace = fresh.copy().follow(times(len(depth)), way.at(depth))
    off = numpy.linalg.norm(trace["force"] + spring(depth)[:, None] * way.inward, axis=1)
    force = -trace["force"] @ way.inward
    return depth, force, off, list(punctures_of(fresh.copy(), way, depth, trace, force))


def lines_at(speed, quick):
    """More at a speed at which each has fewer ticks: one tick on the other side of a surface that gives way is off by
    the whole force."""
    return int((1 if quick else 50) * (speed / SPEEDS[0])**0.75)


def puncture_rows(where, found):
    for tissue, (name, wanted) in enumerate(zip(TISSUES, PUNCTURE)):
        if not numpy.isfinite(wanted):
            continue
        extended, sampled = numpy.array([p[1:] for p in found if p[0] == tissue]).reshape(-1, 2).T
        some = len(extended) > 0
        yield {"part": "puncture", **where, "layer": name, "punctures": len(extended), "puncture_force_n": wanted,
               "extrapolated_mean_n": extended.mean() if some else numpy.nan,
               "extrapolated_off_percent": 100 * abs(extended - wanted).max() / wanted if some else numpy.nan,
               "greatest_sampled_n": sampled.max() if some else numpy.nan,
               "greatest_sampled_mean_n": sampled.mean() if some else numpy.nan}


def insertions(body, interpolation, options):
    fresh = renderer(body.felt(interpolation), layers())
    for speed in SPEEDS:
        count = lines_at(speed, options.quick)
        randoms = [numpy.random.default_rng([options.seed, part]) for part in range(options.seeds)]
        where = {"body": body.name, "field": interpolation, "speed_mm_s": speed}
        squares, total, worst, ticks, found = [], 0, 0, 0, []
        for line in range(count):
            random = randoms[line % options.seeds]
            depth, force, off, punctures = insert(fresh, body.way(random), random.uniform(5, 6), speed)
            squares.append((off**2).mean())
            total, worst, ticks = total + (off**2).sum(), max(worst, off.max()), ticks + len(off)
            found += punctures
            if line == 0 and interpolation == "linear" and speed in (SPEEDS[0], SPEEDS[-1]):
                wanted = spring(depth)
                for row in thinned(depth):
                    yield {"part": "insertion curve", **where, "depth_mm": depth[row], "force_n": force[row],
                           "closed_form_n": wanted[row]}
        _, low, high = numpy.sqrt(sampling.bootstrap(squares, numpy.mean))
        yield {"part": "insertion", **where, "runs": count, "ticks": ticks, "rms_n": numpy.sqrt(total / ticks), "worst_n": worst,
               "rms_low_n": low, "rms_high_n": high}
        yield from puncture_rows(where, found)


def claims_of_insertions(table):
    runs, punctures = table.where(part="insertion"), table.where(part="puncture")
    rms, offs = largest(runs["rms_n"]), punctures["extrapolated_off_percent"]
    count, wanted = int(punctures["punctures"].sum()), 4 * int(runs["runs"].sum())
    return [Claim(f"straight in, the force is that of the closed form to {MOST_ERROR:g} N RMS, at every speed, on either body "
                  "and field", rms <= MOST_ERROR, f"largest {rms:.2g} N"),
            Claim(f"every surface gives way at its puncture force to {MOST_OFF:g} %: forces extended along the spring to where "
                  "it did", count == wanted and bool((offs <= MOST_OFF).all()),
                  f"{count} of {wanted} punctures, the worst {largest(offs):.2g} % off")]


def summary_of(table):
    for run in table.where(part="insertion"):
        where = {name: run[name] for name in ("body", "field", "speed_mm_s")}
        punctures = table.where(part="puncture", **where)
        share = 100 * punctures["greatest_sampled_mean_n"] / punctures["puncture_force_n"]
        yield {"body": run["body"], "field": run["field"], "speed [mm/s]": run["speed_mm_s"],
               "RMS error [N], 95 % interval over lines":
                   "{rms_n:.2g} [{rms_low_n:.2g}, {rms_high_n:.2g}]".format(**run),
               "puncture force, worst error [%]": largest(punctures["extrapolated_off_percent"]),
               "greatest force sampled, mean [% of the puncture force]": f"{share.min():.0f} to {share.max():.0f}"}


# A needle goes in, rests half a second and is withdrawn.

NEEDLE_START, NEEDLE_TURN, REST_TICKS = 5.3037, 61.0, RATE // 2  # [mm]: a millimetre into the bone's spring


def needle_form(depth, phase, sticking):
    """What resists the hand [N]. On the way out no surface is felt; the tissue sticks to the shaft, with the stiffness
    `sticking`, until it slips, then rubs the other way."""
    tip = numpy.maximum(0, STIFFNESS[-1] * (depth - LEVEL[-1]))
    held = drag(numpy.array([NEEDLE_TURN]))[0]
    moving = (lengths(depth) * DRAG).sum(axis=1)
    sticks = held - sticking * (NEEDLE_TURN - depth)
    out = phase == 2
    slips = numpy.logical_or.accumulate(out & (sticks < -palpate.Needle().static_ratio * moving))
    return numpy.where(phase == 0, drag(depth) + spring(depth),
                       tip + numpy.where(phase == 1, held, numpy.where(slips, -moving, sticks)))


def needles(body, interpolation, options):
    field = body.felt(interpolation)
    for speed in NEEDLE_SPEEDS:
        way, step = body.way(numpy.random.default_rng([options.seed, 0])), speed / RATE
        count = int((NEEDLE_TURN - NEEDLE_START) / step)
        depth = numpy.concatenate([NEEDLE_START + step * numpy.arange(count), numpy.full(REST_TICKS, NEEDLE_TURN),
                                   NEEDLE_TURN - step * numpy.arange(1, count + 1)])
        phase = numpy.repeat([0, 1, 2], [count, REST_TICKS, count])
        made = renderer(field, layers(needle=True))
        wanted = needle_form(depth, phase, made.force.stiffness)
        trace = made.follow(times(len(depth)), way.at(depth), pointing=numpy.tile(way.inward, (len(depth), 1)))
        off = numpy.linalg.norm(trace["force"] + wanted[:, None] * way.inward, axis=1)
        where = {"body": body.name, "field": interpolation, "speed_mm_s": speed}
        force, is_shown = -trace["force"] @ way.inward, body.name == "flat" and interpolation == "linear"
        for number, name in enumerate(PHASES if is_shown and speed == NEEDLE_SPEEDS[0] else ()):
            rows = numpy.flatnonzero(phase == number)
            for row in rows[thinned(depth[rows], lambda one, last: abs(one - last) >= RESOLUTION)]:
                yield {"part": "needle curve", **where, "phase": name, "depth_mm": depth[row], "force_n": force[row],
                       "closed_form_n": wanted[row]}
        for number, name in enumerate(PHASES):
            of = off[phase == number]
            yield {"part": "needle", **where, "phase": name, "ticks": len(of), "punctures": int(trace["punctured"].sum()),
                   "rms_n": numpy.sqrt((of**2).mean()), "worst_n": of.max()}


# Closed random loops without friction.

def loop_bodies():
    """(name, volume, level, spread of the layers' levels [data units], reach of the loops [mm])."""
    ripples = synthetic("marschner-lobb:40x40x40")
    between = palpate.SAMPLE_BONE - palpate.SAMPLE_SKIN
    yield "ripples", ripples.field.volume, ripples.isovalue, 0.3 * ripples.field.range, 3
    yield ("head", palpate.load(palpate.sample_volume()).volume, palpate.SAMPLE_SKIN + 0.5 * between, between, 12)


def loop_layers(isovalue, spread, gives_way):
    return palpate.Layers(layers=[
        palpate.Layer(name=f"layer {i + 1}", level=isovalue + spread * (i / 3 - 0.5),
                      properties={"stiffness": stiffness, "puncture_force": gives_way})
        for i, stiffness in enumerate((0.4, 1.5, 0.3, 0.8))])


def loops_of(field, reach, ticks, random, most):
    """Closed paths around random places, each a sum of four waves, (ticks + 1, 3)."""
    phase = 2 * numpy.pi * numpy.outer(numpy.arange(ticks + 1) / ticks, numpy.arange(1, 5))
    waves = numpy.concatenate([numpy.sin(phase), numpy.cos(phase) - 1], axis=1)
    for _ in range(most):
        drawn = random.uniform(-1, 1, (9, 3))
        size = reach / numpy.tile(numpy.arange(1, 5), 2)
        begin = field.geometry.physical(0.5 * (1 + drawn[0]) * field.geometry.size)
        yield begin, begin + waves @ (size[:, None] * drawn[1:])


def gained(made, path):
    """(energy [J] that the force gives the hand beyond what the spring held at its begin, punctures, contacts). What the
    spring holds at its end counts as lost."""
    trace = made.follow(numpy.arange(len(path)) / RATE, path)
    force = trace["force"]
    stored = 0.5 * force[0] @ (trace["scp"][0] - path[0])
    work = 0.5 * ((force[1:] + force[:-1]) * numpy.diff(path, axis=0)).sum()
    return (work - stored) / 1000, int(trace["punctured"][1:].sum()), int((trace["layer"][1:] >= 0).sum())


def energy_row(number, name, field, isovalue, spread, reach, gives_way, options):
    """Loops far from every surface say nothing and do not count. number: of the case, so that each draws other loops."""
    wanted, ticks = (3, 4000) if options.quick else (200, 16000)
    start, found = renderer(field, loop_layers(isovalue, spread, gives_way)), []
    for part in range(options.seeds):
        random, done = numpy.random.default_rng([options.seed, part, number]), len(found)
        for begin, path in loops_of(field, reach, ticks, random, 50 * wanted):
            if len(found) - done >= len(range(part, wanted, options.seeds)):
                break
            if abs(field.value(begin[None])[0] - isovalue) <= spread and (one := gained(start.copy(), path))[2]:
                found.append(one)
    energy, punctures, contacts = numpy.array(found).reshape(-1, 3).T
    return {"part": "energy", "body": name, "field": field.interpolation,
            "surfaces": "give way" if numpy.isfinite(gives_way) else "hold", "runs": len(energy), "ticks": len(energy) * ticks,
            "contacts": contacts.sum(), "punctures": punctures.sum(), "loops_with_punctures": numpy.count_nonzero(punctures),
            "most_gained_j": energy.max(initial=-numpy.inf), "lost_mean_j": -energy.mean() if len(energy) else numpy.nan,
            "least_lost_with_puncture_j": -energy[punctures > 0].max() if punctures.any() else numpy.nan}


def claims_of_energy(table):
    rows = table.where(part="energy")
    most, least = rows["most_gained_j"].max(), numpy.fmin.reduce(rows["least_lost_with_puncture_j"])
    loops, punctured = int(rows["runs"].sum()), int(rows["loops_with_punctures"].sum())
    kept, lost = bool(rows["runs"].all() and most <= MOST_GAINED), bool(least > 0)
    return [Claim(f"around a closed loop without friction no hand gains more than {MOST_GAINED:g} J", kept,
                  f"at most {most:.2g} J" + (f"; more in {sampling.none_of(loops, 'loops')}" if kept else f" in {loops:,} loops")),
            Claim("every loop on which a surface gives way loses energy", lost,
                  f"at least {least:.2g} J" + (f"; less than nothing in {sampling.none_of(punctured, 'loops')}" if lost
                                               else f" in {punctured:,} loops"))]


# The cost of a tick.

def hand_of(name, ticks):
    """Around on the skin, pressing by a millimetre, which it stands; or from outside onto the bone and out again."""
    tick = numpy.arange(ticks)
    if name == HANDS[1]:
        way = numpy.fmod(0.1 * tick, 112)
        return Way(numpy.array([2.0, 3, BALL_RADIUS]), numpy.array([0, 0, -1.0])).at(5 + numpy.minimum(way, 112 - way))
    turn, radius = 2 * numpy.pi * tick / 1000, BALL_RADIUS - (LEVEL[0] + 1)
    flat_way = numpy.stack([4 * numpy.cos(turn), 4 * numpy.sin(turn), numpy.full(ticks, radius)], axis=1)
    return radius * flat_way / numpy.linalg.norm(flat_way, axis=1, keepdims=True)


def cost_rows(body, options):
    """The passes of all alternate, so that others' work on the machine meets all. Without layers nothing gives way, and
    a hand that went in would be another one."""
    ticks, passes = (1120, 9) if options.quick else (11200, 25)
    made = {FEELS[0]: None, FEELS[1]: layers(count=1), FEELS[2]: layers()}
    for interpolation in FIELDS:
        field = body.felt(interpolation)
        for name in HANDS:
            hand, feels = hand_of(name, ticks), FEELS[HANDS.index(name):]
            taken = {what: [] for what in feels}
            fresh_of = {what: renderer(field, made[what]) for what in feels}
            for _ in range(passes):
                for what in feels:
                    fresh = fresh_of[what].copy()
                    fresh.render(0, hand[0])
                    taken[what].append(fresh.batch_ns(times(ticks), hand, 40))
            one = numpy.mean(taken[FEELS[1]], axis=1)
            for what in feels:
                ratio = sampling.bootstrap(numpy.mean(taken[what], axis=1) / one)
                yield {"part": "cost", "body": body.name, "field": interpolation, "surfaces": what, "hand": name,
                       "ticks": ticks, "tick_ns": numpy.median(taken[what], axis=0).mean(),
                       "of_one_surface": ratio[0], "of_one_surface_low": ratio[1], "of_one_surface_high": ratio[2]}


def cost_sentence(table):
    said = []
    for row in table.where(part="cost", surfaces=FEELS[2]):
        said.append(f"{row['tick_ns']:.0f} ns, {row['of_one_surface']:.2f} [{row['of_one_surface_low']:.2f}, "
                    f"{row['of_one_surface_high']:.2f}] times that with one surface, where the hand {row['hand']} "
                    f"({row['field']} field)")
    return ("The cost of a tick with five surfaces, the same hand in alternating passes, with the median ratio of the passes and "
            f"its 95 % interval: {'; '.join(said)}.")


# Figures.

def draw_bands(axes, top):
    ends = numpy.append(LEVEL[1:], DEEPEST)
    for number, (name, begin, end) in enumerate(zip(TISSUES, LEVEL, ends)):
        if number % 2 == 0:
            axes.axvspan(begin, end, color="#efefef", lw=0)
        axes.text(0.5 * (begin + end), top, name, ha="center", va="top", fontsize=7, color=figures.GREY)
    axes.set(xlim=(5, DEEPEST), xlabel="depth of the hand [mm]", ylabel="force [N]")
    axes.grid(False)


def insertion_figure(table):
    drawn, panels = figures.panels(rows=2, height=4.4, width=5, sharex=True)
    for axes, body in zip(panels, ("flat", "balls")):
        slow, fast = (table.where(part="insertion curve", body=body, speed_mm_s=speed) for speed in (SPEEDS[0], SPEEDS[-1]))
        draw_bands(axes, 2.55)
        axes.plot(slow["depth_mm"], slow["closed_form_n"], color="#c0c0c0", lw=4)
        axes.plot(slow["depth_mm"], slow["force_n"], color=figures.BLUE, lw=1)
        axes.plot(fast["depth_mm"], fast["force_n"], "o", mfc="none", color=figures.VERMILION, ms=3)
        axes.set(ylim=(0, 2.6), title="flat layers" if body == "flat" else "concentric balls")
    panels[0].set_xlabel("")
    for text, colour, height in (("closed form", "#909090", 1.75), ("5 mm/s", figures.BLUE, 1.4),
                                 ("1 m/s, a circle per tick", figures.VERMILION, 1.05)):
        panels[0].text(40, height, text, color=colour, fontsize=7.5)
    drawn.suptitle("Each surface is a spring that gives way, at any speed", x=0.01, ha="left")
    return Figure("", "Force on a hand that goes straight in, on the linear field: the closed form (grey, wide) and the force that "
                  "is rendered, at 5 mm/s (line) and at 1 m/s, where a tick is a millimetre (one circle per tick). Bands are the "
                  "layers.", drawn)


def puncture_figure(table):
    drawn, axes = figures.panels(height=2.6)
    rows = table.where(part="puncture", field="linear", body="balls")
    for name, colour in zip(rows.distinct("layer"), (figures.BLUE, figures.GREEN, figures.VERMILION, figures.PURPLE)):
        of = rows.where(layer=name)
        axes.plot(of["speed_mm_s"], 100 * of["greatest_sampled_mean_n"] / of["puncture_force_n"], color=colour, marker="o",
                  label=name)
    axes.plot(of["speed_mm_s"], 100 * of["extrapolated_mean_n"] / of["puncture_force_n"], "k--", lw=1, label="extended")
    axes.set(title="a fast hand feels less than the peak", xscale="log", ylim=(70, 103),
             xlabel="speed of the hand [mm/s]", ylabel="part of the puncture force [%]")
    axes.set_xticks(SPEEDS, [f"{speed:g}" for speed in SPEEDS])
    axes.tick_params(axis="x", which="minor", bottom=False)
    figures.label_ends(axes)
    return Figure("puncture", "The last force rendered before a surface gave way (balls, linear field, mean of all insertions), as a "
                  "part of the surface's puncture force: the faster the hand, the farther apart its ticks. Dashed: the same forces "
                  "extended along the spring to where the surface gave way.", drawn)


def needle_figure(table):
    drawn, axes = figures.panels(height=2.8, width=5)
    rows = table.where(part="needle curve")
    draw_bands(axes, 3.35)
    axes.axhline(0, color=figures.GREY, lw=0.6)
    for phase, colour in zip(PHASES, (figures.BLUE, figures.BLACK, figures.VERMILION)):
        of = rows.where(phase=phase)
        axes.plot(of["depth_mm"], of["closed_form_n"], color="#c0c0c0", lw=4)
        axes.plot(of["depth_mm"], of["force_n"], "s" if phase == "rest" else "-", color=colour, lw=1, ms=3)
    for text, x, y, colour in (("going in", 22, 0.9, figures.BLUE), ("at rest", 51, 2.75, figures.BLACK),
                               ("coming out", 45, -1.55, figures.VERMILION), ("closed form", 8, -1.55, "#909090")):
        axes.text(x, y, text, color=colour, fontsize=7.5)
    axes.set(ylim=(-1.8, 3.4), title="a needle feels drag on its shaft and the surface at its tip")
    return Figure("needle", f"Force along a needle that goes in at {NEEDLE_SPEEDS[0]:g} mm/s, rests on the bone and is withdrawn; "
                  "positive resists going in. Peaks: the tip on a surface until it gives way. Slopes between them: drag of the "
                  "layers on the shaft. On the way out, friction pulls the other way. Grey, wide: the closed form.", drawn)


def paragraphs_of(table):
    needle = table.where(part="needle")
    errors = [f"{largest(needle.where(phase=phase)['rms_n']):.2g} N" for phase in PHASES]
    fast = table.where(part="puncture", speed_mm_s=SPEEDS[-1])
    share = 100 * fast["greatest_sampled_mean_n"] / fast["puncture_force_n"]
    return ["A hand goes straight through skin, fat, fascia and muscle onto bone, in bodies whose density is the depth: flat, and as "
            "concentric balls sampled every 0.125 mm. The closed form is a spring at each surface until its puncture force. The "
            f"greatest force that is sampled is less: at 1 m/s and {RATE} Hz the hand moves a millimetre per tick, and the last force "
            f"before a puncture is on average only {share.min():.0f} % of the puncture force for {fast[int(share.argmin())]['layer']}.",
            "A needle goes in at 10 and 100 mm/s, rests half a second on the bone and comes out again. It feels the drag of each "
            f"layer times the shaft's length in it, and at its tip the surface that holds it. It is off the closed form by at most "
            f"{errors[0]} RMS on the way in, {errors[1]} at rest and {errors[2]} on the way out, where friction first sticks, then "
            "rubs the other way.",
            "The closed loops go through ripples and a head, without friction.", sentences_of_heads(table), cost_sentence(table),
            "This shows that the model is rendered as it is written down, on straight ways in and with frictionless loops. The "
            "stiffnesses, drags and puncture forces are chosen, not measured on tissue, and a real surface does not hold like a "
            "spring until it breaks."]


def run(options):
    table, data = Table(), []
    heads, bodies = heads_of(options, data), (flat(), balls())
    for number, (body, field) in enumerate((body, field) for body in bodies for field in FIELDS):
        options.progress(0.3 * number / 4)
        table.extend(insertions(body, field, options))
        table.extend(needles(body, field, options))
    cases = [(name, palpate.Field(volume, interpolation=field), *rest, gives_way) for name, volume, *rest in loop_bodies()
             for field in FIELDS for gives_way in (numpy.inf, 0.6)]
    for number, case in enumerate(cases):
        options.progress(0.3 + 0.6 * number / len(cases))
        table.append(energy_row(number, *case, options))
    for head in heads:
        options.progress(0.9)
        for name in SETS:
            table.extend(press_into(head, name, 0.5 if options.quick else RESOLUTION))
    options.progress(0.95)
    table.extend(cost_rows(bodies[-1], options))
    needle = largest(table.where(part="needle", phase=PHASES[0])["rms_n"])
    claims = [*claims_of_insertions(table), Claim(
        f"a needle going in feels drag times length in each layer and the spring at its tip, to {MOST_ERROR:g} N RMS",
        needle <= MOST_ERROR, f"largest {needle:.2g} N"), *claims_of_energy(table), *claims_of_heads(table)]
    return Result(table, [insertion_figure(table), puncture_figure(table), needle_figure(table), draw_heads(table, heads)],
                  claims, paragraphs_of(table), Table(summary_of(table)), data)
