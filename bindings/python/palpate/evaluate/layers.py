"""layers: are several surfaces in one stroke rendered as they are defined?"""

import itertools

import numpy
import palpate

from . import figures, sampling
from .experiment import Page, Result, Table, largest
from .hands import Way
from .heads import SETS, claims_of_heads, figure_of_heads, heads_of, press_into, text_of_heads
from .subjects import synthetic
from .tissues import (BALL_RADIUS, DEEPEST, DRAG, LEVEL, PUNCTURE, RATE, STIFFNESS, TISSUES, balls, drag, flat, layered, layers, lengths,
                      pushed, renderer, spring, thinned, times)

PAGE = Page(__name__)
FIELDS = {"linear": "linear", "cubic": "smooth"}  # interpolation, and what the field is called
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


def curve_rows(cells, rows, depth, force, wanted):
    for row in rows:
        yield {**cells, "depth_mm": depth[row], "force_n": force[row], "closed_form_n": wanted[row]}


# Straight insertions.

def punctures_of(start, way, depth, trace, force):
    """(tissue, force extended along the spring to where it gave way, the last force that was sampled). Where it gave way is found with
    copies of the renderer as it was before."""
    done, time = 0, times(len(depth))
    for tick in numpy.flatnonzero(trace["punctured"] > 0):
        tissue = trace["layer"][tick - 1]
        start.follow(time[done:tick], way.at(depth[done:tick]))
        done = tick
        if tick < 2 or tissue < 0 or trace["layer"][tick - 2] != tissue:
            continue
        low, high = depth[tick - 1], depth[tick]
        for _ in range(ROUNDS):
            places = low + (high - low) * numpy.arange(PARTS + 1) / PARTS
            gone = start.follow(numpy.full(PARTS - 1, time[tick]), way.at(places[1:-1]), alternatives=True)["punctured"] > 0
            part = int(numpy.append(gone, True).argmax())
            low, high = places[part], places[part + 1]
        slope = (force[tick - 1] - force[tick - 2]) / (depth[tick - 1] - depth[tick - 2])
        yield tissue, force[tick - 1] + slope * (high - depth[tick - 1]), force[tick - 1]




def insertions(body, interpolation, options):
    fresh = renderer(body.felt(interpolation), layers())
    for speed in SPEEDS:
        # More lines where each has fewer ticks: one tick on the other side of a surface that gives way is off by the whole force.
        count = int((1 if options.quick else 50) * (speed / SPEEDS[0])**0.75)
        where = {"body": body.name, "field": interpolation, "speed_mm_s": speed}
        randoms = [numpy.random.default_rng([options.seed, part]) for part in range(options.seeds)]
        step, offs, punctures = speed / RATE, [], []
        for random in itertools.islice(itertools.cycle(randoms), count):
            way, start = body.way(random), random.uniform(5, 6)
            depth = start + step * numpy.arange(int(numpy.ceil((DEEPEST - start) / step)))
            trace, force = pushed(fresh, way, depth)
            if interpolation == "linear" and speed in (SPEEDS[0], SPEEDS[-1]) and not offs:
                rows = thinned(depth, lambda one, last: one >= last + RESOLUTION)
                yield from curve_rows({"part": "insertion curve", **where}, rows, depth, force, spring(depth))
            offs.append(numpy.linalg.norm(trace["force"] + spring(depth)[:, None] * way.inward, axis=1))
            punctures += punctures_of(fresh.copy(), way, depth, trace, force)
        ticks = sum(map(len, offs))
        _, low, high = numpy.sqrt(sampling.bootstrap([(off**2).mean() for off in offs], numpy.mean))
        yield {"part": "insertion", **where, "runs": count, "ticks": ticks,
               "rms_n": numpy.sqrt(sum((off**2).sum() for off in offs) / ticks), "worst_n": max(off.max() for off in offs),
               "rms_low_n": low, "rms_high_n": high}
        for tissue, (name, wanted) in enumerate(zip(TISSUES, PUNCTURE[numpy.isfinite(PUNCTURE)])):
            extended, sampled = numpy.array([both for number, *both in punctures if number == tissue]).reshape(-1, 2).T
            forces = {"extrapolated_mean_n": extended.mean(), "extrapolated_off_percent": 100 * abs(extended - wanted).max() / wanted,
                      "greatest_sampled_n": sampled.max(), "greatest_sampled_mean_n": sampled.mean()} if len(extended) else {}
            yield {"part": "puncture", **where, "layer": name, "punctures": len(extended), "puncture_force_n": wanted, **forces}


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
    made = renderer(body.felt(interpolation), layers(needle=True))
    for speed in NEEDLE_SPEEDS:
        way, step = body.way(numpy.random.default_rng([options.seed, 0])), speed / RATE
        count = int((NEEDLE_TURN - NEEDLE_START) / step)
        depth = numpy.concatenate([NEEDLE_START + step * numpy.arange(count), numpy.full(REST_TICKS, NEEDLE_TURN),
                                   NEEDLE_TURN - step * numpy.arange(1, count + 1)])
        phase = numpy.repeat([0, 1, 2], [count, REST_TICKS, count])
        wanted = needle_form(depth, phase, made.force.stiffness)
        trace, force = pushed(made, way, depth, needle=True)
        off = numpy.linalg.norm(trace["force"] + wanted[:, None] * way.inward, axis=1)
        where = {"body": body.name, "field": interpolation, "speed_mm_s": speed}
        if (body.name, interpolation, speed) == ("flat", "linear", NEEDLE_SPEEDS[0]):
            for number, name in enumerate(PHASES):
                rows = numpy.flatnonzero(phase == number)
                rows = rows[thinned(depth[rows], lambda one, last: abs(one - last) >= RESOLUTION)]
                yield from curve_rows({"part": "needle curve", **where, "phase": name}, rows, depth, force, wanted)
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
    start, found = renderer(field, layered("", [(f"layer {i + 1}", isovalue + spread * (i / 3 - 0.5), stiffness, gives_way)
                                                for i, stiffness in enumerate((0.4, 1.5, 0.3, 0.8))])), []
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
    """The passes of all alternate, so that others' work on the machine meets all. Without layers nothing gives way, and a hand that went
    in would be another one."""
    ticks, passes = (1120, 9) if options.quick else (11200, 25)
    made = dict(zip(FEELS, (None, layers(count=1), layers())))
    for interpolation, name in itertools.product(FIELDS, HANDS):
        hand = hand_of(name, ticks)
        renderers = {what: renderer(body.felt(interpolation), made[what]) for what in FEELS[HANDS.index(name):]}
        taken = {what: [] for what in renderers}
        for _ in range(passes):
            for what in renderers:
                fresh = renderers[what].copy()
                fresh.render(0, hand[0])
                taken[what].append(fresh.batch_ns(times(ticks), hand, 40))
        for what, passed in taken.items():
            ratio, low, high = sampling.ratio_of_means(passed, taken[FEELS[1]])
            yield {"part": "cost", "body": body.name, "field": interpolation, "surfaces": what, "hand": name, "ticks": ticks,
                   "tick_ns": numpy.median(passed, axis=0).mean(), "of_one_surface": ratio, "of_one_surface_low": low,
                   "of_one_surface_high": high}


