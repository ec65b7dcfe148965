"""Live sessions from Python: devices in Python, runs, edits, recordings, and a hogged GIL."""

import ctypes
import os
import re
import subprocess
import sys
import threading
import time

import numpy
import pytest

import palpate


class Still:
    """A device that stands still, above or inside the sphere."""

    def __init__(self, height):
        self.height = height
        self.opening = None
        self.forces = []
        self.threads = set()
        self.closed = False

    def info(self):
        return palpate.DeviceInfo(name="still")

    def read(self):
        self.threads.add(threading.get_ident())
        return palpate.DeviceReading(position=(0, 0, self.height), status="ready", opening=self.opening)

    def write(self, force, torque):
        self.forces.append(numpy.array(force))

    def close(self):
        self.closed = True


def renderer(**force):
    scene = palpate.scene("sphere:40x40x40", "float32")
    setup = palpate.RenderSetup(force=palpate.ForceSettings(ramp=0.01, **force))
    return palpate.Renderer(palpate.Field(scene.volume), scene.isovalue, setup)


def surface_height():
    scene = palpate.scene("sphere:40x40x40", "float32")
    field = palpate.Field(scene.volume)
    return field.cast_ray(scene.isovalue, (0, 0, 30), (0, 0, 0))[0][2]


def until(condition, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "did not happen"
        time.sleep(0.005)


def test_a_device_in_python_is_asked_on_a_thread_of_its_own_and_feels_the_force():
    device = Still(surface_height() + 1)
    servo = palpate.Servo(renderer(), device, real_time=False)
    with servo:
        until(lambda: servo.snapshot() and servo.snapshot().device.status == "ready")
        assert servo.snapshot().device.opening is None
        device.opening = 0.25
        until(lambda: servo.snapshot().device.opening == 0.25)
        device.height -= 1.5  # half a millimetre inside
        until(lambda: any(force[2] > 0.2 for force in list(device.forces)))
        snapshot = servo.snapshot()
        assert snapshot.tick.mode == "constrained"
        assert snapshot.normal[2] == pytest.approx(1, abs=1e-3)
        servo.send(palpate.command.Forces(False))
        until(lambda: not numpy.any(servo.snapshot().tick.force))
    assert len(device.threads) == 1 and threading.get_ident() not in device.threads
    assert device.closed and not numpy.any(device.forces[-1])


def test_a_run_takes_a_device_in_python_too_and_records_it(tmp_path):
    device = Still(60)
    loaded = palpate.load("synthetic:sphere:40x40x40")
    run = palpate.Run(loaded, palpate.Setup(real_time=False), device=device)
    run.record(tmp_path / "hand.csv")
    with run:
        until(lambda: run.snapshot() and run.snapshot().device.status == "ready")
        assert run.device.name == "still"
        device.read = lambda: None
        until(lambda: "read() has to return a DeviceReading" in run.problem)
    assert device.closed and not numpy.any(device.forces[-1])
    assert run.stop_recording() > 0
    assert palpate.read_recording(tmp_path / "hand.csv").head["device"].startswith("still")


def test_a_run_that_cannot_begin_lets_go_of_its_device_in_python():
    device = Still(60)
    with pytest.raises(ValueError):
        palpate.Run(palpate.load("synthetic:sphere:8x8x8"), palpate.Setup(isovalue=-numpy.inf), device=device)
    assert device.closed
    with pytest.raises(TypeError, match="needs the functions info"):
        palpate.Run(palpate.load("synthetic:sphere:8x8x8"), device=object())


def test_a_run_whose_device_hangs_ends_with_a_zero_and_says_so():
    hung, goes_on = threading.Event(), threading.Event()

    class Hanging(Still):
        hangs = False

        def read(self):
            if self.hangs:
                hung.set()
                goes_on.wait()
            return super().read()

    device = Hanging(60)
    run = palpate.Run(palpate.load("synthetic:sphere:8x8x8"), palpate.Setup(real_time=False), device=device)
    run.start()
    until(lambda: run.snapshot() and run.snapshot().device.status == "ready")
    device.hangs = True
    until(hung.is_set)
    with pytest.raises(palpate.DeviceError, match="does not return, and a force of zero was written: the session"):
        run.stop()
    assert not numpy.any(device.forces[-1])
    goes_on.set()
    until(lambda: device.closed)
    run.stop()


def raising(reading):
    raise RuntimeError("cable pulled")


def raising_without_a_word(reading):
    raise TimeoutError


WRONG = {"raised RuntimeError: cable pulled": raising, "raised TimeoutError$": raising_without_a_word, "DeviceReading, not None": lambda reading: None,
         r"DeviceReading, not \(1, 2, 3\)": lambda reading: (1, 2, 3),
         "raised ValueError: position = nan: must be finite": lambda reading: palpate.DeviceReading(position=(0, numpy.nan, 0), status="ready")}


@pytest.mark.parametrize("message", WRONG)
def test_a_device_whose_read_goes_wrong_has_no_force_says_why_and_comes_back(message):
    class Flaky(Still):
        wrong = False

        def read(self):
            return WRONG[message](None) if self.wrong else super().read()

    device = Flaky(surface_height() - 0.5)
    with palpate.Servo(renderer(), device, real_time=False) as servo:
        until(lambda: servo.snapshot() and servo.snapshot().tick.force[2] > 0.1)
        device.wrong = True
        until(lambda: servo.snapshot().device.status == "fault")
        until(lambda: not numpy.any(servo.snapshot().tick.force) and not numpy.any(device.forces[-1]))
        assert re.search(f"read.*{message}", servo.device_problem)
        assert "\n" not in servo.device_problem
        device.wrong = False
        until(lambda: servo.snapshot().tick.force[2] > 0.1)
        until(lambda: servo.device_problem == "" and device.forces[-1][2] > 0.1)
    assert device.closed and not numpy.any(device.forces[-1])


def test_the_problem_of_a_device_is_told_with_its_fault():
    class Flaky(Still):
        said = None

        def read(self):
            raise RuntimeError("cable pulled")

        def write(self, force, torque):  # the servo may have seen the fault by now
            self.said = self.said or [servo.device_problem]

    device = Flaky(60)
    servo = palpate.Servo(renderer(), device, real_time=False)
    with servo:
        until(lambda: device.said)
    assert "cable pulled" in device.said[0]


def test_a_device_whose_write_raises_is_tried_with_zero_and_closed():
    class Stuck(Still):
        tried = ()

        def write(self, force, torque):
            if len(self.forces) > 20 and numpy.any(force):
                self.wrong = True
            self.tried += (numpy.array(force),)
            if getattr(self, "wrong", False):
                raise OSError("bus off")
            super().write(force, torque)

    device = Stuck(surface_height() - 0.5)
    with palpate.Servo(renderer(), device, real_time=False) as servo:
        until(lambda: "write() raised OSError: bus off" in servo.device_problem)
        until(lambda: not numpy.any(servo.snapshot().tick.force) and not numpy.any(device.tried[-1]))
        device.wrong = False
        until(lambda: device.wrong)  # there was force again
    assert device.closed and not numpy.any(device.tried[-1])


def test_a_program_that_ends_without_stopping_writes_zero_and_closes_the_device():
    program = """
import sys, time
sys.path.insert(0, sys.argv[1])
import live_test, palpate
class Told(live_test.Still):
    def close(self):
        print("closed", not self.forces[-1].any(), max(f[2] for f in self.forces) > 0.1)
servo = palpate.Servo(live_test.renderer(), Told(live_test.surface_height() - 0.5), real_time=False)
servo.start()
live_test.until(lambda: servo.snapshot() and servo.snapshot().tick.force[2] > 0.2)
live_test.until(lambda: servo.snapshot().number > 200)
run = palpate.Run(palpate.load("synthetic:sphere:16x16x16"), palpate.Setup(real_time=False))
run.start()
"""
    ran = subprocess.run([sys.executable, "-B", "-c", program, os.path.dirname(__file__)],
                         stdout=subprocess.PIPE, text=True, check=True)
    assert ran.stdout.strip() == "closed True True"


def run_with(device):
    return palpate.Run(palpate.load("synthetic:sphere:16x16x16"), palpate.Setup(real_time=False), device=device)


@pytest.mark.parametrize("session", [lambda device: palpate.Servo(renderer(), device, real_time=False), run_with])
def test_a_device_may_stop_its_own_session(session):
    class Tired(Still):
        started = threading.Event()  # read() is called before the session starts, too

        def read(self):
            if self.started.is_set():
                self.session.stop()
            return super().read()

    device = Tired(50)
    device.session = session(device)
    device.session.start()
    device.started.set()
    until(lambda: device.closed)
    device.session.stop()
    del device.session


def test_objects_that_are_no_device_are_refused():
    with pytest.raises(TypeError, match=r"info\(\) and read\(\)"):
        palpate.Servo(renderer(), object())
    confused = Still(50)
    confused.info = lambda: "a robot"
    with pytest.raises(ValueError, match=r"info\(\) has to return a DeviceInfo, not 'a robot'"):
        palpate.Servo(renderer(), confused)
    servo = palpate.Servo(renderer(), Still(50), real_time=False)
    with pytest.raises(ValueError, match="isovalue"):
        servo.send(palpate.command.Isovalue(numpy.nan))
    with pytest.raises(TypeError):
        servo.send("stop")


def with_the_gil(condition, at_most_ms=120_000):
    """Waits for something without ever releasing the GIL: a PyDLL call does not, and no other Python
    thread gets its turn."""
    libc = ctypes.PyDLL(None)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e6)
    try:
        return any(condition() or libc.usleep(1000) for _ in range(at_most_ms))
    finally:
        sys.setswitchinterval(interval)


