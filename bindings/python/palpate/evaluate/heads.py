"""Straight strokes from the skin through the bone of heads in CT scans, for the experiment layers."""

import dataclasses

import numpy
import palpate

from . import figures
from .experiment import GRANTED, Claim, Figure, at_most, largest
from .hands import Way, way_from_a_side, way_in
from .subjects import Subject, reals
from .tissues import RATE, renderer, thinned, times

SPEED = 20  # [mm/s]
BEFORE = 3  # [mm] of free space
MOST_FORCE = 5  # [N] at which the hand stops
SETS = {"skin, bone": numpy.inf, "drilling": 2.5}  # puncture force of bone [N], which gives way for a drill only


@dataclasses.dataclass
class Head:
    """A head, or a user's volume, with the levels of its skin (the subject's) and of its bone. Depth 0 is where the way meets the skin."""

    subject: Subject
    bone: float
    way: Way
    depth: float = 28  # [mm] of the hand

    def layers(self, name):
        return palpate.Layers(name=name, layers=[
            palpate.Layer(name="skin", level=self.subject.isovalue, properties={"stiffness": 0.4, "puncture_force": 0.8}),
            palpate.Layer(name="bone", level=self.bone, properties={"stiffness": 1.5, "puncture_force": SETS[name]})])


def known(subject, skin, bone, through, inward):
    subject = dataclasses.replace(subject, isovalue=skin)
    way = way_in(subject, numpy.array(through), numpy.array(inward) / numpy.linalg.norm(inward))
    if way is None:
        raise ValueError(f"{subject.name} is not the head that the line was chosen for")
    return Head(subject, bone, way)


def of_a_user(subject):
    innermost = subject.field.volume.maximum if subject.sign > 0 else subject.field.volume.minimum
    return Head(subject, subject.isovalue + 0.5 * (innermost - subject.isovalue), *way_from_a_side(subject))


def heads_of(options):
    """Through the forehead beside the middle, along the skin's normal there; on the CT head over the left brow, where the skull has no
    sinus. Both scans of the sample's head have the same axes."""
    if options.subjects:
        return [of_a_user(subject) for subject in options.subjects]
    whole = (palpate.SAMPLE_SKIN, palpate.SAMPLE_BONE, (278.5, 160.5, 170.5), (0, 1, -0.4))
    lines = {"sample head": whole, "ct-head": (500, 1200, (103, 64, 44), (0, 1, 0.6)), "visible-human": whole}
    sample = palpate.Field(palpate.load(palpate.sample_volume()).volume, interpolation="linear")
    found = [Subject("sample head", sample, palpate.SAMPLE_SKIN), *reals([] if options.quick else list(lines)[1:], options)]
    return [known(subject, *lines[subject.name]) for subject in found]


def events_of(where, depth, trace, force):
    """(what, depth, the last force before it) of surfaces that are met and that give way. A surface that lets go and is met again at
    once is no news."""
    layer, behind = (numpy.append(first, trace[column]) for first, column in ((-1, "layer"), (False, "behind")))
    force, last = numpy.append(0, force), ""

    def said(way, tick):
        return f"{way} {('skin', 'bone')[int(layer[tick])]}{' from behind' if behind[tick] else ''}"

    for tick in numpy.flatnonzero((trace["punctured"] > 0) | (layer[1:] != layer[:-1]) | (behind[1:] != behind[:-1])):
        event = {"part": "head event", **where, "depth_mm": depth[tick], "force_n": force[tick]}
        if trace["punctured"][tick] > 0 and layer[tick] >= 0:
            last = said("through", tick)
            yield {**event, "order": last}
        changed = layer[tick + 1] != layer[tick] or behind[tick + 1] != behind[tick]
        if layer[tick + 1] >= 0 and changed and said("on", tick + 1) != last:
            last = said("on", tick + 1)
            yield {**event, "order": last}