def rows_of(options, heads):
    bodies = (flat(), balls())
    for body, field in options.each(itertools.product(bodies, FIELDS), 0, 0.3):
        yield from insertions(body, field, options)
        yield from needles(body, field, options)
    loops = itertools.product(loop_bodies(), FIELDS, (numpy.inf, 0.6))
    for number, ((name, volume, *rest), field, gives_way) in enumerate(options.each(loops, 0.3, 0.9)):
        yield energy_row(number, name, palpate.Field(volume, interpolation=field), *rest, gives_way, options)
    for head, name in options.each(itertools.product(heads, SETS), 0.9, 0.95):
        yield from press_into(head, name, 0.5 if options.quick else RESOLUTION)
    yield from cost_rows(bodies[-1], options)


def summary_of(table):
    for run in table.where(part="insertion"):
        punctures = table.where(part="puncture", **{name: run[name] for name in ("body", "field", "speed_mm_s")})
        share = 100 * punctures["greatest_sampled_mean_n"] / punctures["puncture_force_n"]
        yield {"body": run["body"], "field": FIELDS[run["field"]], "speed [mm/s]": run["speed_mm_s"],
               "RMS error [N], 95 % interval over lines": "{rms_n:.2g} [{rms_low_n:.2g}, {rms_high_n:.2g}]".format(**run),
               "puncture force, worst error [%]": largest(punctures["extrapolated_off_percent"]),
               "greatest force sampled, mean [% of the puncture force]": f"{share.min():.0f} to {share.max():.0f}"}


# Figures.

def draw_bands(axes, top):
    for number, (name, begin, end) in enumerate(zip(TISSUES, LEVEL, (*LEVEL[1:], DEEPEST))):
        if number % 2 == 0:
            axes.axvspan(begin, end, color="#efefef", lw=0)
        axes.text(0.5 * (begin + end), top, name, ha="center", va="top", fontsize=7, color=figures.GREY)
    axes.set(xlim=(5, DEEPEST), xlabel="depth of the hand [mm]", ylabel="force [N]")
    axes.grid(False)


def insertion_figure(table):
    drawn, panels = figures.panels(rows=2, height=4.4, width=5, sharex=True,
                                   title="Each surface is a spring that gives way, at any speed")
    for axes, body in zip(panels, ("flat", "balls")):
        slow, fast = (table.where(part="insertion curve", body=body, speed_mm_s=speed) for speed in (SPEEDS[0], SPEEDS[-1]))
        draw_bands(axes, 2.55)
        axes.plot(slow["depth_mm"], slow["closed_form_n"], color="#c0c0c0", lw=4)
        axes.plot(slow["depth_mm"], slow["force_n"], color=figures.BLUE, lw=1)
        axes.plot(fast["depth_mm"], fast["force_n"], "o", mfc="none", color=figures.VERMILION, ms=3)
        axes.set(ylim=(0, 2.6), title="flat layers" if body == "flat" else "concentric balls")
    panels[0].set_xlabel("")
    figures.names(panels[0], (("closed form", "#909090"), ("5 mm/s", figures.BLUE), ("1 m/s, a circle per tick", figures.VERMILION)),
                  0.593, 0.72, 0.135)
    return PAGE.figure(drawn)


