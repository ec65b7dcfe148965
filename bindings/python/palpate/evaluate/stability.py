"""stability: how stiff may a surface be before it buzzes? A loop that does not come to rest is in a limit cycle, felt as buzzing."""

import copy
import collections
import itertools
import tempfile

import numpy
import palpate
from scipy.spatial.transform import Rotation

from . import figures
from .experiment import Page, Result, Table, in_parallel, largest
from .human import RATE, Human, trembling
from .notice import FORCE, SLOW, above
from .subjects import synthetic

PAGE = Page(__name__)
SECONDS = 4  # held for; the last second counts
LARGEST = 3.0  # [N/mm] that is tried
LEAST_STEP, LEAST_ANGLE = 0.01, 0.02  # [mm], [degrees] the least that a step counts for
MAP_PROFILE = "touch"
FASTEST = 8000  # [Hz] for the comparison of Choi and Tan
PRESSED = 18  # [mm] from the surface to the target of a hand that trembles, some 2 N; with 10 mm it bounces on stiff surfaces
PROFILES = palpate.simulated_profiles()
TORQUE = [name for name, profile in PROFILES.items() if profile["maximum_torque"] > 0]
# Part of the table: title, whether the mechanics have friction, field.
PARTS = {"profiles": ("as they are", True, "linear"), "profiles, smooth field": ("as they are, smooth field", True, "cubic"),
         "profiles without friction": ("without friction", False, "linear"),
         "profiles without friction, smooth field": ("without friction, smooth field", False, "cubic")}
ROTATION = {"rotation, ideal": "no delay, friction, steps", "rotation, delayed": "delay alone", "rotation": "as they are"}


Plan = collections.namedtuple("Plan", "rates encoders stiffnesses bound_parts")  # [Hz], [mm], [N/mm], of the theory's bound of rotation
QUICK = Plan([250, 1000], [0, 0.1], [0.5, LARGEST], [0.5, 0.8, 0.9, 1.25, 2])
FULL = Plan([250, 500, 1000, 2000, 4000], [0, 0.01, 0.03, 0.1], [0.1 * i for i in range(1, 30)] + [LARGEST],
            [0.05 * i for i in range(2, 51)])


def yes(held):
    return "yes" if held else "no"


def moves_within(steps, position, encoder):
    """Whether a position that moves so much [mm] keeps to a number of encoder steps."""
    return position <= (steps + 0.01) * numpy.maximum(LEAST_STEP, encoder)


def loop_of(field, isovalue, device, rate, damping, straight=False, **force):
    """Arrays of a closed loop. damping: of the limits, large, as check() would refuse what is to be shown."""
    info = palpate.simulated_info(device, field, isovalue, rate)
    limits = copy.copy(info.limits)
    setattr(limits, "physical_rotational_damping" if straight else "physical_damping", damping)
    force = palpate.ForceSettings(**({} if straight else {"limit": limits.maximum_force}), **force)
    renderer = palpate.Renderer(field, isovalue, palpate.RenderSetup(rate=rate, force=force), limits,
                                palpate.fit_workspace(field.geometry, info))
    return palpate.closed_loop(renderer, device, SECONDS, rate, straight)


def pressed(subject, part, profile, friction, interpolation, encoder, rate, stiffness):
    """A row: a light hand presses and holds."""
    field = palpate.Field(subject.field.volume, subject.field.solid, subject.field.background, interpolation)
    device = (f"simulated:{profile},jitter=no,grip=light,friction={yes(friction)},encoder={encoder:g},hand=hold,depth=6,seconds={SECONDS}")
    loop = loop_of(field, subject.isovalue, device, rate, 1, stiffness=stiffness)
    last = slice(int((SECONDS - 1) * rate), None)
    position, force = loop["position"][last], loop["force"][last]
    push = numpy.linalg.norm(force[-1])
    moved = numpy.ptp(position, axis=0).max()
    return {"part": part, "profile": profile, "friction": yes(friction), "field": interpolation, "encoder_step_mm": encoder,
            "rate_hz": rate, "stiffness_N_mm": stiffness, "position_peak_to_peak_mm": moved,
            "along_force_peak_to_peak_mm": numpy.ptp(position @ (force[-1] / (push if push > 0 else 1))),
            "force_peak_to_peak_N": numpy.ptp(force, axis=0).max(), "push_N": push, "in_contact": yes(loop["constrained"][last].any()),
            "at_rest": yes(moves_within(2, moved, encoder))}


def place_to_press(subject):
    """(a place on the surface [mm], the direction out of it); NaN where the way to the middle meets none."""
    out, centre = numpy.array([0.36, 0.48, 0.8]), numpy.array(subject.field.geometry.centre)
    return palpate.cast_rays(subject.field, subject.isovalue, [centre + subject.diagonal * out], [centre])[0][0], out


