"""Replay in Python against the command line: the same bits, on synthetic and real volumes."""

import base64
import copy
import csv
import os
import re
import struct
import subprocess
from xml.etree import ElementTree

import numpy
import pytest

import palpate
from live_test import until

PALPATE, NAN = os.environ["PALPATE"], float("nan")
# Volume, level, options of the command line and the same in Python.
CASES = {
    "torus": ("synthetic:torus:40x40x40", 0.5, [], {}),
    "noise_with_friction": (
        "synthetic:marschner-lobb:40x40x40", 0.5, ["--friction", "0.4,0.3", "--stiffness", "0.7"],
        {"friction": palpate.Friction(static_coefficient=0.4, dynamic_coefficient=0.3),
         "stiffness": 0.7}),
    "head": (str(palpate.sample_volume()), palpate.SAMPLE_SKIN, [], {}),
    "head_with_a_tool": (str(palpate.sample_volume()), palpate.SAMPLE_BONE, ["--tool", "sphere:3"],
                         {"tool": "sphere:3"}),
    "head_by_the_paper": (str(palpate.sample_volume()), palpate.SAMPLE_SKIN, ["--method", "paper"],
                          {"method": "paper"}),
}


def motion_on(field, level):
    settings = palpate.MotionSettings(duration_s=1.5, seed=3)
    return palpate.motion("slide", field, level, settings)


def field_for(name, settings):
    volume = palpate.load(name).volume
    linear = settings.get("method") == "paper"
    return palpate.Field(volume, interpolation="linear" if linear else "cubic")


def write_trajectory(path, seconds, position):
    with open(path, "w", encoding="ascii") as file:
        file.write("t,x,y,z\n")
        for t, at in zip(seconds, position):
            file.write(",".join(repr(float(number)) for number in (t, *at)) + "\n")


@pytest.mark.parametrize("case", CASES)
def test_replay_is_bit_identical_to_the_command_line(tmp_path, case):
    name, level, options, settings = CASES[case]
    field = field_for(name, settings)
    seconds, position = motion_on(field, level)
    write_trajectory(tmp_path / "hand.csv", seconds, position)
    subprocess.run([PALPATE, "replay", name, "--trajectory", tmp_path / "hand.csv", "--isovalue",
                    str(level), "--output", tmp_path / "trace.csv", "--path", tmp_path / "path.csv",
                    "--quiet", *options], check=True)
    told = palpate.read_trace(tmp_path / "trace.csv")
    ours = palpate.replay(field, level, seconds, position, path=True, **settings)
    assert ours.constrained.sum() > 100  # the motion touches
    for column in ("t", "hip", "scp", "force", "density", "isovalue", "constrained", "tetrahedra"):
        assert numpy.array_equal(getattr(told, column), getattr(ours, column)), column
    if "tool" in settings:
        for column in ("torque", "proxy_orientation_xyzw"):
            assert numpy.array_equal(getattr(told, column), getattr(ours, column)), column
        with open(tmp_path / "trace.csv", encoding="ascii") as file:
            contacts = [int(row["contacts"]) for row in csv.DictReader(file)]
        assert numpy.array_equal(contacts, ours.contacts)
    with open(tmp_path / "path.csv", encoding="ascii") as file:
        rows = [row for row in csv.reader(file) if row[0].isdigit()]
    assert numpy.array_equal([int(row[0]) for row in rows], ours.path[0])
    assert numpy.array_equal([[float(x) for x in row[1:]] for row in rows], ours.path[1])


def test_a_renderer_tick_by_tick_gives_the_ticks_of_a_replay():
    scene = palpate.scene("torus:40x40x40")
    field = palpate.Field(scene.volume)
    seconds, position = motion_on(field, scene.isovalue)
    setup = palpate.RenderSetup.offline()
    whole = palpate.replay(field, scene.isovalue, seconds, position, setup=setup)
    renderer = palpate.Renderer(field, scene.isovalue, setup)
    ticks = [renderer.render(t, at) for t, at in zip(seconds, position)]
    assert numpy.array_equal([tick.scp for tick in ticks], whole.scp)
    assert numpy.array_equal([tick.force for tick in ticks], whole.force)