def puncture_figure(table):
    drawn, axes = figures.panels(height=2.6)
    rows = table.where(part="puncture", field="linear", body="balls")
    for (name, of), colour in zip(rows.by("layer"), (figures.BLUE, figures.GREEN, figures.VERMILION, figures.PURPLE)):
        axes.plot(of["speed_mm_s"], 100 * of["greatest_sampled_mean_n"] / of["puncture_force_n"], "o-", color=colour, label=name)
    axes.plot(of["speed_mm_s"], 100 * of["extrapolated_mean_n"] / of["puncture_force_n"], "k--", lw=1, label="extended")
    axes.set(title="a fast hand feels less than the peak", xscale="log", ylim=(70, 103), xlabel="speed of the hand [mm/s]",
             ylabel="part of the puncture force [%]")
    figures.ticks(axes.xaxis, SPEEDS)
    figures.label_ends(axes)
    return PAGE.figure(drawn, "puncture")


def needle_figure(table):
    drawn, axes = figures.panels(height=2.8, width=5)
    draw_bands(axes, 3.35)
    axes.axhline(0, color=figures.GREY, lw=0.6)
    looks = {"insertion": ("-", figures.BLUE), "rest": ("s", figures.BLACK), "withdrawal": ("-", figures.VERMILION)}
    for phase, (style, colour) in looks.items():
        of = table.where(part="needle curve", phase=phase)
        axes.plot(of["depth_mm"], of["closed_form_n"], color="#c0c0c0", lw=4)
        axes.plot(of["depth_mm"], of["force_n"], style, color=colour, lw=1, ms=3)
    for text, x, y, colour in (("going in", 22, 0.9, figures.BLUE), ("at rest", 51, 2.75, figures.BLACK),
                               ("coming out", 45, -1.55, figures.VERMILION), ("closed form", 8, -1.55, "#909090")):
        axes.text(x, y, text, color=colour, fontsize=7.5)
    axes.set(ylim=(-1.8, 3.4), title="a needle feels drag on its shaft and the surface at its tip")
    return PAGE.figure(drawn, "needle")


def claims_of_energy(table):
    rows = table.where(part="energy")
    most, least = rows["most_gained_j"].max(), numpy.fmin.reduce(rows["least_lost_with_puncture_j"])
    loops, punctured = int(rows["runs"].sum()), int(rows["loops_with_punctures"].sum())
    kept, lost = rows["runs"].all() and most <= MOST_GAINED, least > 0
    yield PAGE.claim("gain", kept, most=most, loops=f". Exceeded in {sampling.none_of(loops, 'loops')}" if kept else f" in {loops:,} loops")
    yield PAGE.claim("loss", lost, least=least, loops=f". Nothing was lost in {sampling.none_of(punctured, 'loops')}" if lost
                     else f" in {punctured:,} loops")


def claims_of(table):
    runs, punctures = table.where(part="insertion"), table.where(part="puncture")
    offs, count, wanted = punctures["extrapolated_off_percent"], int(punctures["punctures"].sum()), 4 * int(runs["runs"].sum())
    yield PAGE.at_most(MOST_ERROR, runs["rms_n"], "straight")
    yield PAGE.claim("punctures", count == wanted and (offs <= MOST_OFF).all(), count=count, wanted=wanted, worst=largest(offs))
    yield PAGE.at_most(MOST_ERROR, table.where(part="needle", phase=PHASES[0])["rms_n"], "needle")
    yield from claims_of_energy(table)
    yield from claims_of_heads(table)


def text_of(table):
    fast = table.where(part="puncture", speed_mm_s=SPEEDS[-1])
    share = 100 * fast["greatest_sampled_mean_n"] / fast["puncture_force_n"]
    costs = " ".join("The hand {hand}, {smooth} field: {tick_ns:.0f} ns ({of_one_surface:.2f} [{of_one_surface_low:.2f}, "
                     "{of_one_surface_high:.2f}]).".format(**row, smooth=FIELDS[row["field"]])
                     for row in table.where(part="cost", surfaces=FEELS[2]))
    return PAGE.text(least=share.min(), least_of=fast[int(share.argmin())]["layer"], heads=" ".join(text_of_heads(table)), costs=costs,
                     off=[largest(table.where(part="needle", phase=phase)["rms_n"]) for phase in PHASES])


def run(options):
    heads = heads_of(options)
    table = Table(rows_of(options, heads))
    return Result(table, [insertion_figure(table), puncture_figure(table), needle_figure(table), figure_of_heads(table, heads)],
                  claims_of(table), text_of(table), summary_of(table))