def trembled(subject, part, profile, rate, stiffness):
    """A row: a modelled person presses and holds, and trembles (human.py). The force above 20 Hz, of which tremor has hardly any, is what
    the loop adds."""
    person, field, (surface, out) = Human(), subject.field, place_to_press(subject)
    own = palpate.simulated_info(f"simulated:{profile},jitter=no", field, subject.isovalue, rate)
    scale = palpate.fit_workspace(field.geometry, own).scale  # [mm of volume per mm of device]
    time = numpy.arange(SECONDS * RATE + 1) / RATE
    depth = numpy.clip(PRESSED * time, 0, PRESSED)  # in the first second; from the surface on, where the field is free
    shaking = trembling(person, numpy.random.default_rng([1, rate]), len(time))
    target = surface + scale * ((1 - depth)[:, None] * out + shaking)
    with tempfile.NamedTemporaryFile(suffix=".csv") as file:
        numpy.savetxt(file.name, numpy.column_stack([time, target]), delimiter=",", header="t,x,y,z", comments="")
        device = (f"simulated:{profile},jitter=no,file={file.name},hand_mass={person.mass},hand_damping={person.damping / 1000},"
                  f"hand_stiffness={person.stiffness / 1000}")
        loop = loop_of(field, subject.isovalue, device, rate, 1, stiffness=stiffness)
    force, held = loop["force"][rate:], loop["constrained"][rate:]
    push = numpy.linalg.norm(force, axis=1).mean()
    return {"part": part, "profile": profile, "friction": "yes", "field": field.interpolation, "rate_hz": rate, "stiffness_N_mm": stiffness,
            "push_N": push, "above_20_hz_percent": 100 * above(SLOW, force, rate) / push, "in_contact": yes(held.all())}


def turned(subject, part, profile, rate, share):
    """A row: a light hand turns the handle by 20 degrees against a spring that holds it straight. The theory: at rest while
    k (period / 2 + delay) < damping."""
    device = f"simulated:{profile},jitter=no,grip=light,hand=hold,depth=0,seconds={SECONDS},turn=20,turn_time=0.5"
    if part != "rotation":
        device += ",friction=no,angle_step=0,torque_step=0" + (",delay=0" if part == "rotation, ideal" else "")
    limits = palpate.simulated_info(device, subject.field, subject.isovalue, rate).limits
    damping = limits.physical_rotational_damping
    stiffness = share * (damping / (0.5 / rate + limits.delay))
    loop = loop_of(subject.field, subject.isovalue, device, rate, 1e6, True, rotational_stiffness=stiffness)
    turns = Rotation.from_quat(loop["orientation_xyzw"][int((SECONDS - 1) * rate):]).inv().as_rotvec(degrees=True)
    moved = numpy.ptp(turns, axis=0).max()
    step = numpy.degrees(PROFILES[profile]["angle_step"]) if part == "rotation" else 0
    return {"part": part, "profile": profile, "friction": yes(part == "rotation"), "rate_hz": rate,
            "at_rest": yes(moved <= 2.01 * max(LEAST_ANGLE, step)), "part_of_bound": share, "rotational_stiffness_N_mm_rad": stiffness,
            "checked_N_mm_rad": 2 * rate * damping, "turn_peak_to_peak_deg": moved, "torque_N_mm": numpy.linalg.norm(loop["torque"][-1])}


def cases_of(subject, plan):
    """(function, arguments) of each row."""
    steps = {name: profile["encoder_step"] for name, profile in PROFILES.items()}
    rated = {name: profile["stiffness"] for name, profile in PROFILES.items()}
    loops = [("map", MAP_PROFILE, False, "linear", encoder) for encoder in plan.encoders]
    loops += [(part, name, friction, field, steps[name]) for part, (_, friction, field) in PARTS.items() for name in PROFILES]
    cases = [(pressed, *loop) for loop in itertools.product(loops, plan.rates, plan.stiffnesses)]
    cases += [(pressed, ("fastest", MAP_PROFILE, False, "linear", plan.encoders[0]), FASTEST, stiffness) for stiffness in plan.stiffnesses]
    cases += [(pressed, ("rated", name, True, "linear", steps[name]), 1000, rated[name]) for name in PROFILES]
    if not numpy.isnan(place_to_press(subject)[0]).any():
        cases += [(trembled, ("trembling", name), rate, rated[name]) for name in PROFILES for rate in plan.rates]
    cases += [(turned, loop, *of) for loop, *of in itertools.product(itertools.product(ROTATION, TORQUE), plan.rates, plan.bound_parts)]
    return [(make, (subject, *loop, rate, strength)) for make, loop, rate, strength in cases]