def test_the_servo_ticks_on_while_a_python_thread_holds_the_gil():
    device = Still(surface_height() + 5)
    servo = palpate.Servo(renderer(), device)
    with servo:
        until(lambda: servo.snapshot() and servo.snapshot().number > 50)
        at_last_write = {}

        def has_ticked():
            """1000 ticks since the device's thread had the GIL for the last time."""
            now = servo.snapshot().number
            return now > at_last_write.setdefault(len(device.forces), now) + 1000

        # A servo that needed the GIL would stand still.
        assert with_the_gil(has_ticked)


def test_after_a_single_failure_the_force_begins_with_the_ramp():
    class Once(Still):
        fails, times = False, []

        def read(self):
            if self.fails:
                self.fails, self.failed_at, self.failed_on = False, time.monotonic(), len(self.forces)
                raise RuntimeError("once")
            return super().read()

        def write(self, force, torque):
            super().write(force, torque)
            self.times.append(time.monotonic())

    device = Once(surface_height() - 0.5)
    servo = palpate.Servo(renderer(), device, device_rate=4000)  # the servo sees a part of its readings
    with servo:
        until(lambda: servo.snapshot() and servo.snapshot().tick.force[2] > 0.2)
        device.fails = True
        until(lambda: not device.fails and len(device.forces) > device.failed_on + 40)
        # There is none that was written within 10 ms, however many writes these were.
        after = list(zip(device.times, device.forces))[device.failed_on:]
        assert not any(numpy.any(force) for at, force in after if at < device.failed_at + 0.01)
        assert not numpy.any(after[0][1])
        until(lambda: servo.snapshot().tick.force[2] > 0.2)  # and it comes back


