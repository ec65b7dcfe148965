"""Calls that cannot be carried out are refused in a sentence: nothing crashes, and nothing is taken for
something else."""

import copy
import functools
import http.server
import json
import os
import sys
import threading

import numpy
import palpate
import pytest

from live_test import until

NAN = float("nan")


@functools.cache
def ball(kind="float32", interpolation="cubic"):
    scene = palpate.scene("sphere:24x24x24", kind)
    return palpate.Field(scene.volume, interpolation=interpolation), scene.isovalue


def live(**setup):
    field, isovalue = ball()
    return palpate.Run(field.volume, palpate.Setup(isovalue=isovalue, real_time=False, **setup))


@pytest.mark.parametrize("call", [
    lambda run: run.snapshot(), lambda run: run.report(), lambda run: run.privileges,
    lambda run: run.send(palpate.command.Freeze(True)), lambda run: (run.stop(), run.snapshot())])
def test_a_run_that_was_not_started_says_so(call):
    with pytest.raises(RuntimeError, match="was not started"):
        call(live())


def test_limits_that_a_run_cannot_raise_are_refused():
    with live() as run:
        limits = copy.copy(run.device.limits)
        run.send(limits)
        limits.maximum_force += 100
        with pytest.raises(ValueError, match="can only be lowered"):
            run.send(limits)
        limits.rate *= 0.5
        run.send(limits)


def test_limits_that_a_servo_cannot_raise_are_refused():
    class Still:
        def info(self):
            return palpate.DeviceInfo()

        def read(self):
            return palpate.DeviceReading(status="ready")

    with palpate.Servo(palpate.Renderer(*ball()), Still(), real_time=False) as servo:
        for newton, good in ((100, False), (1, True), (2, False)):
            limits = palpate.DeviceLimits(maximum_force=newton)
            if good:
                servo.send(limits)
                continue
            with pytest.raises(ValueError, match="can only be lowered"):
                servo.send(limits)


@pytest.mark.parametrize("words, setup", [
    ("penetrability does nothing with layers", dict(
        penetrability=palpate.Penetrability(), layers=palpate.Layers(layers=[palpate.Layer(name="a", level=0.5)]))),
    ("minimum does nothing: each range has", dict(penetrability=palpate.Penetrability(minimum=1, ranges=[(1, 2)]))),
    ("tool_spacing does nothing", dict(tool_spacing=1.0)),
    ("tool_spacing does nothing", dict(tool_spacing=1.0, tool=palpate.Tool([[0, 0, 0], [1, 0, 0]])))],
    ids=lambda given: next(iter(given)) if isinstance(given, dict) else given)
def test_settings_that_would_be_ignored_are_refused(words, setup):
    field, isovalue = ball()
    made = palpate.RenderSetup(**setup)
    for call in (lambda: palpate.Renderer(field, isovalue, made),
                 lambda: palpate.replay(field, isovalue, [0, 1, 2], HIPS, setup=made),
                 lambda: palpate.Run(field.volume, palpate.Setup(render=made))):
        with pytest.raises(ValueError, match=words):
            call()


@pytest.mark.parametrize("playback", [dict(speed=2), dict(loop=False), dict(memory_bytes=10**8)], ids=str)
def test_playback_is_set_by_the_first_run_on_a_sequence_only(playback):
    beating = palpate.load("synthetic:beating:16x16x16")
    setup = palpate.Setup(real_time=False, **playback)
    first = palpate.Run(beating, setup)
    (name,) = playback
    with pytest.raises(ValueError, match=f"^{name} does nothing: the run that this one shares its data with"):
        palpate.Run(first, setup)
    palpate.Run(first, palpate.Setup(real_time=False))
    with pytest.raises(ValueError, match=f"^{name} does nothing: this is no sequence"):
        live(**playback)


@pytest.mark.parametrize("rate, stiffness, good", [
    (250, 1, True), (250, 5, False), (1000, 4.9, True), (4000, 15, True), (NAN, 0.1, False), (-3, 0.1, False)])