def largest_stable(rows, rate, steps=2):
    """The largest stiffness up to which every one tried moves by so many encoder steps at most, which is at rest for two; 0 if none
    does."""
    stable = itertools.takewhile(lambda row: moves_within(steps, row["position_peak_to_peak_mm"], row["encoder_step_mm"]),
                                 rows.where(rate_hz=rate))
    return max((row["stiffness_N_mm"] for row in stable), default=0.0)


def compared(table, plan, on_linear, on_smooth, steps):
    """(profile, rate, largest stable stiffness on the linear field, and on the smooth one) of every case."""
    return [(profile, rate, *(largest_stable(table.where(part=part, profile=profile), rate, steps) for part in (on_linear, on_smooth)))
            for profile in PROFILES for rate in plan.rates]


def counted(found):
    """How often the smooth field is stiffer, as stiff, and less stiff."""
    linear, smooth = numpy.array([one[2:] for one in found]).T
    return int((smooth > linear).sum()), int((smooth == linear).sum()), int((smooth < linear).sum())


def summary_of(table, plan):
    """The largest stiffness at rest [N/mm] at each rate: of the map, and of the profiles."""
    def row(what, part, **cells):
        rows = table.where(part=part, **cells)
        return {"device": what, **{f"{rate:g} Hz": round(largest_stable(rows, rate), 1) for rate in plan.rates}}

    fastest = {f"{FASTEST} Hz": round(largest_stable(table.where(part="fastest"), FASTEST), 1)}
    for encoder in plan.encoders:
        yield {**row(f"{MAP_PROFILE}, no friction, encoder steps of {encoder:g} mm", "map", encoder_step_mm=encoder),
               **(fastest if encoder == plan.encoders[0] else {})}
    yield {"device": "clean texture on a real device (Choi and Tan 2004, published)", "250 Hz": 0.325, "40000 Hz": 0.904}
    for profile in PROFILES:
        yield {**row(profile, "profiles", profile=profile), "rated": PROFILES[profile]["stiffness"]}


def map_figure(table, plan):
    """Stiffness over rate, the colour the movement at rest; a line where it ends."""
    drawn, panels = figures.panels(columns=len(plan.encoders), height=2.7, sharey=True,
                                   title="Faster loops carry stiffer walls, and encoder steps hardly matter")
    norm = figures.matplotlib.colors.LogNorm(1e-3, 10)
    edges = [0, *(0.5 * numpy.add(plan.stiffnesses[1:], plan.stiffnesses[:-1])), LARGEST + 0.05]
    for axes, encoder in zip(panels, plan.encoders):
        rows = table.where(part="map", encoder_step_mm=encoder)
        moved = [numpy.maximum(1e-3, rows.where(rate_hz=rate)["position_peak_to_peak_mm"]) for rate in plan.rates]
        image = axes.pcolormesh(numpy.arange(len(plan.rates) + 1) - 0.5, edges, numpy.array(moved).T, cmap="Greys", norm=norm)
        for number, rate in enumerate(plan.rates):
            axes.plot([number - 0.5, number + 0.5], [largest_stable(rows, rate) + 0.05] * 2, color=figures.VERMILION, lw=2.5)
        axes.set(title=f"steps of {encoder:g} mm", xlabel="update rate [kHz]", ylim=(0, LARGEST + 0.05))
        figures.ticks(axes.xaxis, range(len(plan.rates)), [f"{rate / 1000:g}" for rate in plan.rates])
        axes.grid(False)
    panels[0].set_ylabel("stiffness [N/mm]")
    drawn.colorbar(image, ax=panels, label="movement, peak to peak [mm]")
    return PAGE.figure(drawn)


def profile_figure(table, plan):
    drawn, panels = figures.panels(columns=4, height=2.9, sharey=True, title="Friction of the mechanics stills nearly all that would buzz")
    for axes, (part, (title, *_)) in zip(panels, PARTS.items()):
        stable = [[largest_stable(table.where(part=part, profile=name), rate) for rate in plan.rates] for name in PROFILES]
        figures.number_map(axes, stable, PROFILES, [f"{rate / 1000:g}" for rate in plan.rates], 1.6 * LARGEST, "{:.1f}", 6)
        axes.set_title(title.replace(", ", ",\n"), fontsize=7.5)
        axes.set_xlabel("rate [kHz]")
    return PAGE.figure(drawn, "profiles")


