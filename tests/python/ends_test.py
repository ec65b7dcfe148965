"""Sessions that have ended, and devices of Python that cannot be."""

import os
import signal
import subprocess
import sys

import palpate
import pytest
from live_test import until

SCENE = palpate.scene("sphere:16x16x16")
FIELD = palpate.Field(SCENE.volume)


class Still:
    position = (0, 0, 0)

    def __init__(self, **info):
        self.more = info

    def info(self):
        return palpate.DeviceInfo(name="still", **self.more)

    def read(self):
        return palpate.DeviceReading(position=self.position, status="ready")


def servo(device, **render):
    return palpate.Servo(palpate.Renderer(FIELD, 100, palpate.RenderSetup(**render)), device, real_time=False)


def test_a_session_that_has_stopped_takes_no_commands(tmp_path):
    run = palpate.Run(SCENE.volume, palpate.Setup(isovalue=100, real_time=False))
    for session in (servo(Still()), run):
        with session:
            session.send(palpate.command.Isovalue(90))
        with pytest.raises(RuntimeError, match="has stopped"):
            session.send(palpate.command.Isovalue(80))
    assert run.isovalue == 90
    with pytest.raises(RuntimeError, match="has stopped"):
        run.record(tmp_path / "after.csv")
    assert not (tmp_path / "after.csv").exists()
    run.edit(palpate.Fill((0, 0, 0), (1, 1, 1), 9))  # the data goes on
    assert run.undo()


def test_a_servo_refuses_settings_that_its_device_cannot_render():
    for render in (dict(stiffness=3), dict(force=palpate.ForceSettings(damping=0.004))):
        with pytest.raises(ValueError, match="stable|must be|below"):
            servo(Still(), **render)
    with servo(Still(), stiffness=0.9):
        pass
    slow = palpate.Servo(palpate.Renderer(FIELD, 100), Still(), device_rate=200, real_time=False)  # the usual stiffness is lowered
    with slow:
        while not slow.snapshot():
            pass
        assert 0 < slow.snapshot().stiffness < 0.5


@pytest.mark.parametrize("high", [(-80, 80, 80), (-90, 80, 80)])
def test_a_device_without_room_is_refused(high):
    device = Still(workspace_high=high)
    with pytest.raises(ValueError, match="workspace_high has to be above workspace_low"):
        servo(device)
    with pytest.raises(ValueError, match="workspace_high has to be above workspace_low"):
        palpate.Run(SCENE.volume, palpate.Setup(real_time=False), device=device)
    with pytest.raises(ValueError, match="workspace_high has to be above workspace_low"):
        palpate.fit_workspace(FIELD.geometry, device.info())


def test_penetrability_begins_at_the_level_that_was_asked_for_last():
    free = Still()
    free.position = (60, 0, 0)
    with servo(free) as session:
        session.send(palpate.command.Isovalue(90))
        session.send(palpate.Penetrability(threshold=5))
        session.send(palpate.command.Freeze(True))
        while not (session.snapshot() and session.snapshot().frozen):
            pass
        assert session.snapshot().tick.isovalue == 90


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("sent", ("SIGTERM", "SIGHUP", "SIGUSR1", "SIGABRT"))
def test_a_signal_that_ends_the_program_leaves_no_force_on_a_device_of_a_servo(sent, tmp_path):
    program = """
import os, sys, time, numpy, palpate
ball = 400 - 5 * numpy.linalg.norm(numpy.indices((64, 64, 64)) - 32.0, axis=0)
file = os.open(sys.argv[1], os.O_RDWR | os.O_CREAT)
class Pressed:
    place = 2
    def info(self):
        return palpate.DeviceInfo(name="pressed")
    def read(self):
        self.place = min(self.place + 0.05, 13)
        return palpate.DeviceReading(position=(self.place, 32, 32), status="ready")
    def write(self, force, torque):
        os.pwrite(file, b"%8.4f" % numpy.linalg.norm(force), 0)
field = palpate.Field(palpate.Volume(ball.astype("float32")))
servo = palpate.Servo(palpate.Renderer(field, 300), Pressed(), real_time=False)
servo.start()
while True:
    time.sleep(1)
"""
    told = tmp_path / "force"
    with subprocess.Popen([sys.executable, "-B", "-c", program, str(told)]) as child:
        try:
            until(lambda: told.exists() and told.read_bytes().strip() and float(told.read_bytes()) > 0.1)
            child.send_signal(getattr(signal, sent))
            assert child.wait() == -getattr(signal, sent)
        finally:
            child.kill()
    assert float(told.read_bytes()) == 0
