"""Ctrl-C while a call waits for the other end of a pipe: it ends with KeyboardInterrupt, and with no other error."""

import fcntl
import os
import pathlib
import signal
import struct
import subprocess
import sys
import termios
import threading

import numpy
import palpate
import pytest

import live_test

HEAD = """
import sys
import palpate
path = sys.argv[1]
volume = palpate.scene("sphere:12x12x12").volume
field = palpate.Field(volume)
"""
RUN = "palpate.Run(volume, palpate.Setup(isovalue=100, real_time=False, %s))"
MOTION = "palpate.replay(field, 100, *palpate.motion('slide', field, 100))"
READING = {
    "trajectory.csv": "palpate.read_trajectory(path)",
    "trace.csv": "palpate.read_trace(path)",
    "recording.csv": "palpate.read_recording(path)",
    "validated.csv": "palpate.validate(path)",
    "device.csv": RUN % "device='recorded:' + path",
    "layers.json": "palpate.layers_named(path)",
    "renderer.json": "palpate.Renderer(field, 100, palpate.RenderSetup(layers=path))",
    "run.json": RUN % "render=palpate.RenderSetup(layers=path)",
    "tool.csv": RUN % "render=palpate.RenderSetup(tool=path)",
    "replay.csv": "palpate.Renderer(field, 100, palpate.RenderSetup(tool=path))"}
EDITED = "run = " + RUN % "" + "; run.edit(palpate.Fill([1, 1, 1], [2, 2, 2], 80)); run.save(path)"
WRITING = {
    "trace.csv": MOTION + ".write(path)",
    "layers.json": "layers = palpate.layers_named('ct-needle'); layers.about = 'x' * 99999; layers.write(path)",
    "mesh.stl": "palpate.extract(field, 100).write(path)",
    "volume.nrrd": "palpate.write(palpate.scene('noise:32x32x32').volume, path)",
    "edited.nrrd": EDITED.replace("volume,", "palpate.scene('noise:32x32x32').volume,")}


class Call:
    """A process in which a call with a pipe is under way."""

    def __init__(self, call, path):
        program = HEAD + "print('go', flush=True)\ntry:\n    " + call + """
except BaseException as error:
    caught = error
print(repr(caught))
"""
        # Without the warning that edits are kept, which are in the test's folder then.
        self.process = subprocess.Popen([sys.executable, "-B", "-W", "ignore", "-c", program, path], text=True,
                                        env={**os.environ, "TMPDIR": str(path.parent)}, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT)
        assert self.process.stdout.readline() == "go\n"

    def has_ended(self):
        return self.process.poll() is not None

    def is_sleeping(self):
        """Its main thread is. A call that only computes never sleeps."""
        return pathlib.Path(f"/proc/{self.process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0] == "S"

    def is_interrupted(self):
        self.process.send_signal(signal.SIGINT)
        try:
            return self.process.communicate()[0] == "KeyboardInterrupt()\n"
        finally:
            self.process.kill()


def pipe_in(folder, name):
    path = folder / name
    os.mkfifo(path)
    return path


def writer_of(path):
    """Opens a pipe for writing if another process has opened it for reading, and is None otherwise."""
    try:
        return os.open(path, os.O_WRONLY | os.O_NONBLOCK)
    except OSError:
        return None


@pytest.mark.parametrize("name", READING)
def test_ctrl_c_ends_the_wait_for_a_writer_that_writes_nothing(tmp_path, name):
    path = pipe_in(tmp_path, name)
    call = Call(READING[name], path)
    writers = []
    live_test.until(lambda: call.has_ended() or writers.append(writer_of(path)) or writers[-1])
    assert call.is_interrupted()


@pytest.mark.parametrize("name", WRITING)
def test_ctrl_c_ends_the_wait_for_a_reader(tmp_path, name):
    call = Call(WRITING[name], pipe_in(tmp_path, name))
    live_test.until(lambda: call.has_ended() or call.is_sleeping())
    assert call.is_interrupted()


@pytest.mark.parametrize("name", WRITING)
def test_ctrl_c_ends_the_wait_for_a_reader_that_does_not_read_on(tmp_path, name):
    path = pipe_in(tmp_path, name)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    room = fcntl.fcntl(reader, 1031, 1)  # F_SETPIPE_SZ, in bytes: a page at least
    call = Call(WRITING[name], path)

    def is_full():
        return struct.unpack("i", fcntl.ioctl(reader, termios.FIONREAD, bytes(4)))[0] == room
    live_test.until(lambda: call.has_ended() or (is_full() and call.is_sleeping()))
    assert call.is_interrupted()
    os.close(reader)


def read_through_pipe(path, read):
    pipe = pipe_in(path.parent, path.stem + "_pipe.csv")
    writer = threading.Thread(target=lambda: pipe.write_bytes(path.read_bytes()))
    writer.start()
    try:
        return read(pipe)
    finally:
        writer.join()


def test_a_trace_of_a_tool_is_read_through_a_pipe(tmp_path):
    field = palpate.Field(palpate.scene("sphere:12x12x12").volume)
    trace = palpate.replay(field, 100, *palpate.motion("slide", field, 100), tool="sphere:1")
    trace.write(tmp_path / "trace.csv")
    again = read_through_pipe(tmp_path / "trace.csv", palpate.read_trace)
    assert again.has_tool and numpy.array_equal(again.torque, trace.torque)


def test_both_hands_of_a_recording_are_validated_through_a_pipe(tmp_path):
    setup = palpate.Setup(real_time=False)
    left = palpate.Run(palpate.load("synthetic:torus:12x12x12"), setup)
    right = palpate.Run(left, setup)
    palpate.record_together([left, right], tmp_path / "both.csv")
    with left, right:
        live_test.until(lambda: all(run.snapshot() and run.snapshot().number > 20 for run in (left, right)))
        left.stop_recording()
        right.stop_recording()
    told = read_through_pipe(tmp_path / "both.csv", palpate.validate)
    assert told == palpate.validate(tmp_path / "both.csv") and told["complete"]