def test_a_copied_renderer_goes_on_exactly_as_its_original():
    scene = palpate.scene("torus:40x40x40")
    field = palpate.Field(scene.volume)
    seconds, position = motion_on(field, scene.isovalue)
    renderer = palpate.Renderer(field, scene.isovalue, palpate.RenderSetup.offline())
    half = len(seconds) // 2
    for t, at in zip(seconds[:half], position[:half]):
        renderer.render(t, at)
    others = renderer.copy(), copy.copy(renderer), copy.deepcopy(renderer)
    for t, at in zip(seconds[half:], position[half:]):
        force = renderer.render(t, at).force
        assert all(numpy.array_equal(force, other.render(t, at).force) for other in others)


def test_layers_and_penetrability_are_felt():
    loaded = palpate.load(palpate.sample_volume())
    field = palpate.Field(loaded.volume)
    seconds, position = palpate.motion("press", field, palpate.SAMPLE_SKIN,
                                       palpate.MotionSettings(depth_mm=25, duration_s=3))
    layered = palpate.replay(field, palpate.SAMPLE_SKIN, seconds, position, layers="sample-head")
    assert layered.layer_names and layered.inside.max() > 0
    pressed = palpate.replay(field, palpate.SAMPLE_SKIN, seconds, position,
                             penetrability=palpate.Penetrability(threshold=0.5))
    assert pressed.isovalue.max() > palpate.SAMPLE_SKIN


@pytest.mark.parametrize("change, words", [
    ({"time": [0.0, 0.0]}, "row 1.*time"),
    ({"time": [0.0]}, "as many positions"),
    ({"time": [0.0, numpy.nan]}, "row 1"),
    ({"position": numpy.zeros((2, 2))}, r"shape \(n, 3\)"),
    ({"position": numpy.full((2, 3), numpy.inf)}, "row 0.*finite"),
    ({"time": [], "position": numpy.zeros((0, 3))}, "at least one"),
    ({"orientation_xyzw": [[0, 0, 0, 0], [0, 0, 0, 1]]}, "row 0.*length 1"),
    ({"isovalue": numpy.nan}, "isovalue"),
    ({"poses": True}, "tool"),
    ({"method": "best"}, "exact"),
    ({"stiffness": -1}, "stiffness")])
def test_bad_input_is_a_value_error_that_says_what_is_wrong(change, words):
    scene = palpate.scene("torus:16x16x16")
    given = {"isovalue": scene.isovalue, "time": [0.0, 0.001], "position": numpy.zeros((2, 3)),
             **change}
    with pytest.raises(ValueError, match=words):
        palpate.replay(palpate.Field(scene.volume), **given)


def test_a_setting_that_there_is_not_is_a_type_error():
    scene = palpate.scene("torus:16x16x16")
    with pytest.raises(TypeError, match="no argument stifness .did you mean stiffness"):
        palpate.replay(palpate.Field(scene.volume), 0.5, [0.0], [[0, 0, 0]], stifness=1)


def test_a_field_as_a_keyword_and_in_a_setup_give_the_same_ticks():
    scene = palpate.scene("sphere:40x40x40", "float32")
    field = palpate.Field(scene.volume)
    time = numpy.arange(1000) / 1000
    position = numpy.zeros((1000, 3))
    top = field.cast_ray(scene.isovalue, (0, 0, 30), (0, 0, 0))[0][2]
    position[:, 2] = top + 0.05 - 4 * time  # it touches while a ramp would last

    def forces(**given):
        return palpate.replay(field, scene.isovalue, time, position, **given).force
    wanted = forces(stiffness=0.5)
    assert numpy.count_nonzero(wanted[:, 2]) > 300
    for setup in (palpate.RenderSetup(stiffness=0.5), palpate.RenderSetup.offline(),
                  palpate.RenderSetup(force=palpate.ForceSettings(stiffness=0.5))):
        assert numpy.array_equal(forces(setup=setup), wanted)
    live = palpate.RenderSetup(force=palpate.ForceSettings(ramp=2))
    assert not numpy.array_equal(forces(setup=live), wanted)