def rotation_figure(table, plan):
    drawn, panels = figures.panels(columns=3, height=2.8, sharey=True, title="A delay lowers the rotational stiffness that is stable")
    for axes, (part, title) in zip(panels, ROTATION.items()):
        kilohertz = [rate / 1000 for rate in plan.rates]
        for profile, colour in zip(TORQUE, (figures.BLUE, figures.VERMILION, figures.GREEN, figures.PURPLE)):
            rests = [itertools.takewhile(lambda row: row["at_rest"] == "yes", table.where(part=part, profile=profile, rate_hz=rate))
                     for rate in plan.rates]
            limits = [max((row["rotational_stiffness_N_mm_rad"] for row in rows), default=numpy.nan) for rows in rests]
            axes.plot(kilohertz, limits, color=colour, marker="o", lw=1, ms=3, label=profile)
        checked = [table.where(part=part, rate_hz=rate)[0]["checked_N_mm_rad"] for rate in plan.rates]
        axes.plot(kilohertz, checked, color=figures.GREY, ls="--", label="check(), no delay")
        axes.set(title=title, xscale="log", yscale="log", ylim=(100, 1e5), xlabel="update rate [kHz]")
        figures.ticks(axes.xaxis, kilohertz)
    panels[0].set_ylabel("stiffness [N mm/rad]")
    figures.label_ends(panels[2])
    return PAGE.figure(drawn, "rotation")


def claims_of_rest(table, plan):
    rated = table.where(part="rated")
    yield PAGE.claim("rated", all(row["at_rest"] == row["in_contact"] == "yes" for row in rated),
                     most=largest(rated["position_peak_to_peak_mm"]), profiles=len(rated))
    yield from claims_of_trembling(table)
    found = compared(table, plan, *list(PARTS)[:2], 2)
    more, same, less = counted(found)
    losses = ", ".join(f"{name} at {rate:g} Hz ({smooth:.1f} against {linear:.1f} N/mm)" for name, rate, linear, smooth in found
                       if smooth < linear)
    limited = sum(linear == smooth == LARGEST for *_, linear, smooth in found)
    yield PAGE.claim("smooth", less == 0, same=same, limited=limited, more=more, less=f"{less}: {losses}" if less else "0")
    corner = table.where(part="map", rate_hz=250, stiffness_N_mm=LARGEST, encoder_step_mm=0)[0]  # the map can tell
    yield PAGE.claim("buzz", corner["at_rest"] == "no", moved=corner["position_peak_to_peak_mm"])


def claims_of_trembling(table):
    rows = table.where(part="trembling", rate_hz=1000)
    most = largest(rows["above_20_hz_percent"])
    if rows:
        yield PAGE.claim("trembling", most < FORCE and all(row["in_contact"] == "yes" for row in rows), most=most, profiles=len(rows))


def claims_of_rotation(table):
    """Whether all cases of a part so near the bound are, or are not, at rest."""
    for name, part, low, high in (
            ("ideal, rest", "rotation, ideal", 0, 0.9), ("ideal, shakes", "rotation, ideal", 1.25, numpy.inf),
            ("delayed, rest", "rotation, delayed", 0, 0.8), ("delayed, shakes", "rotation, delayed", 1.25, numpy.inf),
            ("friction, rest", "rotation", 0, 0.8)):
        rows = table.where(part=part).only(lambda row: low - 1e-9 <= row["part_of_bound"] <= high + 1e-9)
        moved, rests = rows["turn_peak_to_peak_deg"], name.endswith("rest")
        said = f"at most {moved.max():.3g}" if rests else f"at least {moved.min():.3g}"
        yield PAGE.claim(name, rows.distinct("at_rest") == [yes(rests)], moved=said, cases=len(rows))


def text_of(table, plan, subject):
    slow, fast = (largest_stable(table.where(part=part, encoder_step_mm=plan.encoders[0]), rate)
                  for part, rate in (("map", plan.rates[0]), ("fastest", FASTEST)))
    rests, moves = (compared(table, plan, *list(PARTS)[2:], steps) for steps in (2, 10))
    tremor = [largest(table.where(part="trembling", rate_hz=rate)["above_20_hz_percent"]) for rate in plan.rates]
    return PAGE.text(volume=subject.name, slow=slow, fast=fast, slowest=plan.rates[0], cases=len(rests), rest=counted(rests),
                     wide=counted(moves), most=max(0, *(linear - smooth for *_, linear, smooth in moves)),
                     tremor=tremor[0], faster=max(tremor[1:]))


def run(options):
    plan = QUICK if options.quick else FULL
    subject = options.subjects[0] if options.subjects else synthetic("sphere")
    parts = options.each(itertools.zip_longest(*[iter(cases_of(subject, plan))] * 64))
    table = Table(row for part in parts for row in in_parallel(lambda case: case[0](*case[1]), filter(None, part)))
    return Result(table, [map_figure(table, plan), profile_figure(table, plan), rotation_figure(table, plan)],
                  [*claims_of_rest(table, plan), *claims_of_rotation(table)], text_of(table, plan, subject),
                  summary_of(table, plan))
