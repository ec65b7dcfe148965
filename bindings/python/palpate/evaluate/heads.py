"""Straight strokes from the skin through the bone of heads in CT scans, for the experiment layers."""

import dataclasses

import numpy
import palpate

from . import figures
from .experiment import GRANTED, Claim, Figure, largest
from .subjects import real
from .tissues import RATE, Way, renderer, times

SPEED = 20  # [mm/s]
BEFORE = 3  # [mm] of free space
MOST_FORCE = 5  # [N] at which the hand stops
SETS = {"skin, bone": numpy.inf, "drilling": 2.5}  # puncture force of bone [N], which gives way for a drill only


@dataclasses.dataclass
class Head:
    """A head, or a user's volume with two levels. Depth 0 is where the way meets the skin."""

    name: str
    field: palpate.Field
    skin: float
    bone: float
    way: Way
    depth: float  # [mm] of the hand

    def layers(self, name):
        return palpate.Layers(name=name, layers=[
            palpate.Layer(name="skin", level=self.skin, properties={"stiffness": 0.4, "puncture_force": 0.8}),
            palpate.Layer(name="bone", level=self.bone, properties={"stiffness": 1.5, "puncture_force": SETS[name]})])


def way_through(field, skin, through, inward):
    """From where the line first meets the skin; None where it does not."""
    far = 2 * numpy.linalg.norm(field.geometry.size * field.geometry.spacing)
    outside = through - far * inward
    met = palpate.cast_rays(field, skin, [outside], [through])[0][0]
    return None if numpy.isnan(met[0]) or (met == outside).all() else Way(met, inward)


def known(name, field, skin, bone, through, inward):
    inward = numpy.array(inward) / numpy.linalg.norm(inward)
    way = way_through(field, skin, numpy.array(through), inward)
    if way is None:
        raise ValueError(f"{name} is not the head that the line was chosen for")
    return Head(name, field, skin, bone, way, 28)


def of_a_user(subject):
    """From the first side of the box whose middle line meets the surface."""
    field = subject.field
    innermost = field.volume.maximum if subject.sign > 0 else field.volume.minimum
    bone, centre = subject.isovalue + 0.5 * (innermost - subject.isovalue), numpy.array(field.geometry.centre)
    for side in (1, -1):
        for axis in (1, 0, 2):
            way = way_through(field, subject.isovalue, centre, side * numpy.array(field.geometry.direction)[:, axis])
            if way is not None and (centre != way.origin).any():
                return Head(subject.name, field, subject.isovalue, bone, way, float(numpy.linalg.norm(centre - way.origin)))
    raise ValueError(f"{subject.name}: no line from a side of the volume to its middle meets the surface; choose another level")


def heads_of(options, data):
    """Through the forehead beside the middle, along the skin's normal there; on the CT head over the left brow, where the
    skull has no sinus. Both scans of the sample's head have the same axes."""
    if options.subjects:
        return [of_a_user(subject) for subject in options.subjects]
    levels, line = (palpate.SAMPLE_SKIN, palpate.SAMPLE_BONE), ((278.5, 160.5, 170.5), (0, 1, -0.4))
    field = palpate.Field(palpate.load(palpate.sample_volume()).volume, interpolation="linear")
    heads = [known("sample head", field, *levels, *line)]
    wanted = {"ct-head": (500, 1200, (103, 64, 44), (0, 1, 0.6)), "visible-human": (*levels, *line)}
    for name, rest in wanted.items() if not options.quick else ():
        subject = real(name, options)
        if subject:
            heads.append(known(name, subject.field, *rest))
    return heads


def events_of(head, name, depth, trace, force):
    """(what, depth, the last force before it) of surfaces that are met and that give way. A surface that lets go and is
    met again at once is no news."""
    names, last = ("skin", "bone"), ""
    layer, behind = (numpy.concatenate([[first], trace[column]]) for first, column in ((-1, "layer"), (False, "behind")))
    force = numpy.concatenate([[0], force])
    for tick in numpy.flatnonzero((trace["punctured"] > 0) | (layer[1:] != layer[:-1]) | (behind[1:] != behind[:-1])):
        was, now = ((layer[i], behind[i]) for i in (tick, tick + 1))
        event = {"part": "head event", "body": head.name, "surfaces": name, "depth_mm": depth[tick], "force_n": force[tick]}

        def said(way, of):
            return f"{way} {names[of[0]]}{' from behind' if of[1] else ''}"

        if trace["punctured"][tick] > 0 and was[0] >= 0:
            last = said("through", was)
            yield {**event, "order": last}
        if now[0] >= 0 and now != was and said("on", now) != last:
            last = said("on", now)
            yield {**event, "order": last}


