"""Each argument that may be left out changes the result, or is refused in one line where it changes nothing. An argument that is
added to the module has to be listed here."""

import glob
import http.server
import inspect
import os
import pathlib
import pickle
import shutil
import subprocess
import threading
import uuid

import numpy
import palpate
import pytest
from palpate import arguments

BALL = palpate.scene("sphere:16x16x16")
VOLUME, ISOVALUE = palpate.Volume(BALL.volume.array), BALL.isovalue
CUBIC, LINEAR = palpate.Field(BALL.volume), palpate.Field(BALL.volume, interpolation="linear")
OTHER = palpate.Volume(VOLUME.array // 2)
HIPS = numpy.array([[-9.0, 0, 0], [-4, 0, 0], [-3, 1, 0]])
TIMES = numpy.arange(3) / 1000
STEEP = palpate.Layers(layers=[palpate.Layer(name="a", level=ISOVALUE, properties={"puncture_force": 0.1})])

# Arguments that tell how fast, how often or how long something is done, or what a thing is called; and poses, which are data.
OTHERS = {"progress", "threads", "name", "repeats", "seed", "history_bytes", "memory_bytes", "real_time", "rate", "device_rate", "slots",
          "interval", "batch", "cold", "valid", "armed", "released", "pointing", "orientation_xyzw", "start_orientation_xyzw",
          "end_orientation_xyzw", "version", "solid"}
# Tested in these files, which have files to read.
ELSEWHERE = {"load series": "dicom_readers", "open_store channel": "readers", "open_store time": "stores",
             "LoadedVolume.__init__ level": "stores", "Store.read level": "stores",
             "layers_by_label beside": "volumes"}


def grid(volume):
    return volume.geometry.spacing.tolist(), volume.geometry.origin.tolist(), volume.geometry.direction.tolist()


def samples(volume):
    return volume.array.dtype.str, volume.array.tobytes()


def felt(trace):
    return trace.scp.tobytes(), trace.force.tobytes()


def rendered(**keywords):
    tick = palpate.Renderer(CUBIC, ISOVALUE, **keywords)
    tick.render(0, HIPS[0])
    return tick.render(0.001, HIPS[1]).force.tolist(), tick.render(0.002, HIPS[2]).force.tolist()


def followed(**keywords):
    trace = palpate.Proxy(LINEAR, ISOVALUE, HIPS[0], method=keywords.pop("method", "exact")).follow(HIPS, **keywords)
    return trace.scp.tobytes(), trace.steps is None


class Still:
    def info(self):
        return palpate.DeviceInfo(name="still")

    def read(self):
        return palpate.DeviceReading(status="ready")


def in_zarr(**keywords):
    subprocess.run([os.environ["PALPATE"], "convert", "v.nrrd", "v.zarr", "-q"], check=True)
    return palpate.open_store("v.zarr", **keywords)


def edited(**keywords):
    editor = palpate.Editor(VOLUME)
    editor.apply(palpate.Fill((0, 0, 0), (2, 2, 2), 9))
    editor.apply(palpate.Fill((3, 3, 3), (4, 4, 4), 9), **keywords)
    return editor.undo_steps


def validated(**keywords):
    name = f"{uuid.uuid4()}.csv"
    with palpate.Run(palpate.load("v.nrrd"), palpate.Setup(isovalue=ISOVALUE, real_time=False)) as running:
        running.record(name)
    running.stop_recording()
    return sorted(palpate.validate(name, **keywords))


def explored(**keywords):
    return palpate.explore(CUBIC, ISOVALUE, **{"trajectories": 1, "trajectory_s": 2.0, **keywords})["hips"].tobytes()


class Server(http.server.SimpleHTTPRequestHandler):
    """As S3 answers those who may not list what there is: a missing file is a forbidden one."""

    def send_error(self, code, message=None, explain=None):
        super().send_error(403 if code == 404 and "/c/" in self.path else code, message, explain)

    def log_message(self, *arguments):
        pass


def from_a_server(**keywords):
    """The samples of a store that lacks a chunk, or the error; and whether they are kept."""
    for folder_before in ("v.zarr", "kept"):
        shutil.rmtree(folder_before, ignore_errors=True)
    in_zarr()
    shutil.rmtree(glob.glob("v.zarr/*/c")[0])
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Server) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            store = palpate.open_store(f"http://127.0.0.1:{server.server_address[1]}/v.zarr", **keywords)
            return samples(store.read((0, 0, 0), (4, 4, 4))), os.path.exists("kept")
        except palpate.InputError:
            return "refused", os.path.exists("kept")
        finally:
            server.shutdown()