def test_while_python_does_not_come_back_to_a_device_there_is_no_force():
    device = Still(surface_height() - 0.5)
    servo = palpate.Servo(renderer(), device, real_time=False)
    with servo:
        until(lambda: servo.snapshot() and servo.snapshot().tick.force[2] > 0.1)
        at_last_write = {}

        def has_let_go():
            """In a tick that began after the device's thread had the GIL for the last time. At the first looks it may still be about to get it."""
            snapshot = servo.snapshot()
            begun = at_last_write.setdefault(len(device.forces), snapshot.number)
            return snapshot.number > begun + 1 and snapshot.device.status == "stale" and not numpy.any(snapshot.tick.force)

        assert with_the_gil(has_let_go)
        before = max(at_last_write)
        until(lambda: len(device.forces) > before + 2)
        # The first force after the silence is that of a session that let go. One write may have been
        # under way when the silence began.
        first = [numpy.linalg.norm(force) for force in device.forces[before:before + 2]]
        assert min(first) == 0
        until(lambda: servo.snapshot().tick.force[2] > 0.1)  # and it comes back


def test_a_run_with_the_simulated_device_records_what_validates(tmp_path):
    loaded = palpate.load("synthetic:torus:32x32x32")
    friction = palpate.Friction(static_coefficient=0.3, dynamic_coefficient=0.2)
    run = palpate.Run(loaded, palpate.Setup(real_time=False, device="simulated", render=palpate.RenderSetup(friction=friction)))
    run.record(tmp_path / "session.csv")
    with run:
        until(lambda: run.snapshot() and run.snapshot().number > 300)
        run.send(palpate.command.Isovalue(0.4))
        until(lambda: run.snapshot().tick.isovalue == 0.4)
        assert run.report().ticks > 300
    assert run.stop_recording() > 300
    told = palpate.validate(tmp_path / "session.csv")
    assert told["ticks"] > 300 and told["complete"] and told["commands"] >= 1
    recording = palpate.read_recording(tmp_path / "session.csv")
    assert len(recording.trace) == told["ticks"] and recording.complete
    assert recording.head["isovalue"] == loaded.isovalue and recording.head["friction"] == friction
    text = (tmp_path / "session.csv").read_text()
    (tmp_path / "changed.csv").write_text(text.replace("free", "constrained", 3))
    with pytest.raises(palpate.InputError, match="changed.csv"):
        palpate.validate(tmp_path / "changed.csv")
    with pytest.raises(palpate.OutputError):
        palpate.Run(loaded, palpate.Setup(real_time=False)).record(tmp_path / "session.csv") or \
            pytest.fail("an existing file was replaced")