def press_into(head, name, resolution):
    """Presses in until the force is more than the hand stands: rows of the curve, the events, and of the whole stroke."""
    step = SPEED / RATE
    depth = -BEFORE + step * numpy.arange(int(numpy.ceil((head.depth + BEFORE) / step)))
    hand = head.way.at(depth)
    trace = renderer(head.field, head.layers(name)).follow(times(len(depth)), hand)
    force = numpy.linalg.norm(trace["force"], axis=1)
    stops = force > MOST_FORCE
    end = int(stops.argmax()) + 1 if stops.any() else len(depth)
    sign, written = 1 if head.field.solid == "above" else -1, -numpy.inf
    at_hand, where = head.field.value(hand), {"body": head.name, "surfaces": name}
    for tick in range(end):
        if depth[tick] >= written + resolution or stops[tick]:
            written = depth[tick]
            yield {"part": "head curve", **where, "depth_mm": written, "force_n": force[tick],
                   "inside": int(trace["inside"][tick]), "density_at_hand": at_hand[tick]}
    part = {column: values[:end] for column, values in trace.items()}
    events = list(events_of(head, name, depth, part, force))
    yield from events
    yield {"part": "head", **where, "ticks": end, "greatest_sampled_n": force[:end].max(), "depth_mm": depth[end - 1],
           "bone_outside_skin_ticks": int(((part["layer"] == 1) & (part["inside"] < 1)).sum()),
           "deepest_in_bone_of_range": largest(sign * (part["density"] - head.bone) / head.field.range),
           "order": "; ".join(f"{event['order']} {event['depth_mm']:.1f}" for event in events)}


def claims_of_heads(table):
    rows = table.where(part="head")
    wrong, ticks = int(rows["bone_outside_skin_ticks"].sum()), int(rows["ticks"].sum())
    inside = largest(rows.where(surfaces="skin, bone")["deepest_in_bone_of_range"])
    return [Claim("in heads the bone is never felt before the skin gave way", wrong == 0, f"{wrong} of {ticks} ticks"),
            Claim(f"bone that never gives way is never entered (to {GRANTED:g} of the data's range)", inside <= GRANTED,
                  f"largest excess {inside:.2g}")]


def sentences_of_heads(table):
    return (f"A hand presses into heads at {SPEED} mm/s. Skin gives way at 0.8 N, bone never (then the hand stops at {MOST_FORCE} N) or, "
            "as in drilling, at 2.5 N. Drilling, it meets these surfaces, with the depth in mm. " +
            " ".join(f"{row['body']}: {row['order']}." for row in table.where(part="head", surfaces="drilling")))


def draw_heads(table, heads):
    shown = heads[:3]
    drawn, panels = figures.panels(2, len(shown), height=4.4, width=figures.PAGE if len(shown) > 1 else 4.2, sharex="col",
                                   squeeze=False)
    for (density, force), head in zip(panels.T, shown):
        curves = {name: table.where(part="head curve", body=head.name, surfaces=name) for name in SETS}
        drill = curves["drilling"]
        density.fill_between(drill["depth_mm"], drill["density_at_hand"], head.field.volume.minimum, color="#dcdcdc", lw=0)
        for name, level, colour in (("skin", head.skin, figures.ORANGE), ("bone", head.bone, figures.PURPLE)):
            density.axhline(level, color=colour, ls="--", lw=1)
            density.text(0.99, level, name, color=colour, fontsize=7, va="bottom", ha="right",
                         transform=density.get_yaxis_transform())
        for name, colour, width in (("skin, bone", figures.VERMILION, 3), ("drilling", figures.BLUE, 1.2)):
            force.plot(curves[name]["depth_mm"], curves[name]["force_n"], color=colour, lw=width)
        for event in table.where(part="head event", body=head.name, surfaces="drilling"):
            way, _, what = event["order"].partition(" ")
            if way == "through":
                force.annotate(what, (event["depth_mm"], event["force_n"]), xytext=(2, 3), textcoords="offset points",
                               fontsize=6.5, color=figures.GREY)
        density.set_title(head.name)
        force.set(xlabel="depth of the hand [mm]", ylim=(0, 5.4))
    panels[0][0].set_ylabel("density at the hand\n[data units]")
    panels[1][0].set_ylabel("force [N]")
    panels[1][-1].text(0.98, 0.97, "bone holds", color=figures.VERMILION, fontsize=7.5, transform=panels[1][-1].transAxes,
                       ha="right", va="top")
    panels[1][-1].text(0.98, 0.88, "drilling", color=figures.BLUE, fontsize=7.5, transform=panels[1][-1].transAxes,
                       ha="right", va="top")
    drawn.suptitle("Skin, bone, bone from behind, in one stroke", x=0.01, ha="left")
    return Figure("heads", "From the skin through the bone in one stroke. Above: the data at the hand and the levels of the two "
                  "surfaces (dashed). Below: the force. With bone that holds, the hand stops at 5 N. With bone that gives way, as for "
                  "a drill, it breaks through both sides of the skull.", drawn)