def pressed(**settings):
    scene = palpate.scene("sphere:40x40x40", "float32")
    field = palpate.Field(scene.volume)
    top = field.cast_ray(scene.isovalue, (0, 0, 30), (0, 0, 0))[0]
    time = numpy.arange(300) / 1000
    position = top + numpy.outer(1 - 10 * time, (0, 0, 1))
    return palpate.replay(field, scene.isovalue, time, position, **settings)


@pytest.mark.parametrize("settings", [{}, {"tool": "sphere:1"}, {"layers": palpate.Layers(
    layers=[palpate.Layer(name="outer, soft", level=0.3), palpate.Layer(name="inner", level=0.6)])}])
def test_a_trace_is_written_and_read_back_bit_for_bit(settings, tmp_path):
    trace = pressed(**settings)
    trace.write(tmp_path / "trace.csv")
    again = palpate.read_trace(tmp_path / "trace.csv")
    for name in ("t", "hip", "scp", "force", "density", "isovalue", "constrained", "tetrahedra", "update_ns"):
        assert numpy.array_equal(getattr(again, name), getattr(trace, name)), name
    assert again.has_tool == trace.has_tool == ("tool" in settings)
    for name in ("torque", "hand_orientation_xyzw", "proxy_orientation_xyzw", "contacts", "layer", "inside"):
        assert numpy.array_equal(getattr(again, name), getattr(trace, name)), name
    assert again.layer_names == (("outer_ soft",) if "layers" in settings else ())  # the inner one is not reached
    assert ("tool" in settings) == bool(trace.contacts.any()) and ("layers" in settings) == (trace.layer.max() >= 0)
    text = (tmp_path / "trace.csv").read_text()
    assert ("outer_ soft" in text) == ("layers" in settings)
    again.write(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == text
    again.force = again.force[:-1]
    with pytest.raises(ValueError, match="force: the shape is .*, the trace has 300 ticks"):
        again.write(tmp_path / "short.csv")
    with pytest.raises(palpate.OutputError):
        trace.write(tmp_path / "none" / "trace.csv")


HEADER = ("t,hip_x,hip_y,hip_z,scp_x,scp_y,scp_z,force_x,force_y,force_z,density,isovalue,mode,tetrahedra,update_ns,layer,inside\n"
          "0,1,2,3,4,5,6,7,8,9,10,11,free,1,2,,a+b\n")
ROW = "0,1,2,3,4,5,6,7,8,9,10,11,free,1,2,"


def test_layers_of_a_trace_are_named_in_its_order_and_have_to_be_nested(tmp_path):
    path = tmp_path / "trace.csv"
    path.write_text(HEADER + ROW + "c,a\n" + ROW + "b,d\n" + ROW + ",\n")
    trace = palpate.read_trace(path)
    assert (trace.layer_names, trace.nested_layers) == (("a", "b", "c", "d"), 2)
    assert trace.layer.tolist() == [-1, 2, 1, -1] and trace.inside.tolist() == [2, 1, 4, 0]
    for cells, why in ((",b", "from the outermost"), (",b+a", "from the outermost"), (",a+c", "from the outermost")):
        path.write_text(HEADER + ROW + cells + "\n")
        with pytest.raises(palpate.InputError, match="trace.csv, line 3: .*" + why):
            palpate.read_trace(path)
    path.write_text(HEADER + "".join(f"{ROW}x{i},\n" for i in range(20)))
    with pytest.raises(palpate.InputError, match="more than 16 layers"):
        palpate.read_trace(path)


@pytest.mark.parametrize("column, value", [
    ("layer", 300), ("layer", 2), ("layer", -2), ("inside", -1), ("inside", 3), ("inside", 0.5), ("tetrahedra", NAN), ("contacts", 2**40),
    ("update_ns", 1e30)])
def test_a_trace_with_a_number_that_cannot_be_is_not_written(column, value, tmp_path):
    trace = pressed(layers=palpate.Layers(layers=[palpate.Layer(name="outer", level=0.3), palpate.Layer(name="inner", level=0.6)]))
    setattr(trace, column, numpy.where(trace.t == trace.t[7], value, getattr(trace, column)))
    with pytest.raises(ValueError, match=column):
        trace.write(tmp_path / "trace.csv")
    assert not list(tmp_path.iterdir())


def test_a_notebook_shows_facts_and_pictures():
    trace = pressed()
    volume = palpate.scene("torus:24x20x16", "uint8").volume
    field = palpate.Field(volume)
    mesh = palpate.extract(field, "50%")
    loaded = palpate.load("synthetic:beating:12x10x8")
    for shown, facts in ((loaded, ("synthetic:beating:12x10x8", "12 x 10 x 8", "frames", "data:image/png;base64,")), (volume, ("24 x 20 x 16 uint8", "data:image/png;base64,")),
                         (field, ("cubic", "data:image/png;base64,")),
                         (mesh, (f">{len(mesh.vertices)}<", "mm³")),
                         (trace, (">300<", "<polyline", f"{trace.summary['largest_force']:.3g} N"))):
        text = shown._repr_html_()
        assert all(fact in text for fact in facts), text
        ElementTree.fromstring(text)
    png = base64.b64decode(re.search("base64,([^']*)", volume._repr_html_()).group(1))
    assert png.startswith(b"\x89PNG") and struct.unpack(">II", png[16:24]) == (24, 20)


class Axes:
    """Of Matplotlib, as far as plot() needs them."""

    def __init__(self):
        self.drawn, self.labels, self.shaded = [], set(), None

    def plot(self, x, y):
        self.drawn.append((x, y))

    def set_ylabel(self, text):
        self.labels.add(text)

    set_xlabel = set_ylabel

    def get_xaxis_transform(self):
        return "in axes"

    def fill_between(self, x, low, high, where, transform, **style):
        self.shaded = where


def test_a_trace_is_drawn_into_two_axes():
    trace = pressed()
    force, depth = trace.plot(axes=(Axes(), Axes()))
    assert force.labels == {"force [N]"} and "time [s]" in depth.labels
    for axes, values in ((force, trace.force), (depth, trace.scp - trace.hip)):
        [(time_drawn, drawn)] = axes.drawn
        assert numpy.array_equal(time_drawn, trace.t)
        assert numpy.array_equal(drawn, numpy.linalg.norm(values, axis=1)) and drawn.max() > 0.5
        assert axes.shaded.sum() > 100 and numpy.array_equal(axes.shaded, trace.constrained)


def test_a_tick_that_differs_is_told_as_on_the_command_line(tmp_path):
    path = tmp_path / "run.csv"
    hand = ["touch", "synthetic:sphere:16x16x16", "--unpaced", "--device", "simulated:hand=press", "--seconds", "0.6"]
    subprocess.run([PALPATE, *hand, "--record", path, "-q"], check=True)
    assert palpate.validate(path)["ticks"] > 500
    path.write_text(path.read_text().replace('"stiffness": 0.5', '"stiffness": 0.6', 1))
    told = subprocess.run([PALPATE, "replay", path, "--validate"], stderr=subprocess.PIPE, text=True, check=False).stderr
    with pytest.raises(palpate.InputError, match=r"run.csv: tick \d+ \(line \d+, [\d.]+ s\) differs: force: recorded") as raised:
        palpate.validate(path)
    assert told == f"palpate: {raised.value}\n"


@pytest.mark.parametrize("settings", [{"tool": "rod:4"}, {"layers": "sample-head"}])
def test_the_trace_of_a_recording_is_written_with_its_tool_or_layers(settings, tmp_path):
    level = {"isovalue": 76.5} if "tool" in settings else {}
    setup = palpate.Setup(device="simulated:hand=press", real_time=False, render=palpate.RenderSetup(**settings), **level)
    with palpate.Run(palpate.load("synthetic:torus:32x32x32"), setup) as run:
        run.record(tmp_path / "r.csv")
        until(lambda: run.snapshot() and run.snapshot().number > 600)
    trace = palpate.read_recording(tmp_path / "r.csv").trace
    assert trace.has_tool == ("tool" in settings) and trace.layer_names == (() if trace.has_tool else ("skin", "bone"))
    trace.write(tmp_path / "t.csv")
    again = palpate.read_trace(tmp_path / "t.csv")
    for name in ("torque", "hand_orientation_xyzw", "contacts", "layer", "inside"):
        assert numpy.array_equal(getattr(again, name), getattr(trace, name)), name