PERCENT = palpate.Layers(units="%", layers=[palpate.Layer(name="a", level=50)])
LABELS = palpate.LoadedVolume(palpate.Volume(VOLUME.array // 100))
DATA = [
    ("LoadedVolume.__init__", "isovalue", 7.0, lambda **k: palpate.LoadedVolume(VOLUME, **k).isovalue),
    ("Editor.apply", "same_step", True, edited),
    ("Run.__init__", "setup", palpate.Setup(isovalue=99), lambda **k: palpate.Run(VOLUME, **k).isovalue),
    ("Run.__init__", "device", Still(), lambda **k: palpate.Run(VOLUME, **k).device.name),
    ("validate", "volume", "synthetic:sphere:9x9x9", validated),
    ("subject", "contestant", "smooth", lambda **k: palpate.subject("synthetic:sphere:9x9x9", **k).field.interpolation),
    ("closed_loop", "straight", True, lambda **k: palpate.closed_loop(
        palpate.Renderer(CUBIC, ISOVALUE), "simulated:hand=press", 0.05, 1000, **k)["constrained"].tobytes()),
    ("explore", "speed_mm_s", 9.0, explored), ("explore", "touching", 0.0, explored), ("explore", "depth_mm", 2.0, explored),
    ("explore", "trajectories", 2, explored), ("explore", "trajectory_s", 0.4, explored), ("explore", "wanted", (20.0, 0.5), explored),
    ("layers_by_label", "like", palpate.Layers(closing=3), lambda **k: palpate.layers_by_label(LABELS, **k).closing),
    ("Renderer.follow", "alternatives", True, lambda **k: palpate.Renderer(CUBIC, ISOVALUE).follow(TIMES, HIPS, **k)["scp"].tobytes()),
    ("command.UseLayers.__init__", "volume", VOLUME, lambda **k: palpate.command.UseLayers(PERCENT, **k).same_surfaces),
    ("command.UseLayers.__init__", "same_surfaces", True, lambda **k: palpate.command.UseLayers(STEEP, **k).same_surfaces),
    ("load", "frame_interval", 0.5, lambda **k: pickle.dumps(palpate.load("synthetic:beating:9x9x9", **k))),
    ("open_store", "cache", "kept", from_a_server), ("open_store", "forbidden_is_missing", True, from_a_server),
    ("Volume.__init__", "spacing", (2, 2, 2), lambda **k: grid(palpate.Volume(VOLUME.array, **k))),
    ("Volume.__init__", "origin", (1, 2, 3), lambda **k: grid(palpate.Volume(VOLUME.array, **k))),
    ("Volume.__init__", "direction", numpy.diag([-1.0, -1, 1]), lambda **k: grid(palpate.Volume(VOLUME.array, **k))),
    ("Volume.__init__", "copy", True, lambda **k: palpate.Volume(VOLUME.array, **k).array.ctypes.data == VOLUME.array.ctypes.data),
    ("smoothed", "passes", 2, lambda **k: samples(palpate.smoothed(VOLUME, **k))),
    ("dequantized", "rounds", 2, lambda **k: samples(palpate.dequantized(VOLUME, **k))),
    ("dequantized", "coarsest", 4, lambda **k: samples(palpate.dequantized(VOLUME, **k))),
    ("dequantized", "level", 8.0, lambda **k: samples(palpate.dequantized(VOLUME, **k))),
    ("Samples.__init__", "period", 3.0, lambda **k: samples(palpate.Samples([(0.0, VOLUME), (1.0, OTHER)], **k).volume(2.5))),
    ("Samples.volume", "time", 1.0, lambda **k: samples(palpate.Samples([(0.0, VOLUME), (1.0, OTHER)]).volume(**k))),
    ("Field.__init__", "solid", "below", lambda **k: palpate.Field(VOLUME, **k).solid),
    ("Field.__init__", "background", 7.0, lambda **k: palpate.Field(VOLUME, **k).value([[99, 0, 0]]).tolist()),
    ("Field.__init__", "interpolation", "linear", lambda **k: palpate.Field(VOLUME, **k).value([[1.3, 3.4, 2.6]]).tolist()),
    ("extract", "tolerance", 1e-4, lambda **k: len(palpate.extract(CUBIC, ISOVALUE, **k).vertices)),
    ("extract", "normals", True, lambda **k: palpate.extract(CUBIC, ISOVALUE, **k).normals.shape),
    ("Tool.__init__", "gyration", 3.0, lambda **k: palpate.Tool([[0, 0, 0], [1, 0, 0]], **k).gyration),
    ("Tool.__init__", "turns", False, lambda **k: palpate.Tool([[0, 0, 0], [1, 0, 0]], **k).turns),
    ("Renderer.__init__", "setup", palpate.RenderSetup(stiffness=0.1), rendered),
    ("Renderer.__init__", "limits", palpate.DeviceLimits(maximum_force=1.0),
     lambda **k: palpate.Renderer(CUBIC, ISOVALUE, **k).limits.maximum_force),
    ("Renderer.__init__", "transform", palpate.DeviceTransform(translation=(1, 1, 1)), rendered),
    ("fit_workspace", "facing", "left", lambda **k: palpate.fit_workspace(VOLUME.geometry, palpate.DeviceInfo(), **k).rotation.tolist()),
    ("Proxy.__init__", "method", "gradient", followed),
    ("Proxy.follow", "penetrability", palpate.Penetrability(threshold=0.1), followed),
    ("Proxy.follow", "scale", 9.0, lambda **k: followed(penetrability=palpate.Penetrability(threshold=0.6), **k)),
    ("Proxy.follow", "steps", True, followed),
    ("follow_each", "method", "gradient", lambda **k: palpate.follow_each(LINEAR, ISOVALUE, HIPS, [0], **k).scp.tobytes()),
    ("update_times", "method", "nothing", lambda **k: len(palpate.update_times(LINEAR, ISOVALUE, HIPS, [0], **k))),
    ("follow_tool", "method", "penalty", lambda **k: str(palpate.follow_tool(
        CUBIC, ISOVALUE, palpate.Tool.named("sphere:1", 1.0), HIPS, numpy.tile([0, 0, 0, 1.0], (3, 1)), **k))),
    ("scene", "type", "float32", lambda **k: samples(palpate.scene("sphere:9x9x9", **k).volume)),
    ("scene", "geometry", VOLUME.geometry, lambda **k: palpate.scene("sphere", **k).volume.array.shape),
    ("motion", "settings", palpate.MotionSettings(rate_hz=100), lambda **k: len(palpate.motion("press", CUBIC, ISOVALUE, **k)[0])),
    ("load", "spacing", (2, 2, 2), lambda **k: grid(palpate.load("v.nrrd", **k).volume)),
    ("load", "orientation", "RAS", lambda **k: grid(palpate.load("v.nrrd", **k).volume)),
    ("load", "raw", palpate.RawLayout(size=(8, 16, 32), type="uint8"), lambda **k: palpate.load("v.bin", **k).volume.array.shape),
    ("load", "frame", 1, lambda **k: palpate.load("synthetic:beating:9x9x9", **k).volume.array.tobytes()),
    ("load", "smooth", 1, lambda **k: samples(palpate.load("v.nrrd", **k).volume)),
    ("load", "dequantize", 1, lambda **k: samples(palpate.load("v.nrrd", **k).volume)),
    ("load", "prefilter", True, lambda **k: samples(palpate.load("v.nrrd", **k).volume)),
    ("write", "compress", True, lambda **k: (palpate.write(VOLUME, "c.nrrd", **k), os.path.getsize("c.nrrd"))[1]),
    ("open_store", "raw", palpate.RawLayout(size=(8, 16, 32), type="uint8"), lambda **k: palpate.open_store("v.bin", **k).levels[0].size.tolist()),
    ("open_store", "spacing", (2, 2, 2), lambda **k: palpate.open_store("v.nrrd", **k).levels[0].spacing.tolist()),
    ("open_store", "orientation", "RAS", lambda **k: palpate.open_store("v.nrrd", **k).levels[0].direction.tolist()),
]

@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    palpate.write(VOLUME, "v.nrrd")
    (tmp_path / "v.bin").write_bytes(VOLUME.array.tobytes())


def outcome(call, **keywords):
    try:
        return call(**keywords)
    except ValueError as refused:
        return str(refused)


@pytest.mark.parametrize("function, name, value, call", DATA, ids=[f"{one[0]}.{one[1]}" for one in DATA])
def test_an_argument_changes_the_result(function, name, value, call):
    assert outcome(call) == outcome(call), "it is not repeatable"
    assert outcome(call) != outcome(call, **{name: value})


def optional_arguments(owner, title):
    for name, one in list(vars(owner).items()):
        if name.startswith("_") and name != "__init__":
            continue
        function = one.__func__ if isinstance(one, staticmethod) else one
        if inspect.ismodule(one):
            yield from optional_arguments(one, f"{title}{name}.")
        elif isinstance(one, type) and one.__module__.startswith("palpate._palpate"):
            yield from optional_arguments(one, f"{title}{one.__name__}.")
        elif inspect.isfunction(function) and hasattr(function, "__wrapped__"):
            for parameters in arguments.signatures(function.__wrapped__):
                yield from ((f"{title}{name}", parameter.name) for parameter in parameters if not parameter.required)


def test_no_argument_is_forgotten():
    found = set(optional_arguments(palpate._palpate, ""))
    known = {one[:2] for one in DATA} | {tuple(text.split()) for text in ELSEWHERE}
    for text, file in ELSEWHERE.items():
        assert f"{text.split()[1]}=" in (pathlib.Path(__file__).parent / f"{file}_test.py").read_text(encoding="utf-8"), text
    assert len(found) > 60 and sorted(known - found) == []
    forgotten = sorted(f"{function} {name}" for function, name in found - known if name not in OTHERS and function != "streaming_stroke")
    assert forgotten == []


def played(**setup):
    return palpate.replay(CUBIC, ISOVALUE, TIMES, HIPS, **setup)


def run(**setup):
    return palpate.Run(VOLUME, palpate.Setup(real_time=False, **setup))


def sent(*commands, field=CUBIC):
    with palpate.Servo(palpate.Renderer(field, ISOVALUE), Still(), real_time=False) as servo:
        for command in commands:
            servo.send(command)


def sent_live(command):
    with run() as running:
        running.send(command)


LAYER = palpate.Layer(name="a", level=ISOVALUE)
RAW = palpate.RawLayout(size=(16, 16, 16), type="uint8")
USELESS = [
    (lambda: palpate.load("v.nrrd", series="2"), "series does nothing: v.nrrd is not a DICOM series"),
    (lambda: palpate.load("v.nrrd", frame_interval=0.1), "frame_interval does nothing: v.nrrd is not a sequence"),
    (lambda: palpate.load("v.nrrd", frame_interval=0.1, series="2"), "frame_interval does nothing: v.nrrd is not a sequence"),
    (lambda: palpate.load("synthetic:beating:9x9x9", frame=1, frame_interval=0.1),
     "frame_interval does nothing: synthetic:beating:9x9x9: a single frame of it is no sequence"),
    (lambda: palpate.open_store("v.nrrd", cache="kept"), "cache does nothing: v.nrrd is on this machine"),
    (lambda: palpate.open_store("v.nrrd", cache="kept", forbidden_is_missing=True),
     "cache, forbidden_is_missing do nothing: v.nrrd is on this machine"),
    (lambda: in_zarr(raw=RAW), "raw does nothing: v.zarr describes its own samples"),
    (lambda: palpate.write(VOLUME, "v.raw", compress=True), "compress does nothing: .raw is never compressed: name it .nrrd"),
    (lambda: palpate.write(VOLUME, "v.nii", compress=True), "compress does nothing: .nii is never compressed: name it .nii.gz"),
    (lambda: palpate.extract(LINEAR, ISOVALUE, tolerance=0.1), "tolerance does nothing: the facets of the linear field are exact"),
    (lambda: palpate.extract(LINEAR, ISOVALUE, normals=True),
     "normals does nothing: those of the linear field are the normals of the facets"),
    (lambda: palpate.Samples([(0.0, VOLUME)], period=2.0), "period does nothing: a single frame does not repeat"),
    (lambda: palpate.Samples(VOLUME).volume(2.0), "time does nothing: these samples are not a sequence"),
    (lambda: followed(scale=2.0), "scale does nothing: it is for the threshold of a penetrability"),
    (lambda: palpate.command.UseLayers(None, same_surfaces=True), "same_surfaces does nothing: there are no layers"),
    (lambda: sent(palpate.command.Speed(2)), "Speed does nothing: these samples are not a sequence"),
    (lambda: sent(palpate.command.Moment(2)), "Moment does nothing: these samples are not a sequence"),
    (lambda: sent_live(palpate.command.Speed(2)), "this volume is no sequence: there is nothing to play"),
    (lambda: sent_live(palpate.command.Moment(2)), "this volume is no sequence: there is nothing to play"),
    (lambda: palpate.Run(VOLUME, device_rate=5.0), "device_rate does nothing: there is no device in Python"),
    (lambda: palpate.Run(VOLUME, palpate.Setup(device="mouse"), device=Still()), "Setup.device does nothing: the device in Python is used"),
    (lambda: run(isovalue=ISOVALUE, render=palpate.RenderSetup(penetrability=palpate.Penetrability(ranges=[(50, 90)]))),
     "isovalue does nothing: each range has levels of its own"),
    (lambda: run(isovalue=ISOVALUE, render=palpate.RenderSetup(penetrability=palpate.Penetrability(minimum=90))),
     "isovalue does nothing: the levels begin at the minimum"),
]
SETTINGS = [
    (dict(tool_spacing=1.0), "tool_spacing does nothing: a point has no size: choose another tool"),
    (dict(tool_spacing=1.0, tool=palpate.Tool([[0, 0, 0], [1, 0, 0]])), "tool_spacing does nothing: the points of this tool are given"),
    (dict(force=palpate.ForceSettings(magnet=palpate.Magnet(peak=1))), "magnet does nothing: its distance is 0"),
    (dict(force=palpate.ForceSettings(magnet=palpate.Magnet(distance=1))), "magnet does nothing: its peak is 0"),
    (dict(force=palpate.ForceSettings(texture=palpate.Texture(wavelength=1))), "texture does nothing: its amplitude is 0"),
    (dict(penetrability=palpate.Penetrability(minimum=1, ranges=[(50, 90)])), "minimum does nothing: each range has levels of its own"),
    (dict(layers=palpate.Layers(layers=[LAYER], closing=2)), "closing does nothing: no layer has a puncture force, so none gives way"),
]
IN_REPLAY = [(dict(force=palpate.ForceSettings(**{name: 0.5})), f"{name} does nothing: a point does not turn: choose another tool")
             for name in ("rotational_stiffness", "rotational_damping", "torque_limit", "torque_rate_limit")]
IN_REPLAY += [(dict(force=palpate.ForceSettings(stale_after=1)), "stale_after does nothing: no time between two positions counts as a pause")]


@pytest.mark.parametrize("call, text", USELESS, ids=[one[1] for one in USELESS])
def test_an_argument_that_changes_nothing_is_refused_in_one_line(call, text):
    with pytest.raises(ValueError) as refused:
        call()
    assert str(refused.value) == text


@pytest.mark.parametrize("setup, text", SETTINGS, ids=[one[1] for one in SETTINGS])
def test_a_setting_that_changes_nothing_is_refused_by_all_that_render(setup, text):
    for render in (played, lambda **k: palpate.Renderer(CUBIC, ISOVALUE, palpate.RenderSetup(**k)),
                   lambda **k: run(render=palpate.RenderSetup(**k))):
        with pytest.raises(ValueError) as refused:
            render(**setup)
        assert str(refused.value) == text


@pytest.mark.parametrize("setup, text", IN_REPLAY, ids=[one[1] for one in IN_REPLAY])
def test_a_setting_that_changes_nothing_in_a_replay_is_refused_there_alone(setup, text):
    with pytest.raises(ValueError) as refused:
        played(**setup)
    assert str(refused.value) == text
    palpate.Renderer(CUBIC, ISOVALUE, palpate.RenderSetup(**setup))  # a session may use another tool, and pause


def test_samples_that_become_a_sequence_may_be_played():
    frames = palpate.Samples([(0.0, VOLUME), (1.0, OTHER)])
    commands = palpate.command.Moment(0.5), palpate.command.Speed(2)
    sent(palpate.command.Samples(frames), *commands, field=palpate.Field(VOLUME))
    sent(*commands, field=palpate.Field(frames))
    with pytest.raises(ValueError, match="^Speed does nothing"):
        sent(palpate.command.Samples(palpate.Samples(VOLUME)), commands[1], field=palpate.Field(frames))


def test_settings_that_change_something_are_not_refused():
    for setup in (dict(tool="sphere:1", tool_spacing=0.5, force=palpate.ForceSettings(torque_limit=7, rotational_damping=0.01)),
                  dict(layers=palpate.Layers(layers=STEEP.layers, closing=2)), dict(friction=palpate.Friction(static_coefficient=0.2)),
                  dict(force=palpate.ForceSettings(magnet=palpate.Magnet(distance=2, peak=0.1))),
                  dict(penetrability=palpate.Penetrability(minimum=90))):
        played(**setup)
    first, second = palpate.RenderSetup(), palpate.RenderSetup()
    first.force.magnet.peak = 0.1  # alone it changes nothing, but more follows
    first.force.magnet.distance = 2
    second.tool_spacing = 0.5
    second.tool = "sphere:1"
    for setup in (first, second):
        palpate.replay(CUBIC, ISOVALUE, TIMES, HIPS, setup=setup)