def test_two_runs_on_the_same_data_are_two_hands_in_one_recording(tmp_path):
    left = palpate.Run(palpate.load("synthetic:torus:32x32x32"),
                       palpate.Setup(real_time=False, device="simulated:hand=hold"))
    right = palpate.Run(left, palpate.Setup(real_time=False, device="simulated:omega6,hand=circle"))
    path = tmp_path / "both.csv"
    palpate.record_together([left, right], path)
    with left, right:
        until(lambda: all(run.snapshot() and run.snapshot().number > 200 for run in (left, right)))
        left.edit(palpate.Fill((0, 0, 0), (3, 3, 3), 100))
        until(lambda: all(run.snapshot().version == 1 for run in (left, right)))
        assert left.stop_recording() > 200
        assert right.stop_recording() > 200
    hands = [palpate.read_recording(path, hand) for hand in (1, 2)]
    assert [hand.hands for hand in hands] == [2, 2]
    assert "omega" in hands[1].head["device"] and "omega" not in hands[0].head["device"]
    told = palpate.validate(path)
    assert told["complete"] and told["ticks"] == sum(len(hand.trace) for hand in hands)
    with pytest.raises(palpate.InputError, match="no hand 3"):
        palpate.read_recording(path, 3)
    with pytest.raises(ValueError, match="same data"):
        alone = palpate.Run(palpate.load("synthetic:torus:32x32x32"), palpate.Setup(real_time=False))
        palpate.record_together([alone, left], tmp_path / "more.csv")


def test_a_limit_that_was_set_in_the_setup_is_the_limit_of_the_run(tmp_path):
    setup = palpate.Setup(isovalue=0.3, device="simulated:touchx,hand=press,depth=4", real_time=False)
    setup.render.force.limit = 0.5
    run = palpate.Run(palpate.scene("sphere:40x40x40", "float32").volume, setup)
    run.record(tmp_path / "session.csv")
    with run:
        until(lambda: run.snapshot() and numpy.linalg.norm(run.snapshot().tick.force) > 0.49)
    run.stop_recording()
    recording = palpate.read_recording(tmp_path / "session.csv")
    assert recording.head["force"].limit == 0.5
    assert numpy.linalg.norm(recording.trace.force, axis=1).max() <= 0.5 + 1e-12