def test_the_rate_of_the_limits_bounds_the_stiffness(rate, stiffness, good):
    def made(setup, limits):
        return palpate.Renderer(*ball(), palpate.RenderSetup(stiffness=stiffness, **setup), limits)
    if good:
        assert made({}, palpate.DeviceLimits(rate=rate)).limits.rate == rate
        assert made({"rate": rate}, None).limits.rate == rate
    else:
        with pytest.raises(ValueError):
            made({}, palpate.DeviceLimits(rate=rate))


def test_the_slower_of_device_and_loop_bounds_the_stiffness():
    stiff = palpate.RenderSetup(rate=4000, stiffness=15)
    with pytest.raises(ValueError, match="at 500 Hz to be rendered stably"):
        palpate.Renderer(*ball(), stiff, palpate.DeviceLimits(rate=500))

    class Slow:
        def info(self):
            return palpate.DeviceInfo(name="slow")

        def read(self):
            return palpate.DeviceReading(position=(0, 0, 30), status="ready")

    volume = palpate.scene("sphere:40x40x40", "float32").volume
    for stiffness in (4.9, 15):
        setup = palpate.Setup(render=palpate.RenderSetup(stiffness=stiffness, rate=4000), real_time=False)
        with pytest.raises(ValueError, match="at 100 Hz and a delay of 20.1 ms to be rendered stably"):
            palpate.Run(volume, setup, device=Slow(), device_rate=100)
        renderer = palpate.Renderer(*ball(), palpate.RenderSetup(stiffness=stiffness, rate=4000))
        with pytest.raises(ValueError, match="at 100 Hz and a delay of 20.1 ms to be rendered stably"):
            palpate.Servo(renderer, Slow(), rate=4000, device_rate=100, real_time=False)
    renderer = palpate.Renderer(*ball(), palpate.RenderSetup(rate=4000))  # the usual stiffness is lowered
    with palpate.Servo(renderer, Slow(), rate=4000, device_rate=100, real_time=False) as servo:
        until(servo.snapshot)
        assert servo.snapshot().stiffness == pytest.approx(2.5e-3 / (0.5 / 100 + 2 / 100 + 1e-4))


@pytest.mark.parametrize("call", ["follow", "batch_ns"])
def test_a_renderer_that_another_thread_moves_cannot_be_changed(call):
    renderer = palpate.Renderer(*ball())
    force, ticks = renderer.force, 20000
    time, position = numpy.arange(ticks) / 1000, numpy.tile([-9.0, 0, 0], (ticks, 1))
    start, done, refused = threading.Event(), threading.Event(), []

    def change():
        start.wait()
        for owner, name, value in ((renderer, "isovalue", 0.2), (renderer, "forces_on", False),
                                   (renderer, "friction", palpate.Friction()), (force, "stiffness", 0.1)):
            try:
                setattr(owner, name, value)
            except RuntimeError as error:
                refused.append(str(error))
        done.set()

    # This thread gives the GIL away in the calls only, so the other one finds it in a call.
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    try:
        thread = threading.Thread(target=change)
        thread.start()
        start.set()
        while not done.is_set():
            getattr(renderer, call)(time, position, *([100] if call == "batch_ns" else []))
    finally:
        sys.setswitchinterval(interval)
    thread.join()
    before = palpate.Renderer(*ball())
    assert len(refused) == 4 and all(call in one for one in refused)
    assert renderer.isovalue == before.isovalue and renderer.forces_on and renderer.force == before.force
    renderer.force.stiffness = 0.1
    assert renderer.copy().force.stiffness == 0.1


HIPS = numpy.array([[-15.0, 0, 0], [-9, 0, 0], [-8, 1, 0]])
TURNS = numpy.tile([0, 0, 0, 1.0], (3, 1))