def press_into(head, name, resolution):
    """Presses in until the force is more than the hand stands: rows of the curve, the events, and of the whole stroke."""
    subject, step = head.subject, SPEED / RATE
    depth = -BEFORE + step * numpy.arange(int(numpy.ceil((head.depth + BEFORE) / step)))
    trace = renderer(subject.field, head.layers(name)).follow(times(len(depth)), head.way.at(depth))
    force = numpy.linalg.norm(trace["force"], axis=1)
    stops = force > MOST_FORCE
    end = int(stops.argmax()) + 1 if stops.any() else len(depth)
    depth, force, part = depth[:end], force[:end], {column: values[:end] for column, values in trace.items()}
    at_hand, where = subject.field.value(head.way.at(depth)), {"body": subject.name, "surfaces": name}
    for tick in thinned(depth, lambda one, last: one >= last + resolution, stops):
        yield {"part": "head curve", **where, "depth_mm": depth[tick], "force_n": force[tick], "inside": int(part["inside"][tick]),
               "density_at_hand": at_hand[tick]}
    events = list(events_of(where, depth, part, force))
    yield from events
    yield {"part": "head", **where, "ticks": end, "greatest_sampled_n": force.max(), "depth_mm": depth[-1],
           "bone_outside_skin_ticks": int(((part["layer"] == 1) & (part["inside"] < 1)).sum()),
           "deepest_in_bone_of_range": largest(subject.sign * (part["density"] - head.bone) / subject.field.range),
           "order": "; ".join(f"{event['order']} {event['depth_mm']:.1f}" for event in events)}


def draw_head(density, force, head, table):
    subject, curves = head.subject, {name: table.where(part="head curve", body=head.subject.name, surfaces=name) for name in SETS}
    drill = curves["drilling"]
    density.fill_between(drill["depth_mm"], drill["density_at_hand"], subject.field.volume.minimum, color="#dcdcdc", lw=0)
    for name, level, colour in (("skin", subject.isovalue, figures.ORANGE), ("bone", head.bone, figures.PURPLE)):
        density.axhline(level, color=colour, ls="--", lw=1)
        density.text(0.99, level, name, color=colour, fontsize=7, va="bottom", ha="right", transform=density.get_yaxis_transform())
    for name, colour, width in (("skin, bone", figures.VERMILION, 3), ("drilling", figures.BLUE, 1.2)):
        force.plot(curves[name]["depth_mm"], curves[name]["force_n"], color=colour, lw=width)
    for event in table.where(part="head event", body=subject.name, surfaces="drilling"):
        way, _, what = event["order"].partition(" ")
        if way == "through":
            force.annotate(what, (event["depth_mm"], event["force_n"]), xytext=(2, 3), textcoords="offset points", fontsize=6.5,
                           color=figures.GREY)
    density.set_title(subject.name)
    force.set(xlabel="depth of the hand [mm]", ylim=(0, 5.4))


def figure_of_heads(table, heads):
    shown = heads[:3]
    title = "Skin, bone, bone from behind, in one stroke" if heads[0].subject.name == "sample head" else "Two surfaces in one stroke"
    drawn, panels = figures.panels(2, len(shown), height=4.4, width=figures.PAGE if len(shown) > 1 else 4.2, title=title, sharex="col",
                                   squeeze=False)
    for (density, force), head in zip(panels.T, shown):
        draw_head(density, force, head, table)
    panels[0, 0].set_ylabel("density at the hand\n[data units]")
    panels[1, 0].set_ylabel("force [N]")
    figures.names(panels[1, -1], (("bone holds", figures.VERMILION), ("drilling", figures.BLUE)), 0.98, 0.97, 0.09, ha="right")
    return Figure("heads", """From the skin through the bone in one stroke. Above: the data at the hand and the levels of the two surfaces
        (dashed). Below: the force. With bone that holds, the hand stops at 5 N. With bone that gives way, as for a drill, it breaks
        through both sides of the skull.""", drawn)


def claims_of_heads(table):
    rows = table.where(part="head")
    wrong, ticks = int(rows["bone_outside_skin_ticks"].sum()), int(rows["ticks"].sum())
    return [Claim("in heads the bone is never felt before the skin gave way", wrong == 0, f"{wrong} of {ticks} ticks"),
            at_most(GRANTED, rows.where(surfaces="skin, bone")["deepest_in_bone_of_range"],
                    f"bone that never gives way is never entered (to {GRANTED:g} of the data's range)", "largest excess {:.2g}")]


def sentences_of_heads(table):
    return (f"A hand presses into heads at {SPEED} mm/s. Skin gives way at 0.8 N, bone never (then the hand stops at {MOST_FORCE} N) or, "
            "as in drilling, at 2.5 N. Drilling, it meets these surfaces, with the depth in mm. " +
            " ".join(f"{row['body']}: {row['order']}." for row in table.where(part="head", surfaces="drilling")))