def test_a_numpy_array_is_felt_edited_and_recorded(tmp_path):
    array = numpy.ascontiguousarray(palpate.scene("sphere:32x32x32", "float32").volume.array)
    place = {"origin": (-15.5, -15.5, -15.5)}
    volume = palpate.Volume(array, **place)
    name = tmp_path / "ball.mha"
    run = palpate.Run(palpate.LoadedVolume(volume, str(name)),
                      palpate.Setup(isovalue=0.5, real_time=False))
    run.record(tmp_path / "ball.csv")
    with run:
        run.edit(palpate.Fill((0, 0, 0), (3, 3, 3), 0))
        until(lambda: run.snapshot() and run.snapshot().number > 100)
    assert palpate.read_recording(tmp_path / "ball.csv").complete  # the end of the run ends it
    assert run.stop_recording() > 100 and run.stop_recording() == 0
    del run
    palpate.write(palpate.Volume(array, **place), name)
    assert palpate.validate(tmp_path / "ball.csv")["complete"]
    with palpate.Run(volume, palpate.Setup(isovalue="50%", real_time=False)) as other:
        until(lambda: other.snapshot() is not None)


def test_an_edit_of_a_run_is_felt_and_undone():
    loaded = palpate.load("synthetic:sphere:32x32x32")
    with palpate.Run(loaded, palpate.Setup(real_time=False)) as run:
        centre = run.field().geometry.centre
        inside = run.field().value([centre])[0]
        brush = palpate.brush_for("carve", run.field(), loaded.isovalue, 6)
        run.edit(palpate.Stroke(brush, centre, centre))
        assert run.field().value([centre])[0] < inside
        until(lambda: run.snapshot() and run.snapshot().version > 0)
        assert run.undo() and not run.undo()
        assert run.field().value([centre])[0] == inside
        with pytest.raises(ValueError):
            run.edit(palpate.Fill((0, 0, 0), (1, 1, 1), numpy.nan))


def test_a_device_that_is_not_there_is_a_device_error_or_a_value_error():
    loaded = palpate.load("synthetic:sphere:16x16x16")
    with pytest.raises(ValueError, match="simulated"):
        palpate.Run(loaded, palpate.Setup(device="lever"))
    names = [found["name"] for found in palpate.find_devices()]
    assert "simulated" in names and "haply" in names


def test_an_editor_changes_the_box_it_names_and_undoes_it():
    volume = palpate.Volume(numpy.zeros((20, 20, 20), "uint8"))
    editor = palpate.Editor(volume)
    low, high = editor.apply(palpate.Fill((2, 3, 4), (5, 6, 7), 9))
    assert list(low) == [2, 3, 4] and list(high) == [5, 6, 7]
    array = editor.samples.volume().array
    assert (array[4:8, 3:7, 2:6] == 9).all() and array.sum() == 9 * 64
    assert not volume.array.any()
    assert editor.undo() and not editor.samples.volume().array.any()
    assert editor.undo() is None and editor.redo()
    patch = palpate.Volume(numpy.full((2, 2, 2), 200, "uint8"))
    editor.apply(palpate.Replace((0, 0, 0), patch))
    assert (editor.samples.volume().array[:2, :2, :2] == 200).all()


def test_frames_pushed_from_a_python_thread_are_felt():
    device = Still(50)
    field = palpate.Field(palpate.Samples(palpate.Volume(numpy.zeros((24, 24, 24), "float32"))))
    servo = palpate.Servo(palpate.Renderer(field, 0.5), device, real_time=False)

    def simulate():
        for version in range(1, 6):
            frame = palpate.Volume(numpy.full((24, 24, 24), version, "float32"))
            servo.send(palpate.command.Samples(palpate.Samples(frame), version))
            time.sleep(0.01)

    with servo:
        source = threading.Thread(target=simulate)
        source.start()
        until(lambda: servo.snapshot() and servo.snapshot().version == 5)
        source.join()


def test_layers_that_are_the_same_surfaces_are_sent_as_such():
    layers = palpate.layers_named("ct-needle")
    assert not palpate.command.UseLayers(layers).same_surfaces
    same = palpate.command.UseLayers(layers, same_surfaces=True)
    assert same.same_surfaces
    with palpate.Servo(renderer(), Still(50), real_time=False) as servo:
        servo.send(same)


def test_a_subject_of_the_experiments_is_felt_by_each_contestant():
    for contestant in palpate.contestants():
        subject = palpate.subject("synthetic:cylinder:30x30x30@53%", contestant)
        expected = "cubic" if contestant == "smooth" else "linear"
        assert subject.field.interpolation == expected
    assert {"exact", "paper"} <= set(palpate.methods())