def every_way(field, isovalue, hips=HIPS, turns=TURNS, method="exact", tool="sphere:2"):
    """Calls of all functions that move a proxy."""
    yield lambda: palpate.replay(field, isovalue, numpy.arange(len(hips)), hips, method=method)
    yield lambda: palpate.Proxy(field, isovalue, HIPS[0], method).follow(hips)
    yield lambda: palpate.follow_each(field, isovalue, hips, [0], method)
    yield lambda: palpate.update_times(field, isovalue, hips, [0], method)
    if method == "exact":
        yield lambda: palpate.follow_tool(field, isovalue, palpate.Tool.named(tool, 1.0), hips, turns)


@pytest.mark.parametrize("wrong", [
    dict(isovalue=NAN), dict(isovalue=-1e9), dict(method="paper"), dict(method="nothing"),
    dict(hips=HIPS * [1, NAN, 1]), dict(hips=HIPS + [0, 0, float("inf")])],
    ids=lambda wrong: next(iter(wrong)))
def test_all_functions_that_move_a_proxy_check_what_replay_checks(wrong):
    field, isovalue = ball()
    for call in every_way(field, isovalue):
        call()
    for call in every_way(**{"field": field, "isovalue": isovalue, **wrong}):
        with pytest.raises(ValueError):
            call()


def test_a_tool_is_checked_as_replay_checks_it():
    field, isovalue = ball()
    tool = palpate.Tool.named("sphere:2", 1.0)
    for turns in (0 * TURNS, TURNS * NAN, 3 * TURNS, TURNS[:2]):
        with pytest.raises(ValueError):
            palpate.replay(field, isovalue, [0, 1, 2], HIPS, orientation_xyzw=turns, tool="sphere:2")
        with pytest.raises(ValueError):
            palpate.follow_tool(field, isovalue, tool, HIPS, turns)
    linear = ball(interpolation="linear")
    with pytest.raises(ValueError):
        palpate.replay(*linear, [0, 1, 2], HIPS, tool="sphere:2")
    with pytest.raises(ValueError):
        palpate.follow_tool(*linear, tool, HIPS, TURNS)


@pytest.mark.parametrize("wrong", [
    dict(isovalue=NAN), dict(trajectories=0), dict(trajectories=-1), dict(trajectory_s=NAN), dict(speed_mm_s=0.0),
    dict(speed_mm_s=NAN), dict(touching=5.0), dict(depth_mm=-1.0)], ids=str)
def test_a_hand_that_cannot_explore_is_refused(wrong):
    field, isovalue = ball()
    given = dict(isovalue=isovalue, trajectories=1, trajectory_s=0.1)
    palpate.explore(field, **given)
    with pytest.raises(ValueError):
        palpate.explore(field, **{**given, **wrong})


def test_no_hands_are_refused_and_more_threads_than_hands_are_not_started():
    field, isovalue = ball()
    for function in (palpate.follow_each, palpate.update_times):
        for hips, first in ((numpy.zeros((0, 3)), []), (HIPS, []), (HIPS, [1])):
            with pytest.raises(ValueError):
                function(field, isovalue, hips, first)
    few, many = (palpate.follow_each(field, isovalue, HIPS, [0, 1], threads=n) for n in (1, 10**6))
    assert numpy.array_equal(few.scp, many.scp)
    with pytest.raises(ValueError):
        palpate.follow_each(field, isovalue, HIPS, [0], threads=-1)


def in_rows(at):
    return at.reshape(1, 3) if isinstance(at, numpy.ndarray) else [at]


INDICES = {
    "Fill": lambda at: palpate.Fill((0, 0, 0), at, 5.0),
    "Replace": lambda at: palpate.Replace(at, palpate.Volume(numpy.ones((1, 1, 1), "u1"))),
    "Geometry": lambda at: palpate.Geometry(size=at),
    "RawLayout": lambda at: palpate.RawLayout(size=at),
    "Mesh": lambda at: palpate.Mesh(numpy.eye(3), in_rows(at)),
    "first": lambda at: palpate.follow_each(*ball(), HIPS, at),
}


