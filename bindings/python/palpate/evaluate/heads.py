"""Straight strokes from the skin through the bone of heads in CT scans, for the experiment layers."""

import dataclasses

import numpy
import palpate

from . import figures
from .experiment import GRANTED, Page, largest
from .hands import Way, way_from_a_side, way_into_head
from .subjects import Subject, linear, reals
from .tissues import RATE, layered, renderer, thinned, times

PAGE = Page(__name__)
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
        return layered(name, [("skin", self.subject.isovalue, 0.4, 0.8), ("bone", self.bone, 1.5, SETS[name])])


def heads_of(options):
    if options.subjects:  # half way to the innermost density is bone
        innermost = [subject.field.volume.maximum if subject.sign > 0 else subject.field.volume.minimum for subject in options.subjects]
        return [Head(subject, 0.5 * (subject.isovalue + density), *way_from_a_side(subject))
                for subject, density in zip(options.subjects, innermost)]
    sample = palpate.SAMPLE_SKIN, palpate.SAMPLE_BONE
    levels = {"sample head": sample, "ct-head": (500, 1200), "visible-human": sample}
    scans = [linear("sample head", palpate.load(palpate.sample_volume()).volume, palpate.SAMPLE_SKIN),
             *reals(list(levels)[1:], options)]
    scans = [dataclasses.replace(scan, isovalue=levels[scan.name][0]) for scan in scans]
    return [Head(scan, levels[scan.name][1], way_into_head(scan)) for scan in scans]


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



def figure_of_heads(table, heads):
    shown = heads[:3]
    title = "Skin, bone, bone from behind, in one stroke" if heads[0].subject.name == "sample head" else "Two surfaces in one stroke"
    drawn, panels = figures.panels(2, len(shown), height=4.4, width=figures.PAGE if len(shown) > 1 else 4.2, title=title, sharex="col",
                                   squeeze=False)
    for (density, force), head in zip(panels.T, shown):
        subject, curves = head.subject, dict(table.where(part="head curve", body=head.subject.name).by("surfaces"))
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
    panels[0, 0].set_ylabel("density at the hand\n[data units]")
    panels[1, 0].set_ylabel("force [N]")
    figures.names(panels[1, -1], (("bone holds", figures.VERMILION), ("drilling", figures.BLUE)), 0.98, 0.97, 0.09, ha="right")
    return PAGE.figure(drawn, "heads")


def claims_of_heads(table):
    rows = table.where(part="head")
    wrong = int(rows["bone_outside_skin_ticks"].sum())
    yield PAGE.claim("order", wrong == 0, wrong=wrong, ticks=int(rows["ticks"].sum()))
    yield PAGE.at_most(GRANTED, rows.where(surfaces="skin, bone")["deepest_in_bone_of_range"], "bone")


def text_of_heads(table):
    drilled = table.where(part="head", surfaces="drilling")
    return PAGE.text(orders=" ".join(f"In {row['body']}: {row['order'].replace(';', ',')}." for row in drilled))