@pytest.mark.parametrize("wrong", [
    (2**33, 1, 2), (2**64, 1, 2), (0, 1.5, 2), (0, NAN, 2), (0, 1e30, 2), (0, 1j, 2), (0, None, 2), ("0", "1", "2"),
    numpy.array([0, 1, 2], "datetime64[s]"), numpy.array([0, 1, 2], object),
    numpy.ma.array([0, 1, 2], mask=[0, 1, 0]), [numpy.ma.array(0, mask=True), 1, 2]], ids=str)
@pytest.mark.parametrize("name", INDICES)
def test_an_index_is_three_whole_numbers_or_refused(name, wrong):
    call = INDICES[name]
    for good in ((0, 1, 2), [0.0, 1.0, 2.0], numpy.array([0, 1, 2], "u1"), numpy.array([0, 1, 2], "i8")):
        call(good)
    with pytest.raises((TypeError, ValueError)) as raised:
        call(wrong)
    assert "\n" not in str(raised.value) and "does not take" not in str(raised.value)


@pytest.mark.parametrize("wrong", [
    (0, 1j, 2), (0, None, 2), ("0", "1", "2"), numpy.array([0, 1, 2], "datetime64[s]"),
    numpy.ma.array([0.0, 1, 2], mask=[0, 1, 0]), [numpy.ma.array(0.0, mask=True), 1, 2]], ids=str)
@pytest.mark.parametrize("call", [
    lambda at: palpate.Stroke(palpate.Brush(), at, (1, 1, 1)),
    lambda at: palpate.Volume(numpy.ones((2, 2, 2), "u1"), origin=at),
    lambda at: palpate.Geometry(spacing=at), lambda at: ball()[0].value(in_rows(at)),
    lambda at: ball()[0].cast_ray(0.5, at, (0, 0, 0))], ids=["Stroke", "origin", "spacing", "value", "cast_ray"])
def test_a_point_is_three_numbers_or_refused(call, wrong):
    with pytest.raises((TypeError, ValueError)) as raised:
        call(wrong)
    assert "\n" not in str(raised.value) and "does not take" not in str(raised.value)


def test_the_message_says_which_numbers_are_needed():
    with pytest.raises(TypeError) as raised:
        palpate.Fill((0, 0, 0), (2**33, 1, 1), 5.0)
    assert str(raised.value) == "Fill(): high must be 3 whole numbers, not (8589934592, 1, 1)"
    with pytest.raises(TypeError, match="triangles must be an array of whole numbers from 0, not"):
        palpate.Mesh(numpy.eye(3), [[0, 1, -1]])


@pytest.mark.parametrize("end", [(NAN, 0, 0), (0, float("inf"), 0)], ids=str)
def test_a_ray_needs_two_ends_however_far(end):
    field, isovalue = ball()
    with pytest.raises(ValueError, match="finite"):
        field.cast_ray(isovalue, end, (0, 0, 0))
    with pytest.raises(ValueError, match="finite"):
        field.cast_ray(isovalue, (-20, 0, 0), end)
    near, far = (field.cast_ray(isovalue, (-x, 0, 0), (0, 0, 0)) for x in (20, 1e12))
    assert numpy.allclose(near[0], far[0], atol=1e-3)


def test_files_whose_names_are_no_text_are_read_and_told(tmp_path):
    there, missing = (os.fsencode(tmp_path) + name for name in (b"/a\xff.nrrd", b"/b\xff.nrrd"))
    palpate.write(ball()[0].volume, there)
    loaded = palpate.load(there)
    assert loaded.name == os.fsdecode(there) and repr(loaded)
    assert palpate.load(loaded.name).volume.array.shape == (24, 24, 24)
    for call in (palpate.load, palpate.read_trace, palpate.read_recording, palpate.open_store):
        with pytest.raises(palpate.InputError) as raised:
            call(missing)
        assert "b\\xff.nrrd: " in str(raised.value)
    with pytest.raises(palpate.OutputError, match=r"b\\xff"):
        palpate.write(ball()[0].volume, missing + b"/c.nrrd")


def test_what_a_message_quotes_does_not_break_its_line():
    for call in (palpate.RenderSetup, lambda tool: palpate.Tool.named(tool, 1.0)):
        with pytest.raises(ValueError, match="^the tool 'a b' is not known: [^\n]*$"):
            call(tool="a\nb")


@pytest.mark.parametrize("ending", (".ply", ".stl", ".obj", ".vtp"))
def test_a_mesh_that_a_file_cannot_hold_is_not_written(tmp_path, ending):
    file = tmp_path / f"mesh{ending}"
    for far in (NAN, float("inf")):
        with pytest.raises(ValueError, match="vertices = (nan|inf): must be finite"):
            palpate.Mesh([[0, 0, 0], [1, 0, 0], [0, far, 0]], [[0, 1, 2]])
    mesh = palpate.Mesh([[0, 0, 0], [1, 0, 0], [0, 1e300, 0]], [[0, 1, 2]])
    if ending != ".stl":
        mesh.write(file)
        assert palpate.read_mesh(file).vertices.max() == 1e300
        return
    with pytest.raises(palpate.OutputError, match="vertex 2 is"):
        mesh.write(file)
    assert not file.exists()


def test_frames_are_numbered_from_0_and_orientations_checked_before_a_file_is_read(tmp_path):
    with pytest.raises(ValueError, match="numbered from 0"):
        palpate.load("synthetic:beating:16x16x16", frame=-1)
    palpate.write(ball()[0].volume, tmp_path / "v.nrrd")
    with pytest.raises(ValueError, match="orientation XYZ: three letters"):
        palpate.load(tmp_path / "v.nrrd", orientation="XYZ")


def test_the_status_of_a_tick_says_that_it_waits_for_samples(tmp_path):
    field, isovalue = ball("uint8")
    (tmp_path / "v.zarr").mkdir()
    (tmp_path / "v.zarr/.zarray").write_text(json.dumps(
        dict(zarr_format=2, shape=[24] * 3, chunks=[24] * 3, dtype="|u1", compressor=None, fill_value=0,
             order="C", filters=None)))
    (tmp_path / "v.zarr/0.0.0").write_bytes(field.volume.array.tobytes())
    may_answer = threading.Event()

    class Handler(http.server.SimpleHTTPRequestHandler):
        def do_GET(self):
            may_answer.wait()
            super().do_GET()

        def log_message(self, *what):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=tmp_path))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        may_answer.set()
        store = palpate.open_store(f"http://127.0.0.1:{server.server_address[1]}/v.zarr", spacing=(1, 1, 1))
        loaded = palpate.LoadedVolume(store)
        may_answer.clear()
        setup = palpate.Setup(isovalue=isovalue, real_time=False, device="simulated:hand=hold,depth=2")
        with palpate.Run(loaded, setup) as run:
            until(lambda: run.snapshot() and run.snapshot().tick.status == "waiting")
            may_answer.set()
            until(lambda: run.snapshot().tick.status == "done")
    finally:
        may_answer.set()
        server.shutdown()


def test_a_proxy_that_a_call_moves_may_be_looked_at_and_copied_and_no_more():
    field, isovalue = ball()
    hips = numpy.linspace((-9.0, 0, 0), (-4.0, 0, 0), 50_000)
    proxy, again = (palpate.Proxy(field, isovalue, hips[0]) for _ in range(2))
    before, copies = proxy.scp, []

    def look(fraction):
        with pytest.raises(RuntimeError, match="^another thread moves this Proxy, in .*: wait for its end, or use a copy$"):
            proxy.follow(hips)
        assert (proxy.scp == before).all()
        copies.append(copy.copy(proxy))
        if len(copies) == 2:
            raise KeyError("stop")

    with pytest.raises(KeyError):
        proxy.follow(hips, progress=look)
    assert (proxy.scp == before).all()
    wanted = again.follow(hips).scp
    for one in (proxy, *copies):
        assert (one.follow(hips).scp == wanted).all()
