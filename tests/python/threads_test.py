"""Servos whose last reference goes, devices that hang, forked processes, and Ctrl-C."""

import functools
import http.server
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import palpate
import pytest

import live_test


def run_program(program, *arguments):
    """Runs it in a process of its own; returns what it prints, word by word."""
    lines = "import sys; sys.path.insert(0, sys.argv[1])\nimport os, threading, live_test, palpate\n"
    ran = subprocess.run([sys.executable, "-B", "-c", lines + program, os.path.dirname(__file__), *arguments],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert ran.returncode == 0, ran.stdout
    return ran.stdout.split()


def test_the_last_reference_to_a_running_servo_may_go_in_a_function_of_its_device():
    words = run_program("""
started = threading.Event()
class Tired(live_test.Still):
    def read(self):
        if started.is_set() and self.forces and self.forces[-1].any():
            self.servo = None
        return super().read()
    def close(self):
        print("closed", self.forces[-1].any(), max(f[2] for f in self.forces) > 0)
        super().close()
device = Tired(live_test.surface_height() - 0.5)
device.servo = palpate.Servo(live_test.renderer(), device, real_time=False)
device.servo.start()
started.set()
live_test.until(lambda: device.closed)
print("end")
""")
    assert words == ["closed", "False", "True", "end"]


def test_a_device_serves_one_session_at_a_time():
    ball = palpate.load("synthetic:sphere:16x16x16")
    device, other = live_test.Still(60), live_test.Still(60)
    run = palpate.Run(ball, palpate.Setup(real_time=False), device=device)
    for again in (lambda: palpate.Run(ball, palpate.Setup(real_time=False), device=device),
                  lambda: palpate.Servo(live_test.renderer(), device, real_time=False)):
        with pytest.raises(palpate.DeviceError, match="^the device Still .* serves another hand: [^\n]*$"):
            again()
    assert not device.closed
    palpate.Servo(live_test.renderer(), other, real_time=False)
    run.start()
    run.stop()
    with palpate.Servo(live_test.renderer(), device, real_time=False) as servo:
        live_test.until(lambda: servo.snapshot() and servo.snapshot().device.status == "ready")


def test_a_device_that_hangs_is_written_zero_and_stopping_says_so():
    words = run_program("""
hung = threading.Event()
class Hanging(live_test.Still):
    hangs = False
    def read(self):
        if self.hangs and self.forces[-1].any():
            hung.set()
            threading.Event().wait()
        return super().read()
device = Hanging(live_test.surface_height() - 0.5)
servo = palpate.Servo(live_test.renderer(), device, real_time=False)
servo.start()
live_test.until(lambda: device.forces and device.forces[-1].any())
device.hangs = True
live_test.until(hung.is_set)
live_test.until(lambda: servo.snapshot().device.status == "stale")
assert device.forces[-1].any()
for i in range(2):
    try:
        servo.stop()
    except palpate.DeviceError as e:
        print("does not return" in str(e), device.forces[-1].any())
del servo
print("end")
""")
    assert words == ["True", "False", "True", "False", "end"]


def test_stopping_a_device_whose_write_hangs_returns_and_says_so():
    words = run_program("""
class Hanging(live_test.Still):
    def write(self, force, torque):
        threading.Event().wait()
servo = palpate.Servo(live_test.renderer(), Hanging(60), real_time=False)
servo.start()
try:
    servo.stop()
except palpate.DeviceError as e:
    print("not even with a force of zero" in servo.device_problem, "does not return" in str(e), "was written" in str(e))
os._exit(0 if sys.stdout.flush() is None else 1)
""")
    assert words == ["True", "True", "False"]


def test_a_program_may_end_while_other_threads_compute():
    words = run_program("""
field = palpate.Field(palpate.scene("sphere").volume)
begun = threading.Event()
def compute():
    while True:
        palpate.extract(field, 100, progress=lambda fraction: begun.set())
for i in range(2):
    threading.Thread(target=compute, daemon=True).start()
begun.wait()
print("end")
""")
    assert words == ["end"]


def test_a_program_may_end_while_a_function_that_hears_of_progress_runs():
    words = run_program("""
import time
class Slow:  # gives other threads time to come back to Python, which has ended
    def __del__(self):
        time.sleep(0.5)
sys.slow = Slow()
field = palpate.Field(palpate.scene("sphere").volume)
begun = threading.Event()
def heard(fraction):
    begun.set()
    time.sleep(0.01)
def compute():
    while True:
        palpate.extract(field, 100, progress=heard)
for i in range(2):
    threading.Thread(target=compute, daemon=True).start()
begun.wait()
print("end")
""")
    assert words == ["end"]


def test_a_program_may_end_while_a_device_is_in_its_function():
    words = run_program("""
import time
class Slow:
    def __del__(self):
        time.sleep(0.5)
class Late(live_test.Still):
    def read(self):
        time.sleep(4.3)  # stopping waits for 2 s, and for 2 s more
        return super().read()
    def write(self, force, torque):
        time.sleep(4.3)
sys.slow = Slow()
servo = palpate.Servo(live_test.renderer(), Late(60), real_time=False)
servo.start()
print("end")
""")
    assert words[0] == "end"


def serve(folder, kind=http.server.SimpleHTTPRequestHandler):
    handler = functools.partial(kind, directory=folder)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_address[1]}/"


def test_a_forked_child_ends_and_does_not_touch_what_its_parent_runs(tmp_path):
    (tmp_path / "v.zarr").mkdir()
    (tmp_path / "v.zarr/.zarray").write_text(json.dumps(
        dict(zarr_format=2, shape=[4, 4, 4], chunks=[4, 4, 4], dtype="|u1", compressor=None,
             fill_value=9, order="C", filters=None)))
    words = run_program("""
store = palpate.open_store(sys.argv[2])
device = live_test.Still(50)
servo = palpate.Servo(live_test.renderer(), device, real_time=False)
servo.start()
run = palpate.Run(palpate.load("synthetic:sphere:16x16x16"), palpate.Setup(real_time=False))
run.start()
child = os.fork()
if child == 0:
    freeze, fill = palpate.command.Freeze(True), palpate.Fill((0, 0, 0), (1, 1, 1), 3)
    for call in (servo.stop, run.stop, lambda: servo.send(freeze), lambda: run.send(freeze), lambda: run.edit(fill), run.undo, run.redo,
                 lambda: run.set_brush(None), lambda: run.play(1), lambda: run.seek(0), lambda: run.record("r.csv"), run.stop_recording):
        try:
            call()
            print("nothing happened", flush=True)
        except RuntimeError as e:
            print("forked" in str(e), flush=True)
    servo.__exit__(None, None, None)
    sys.exit(0)
live_test.until(lambda: os.waitpid(child, os.WNOHANG)[0])
ticks = servo.snapshot().number
live_test.until(lambda: servo.snapshot().number > ticks)
run.stop()
servo.stop()
print(device.closed)
""", serve(tmp_path) + "v.zarr")
    assert words == 13 * ["True"]


def interrupted_after(program, *arguments):
    """Runs the call that stands last in a program, interrupts it as Ctrl-C does when it is under
    way, and returns how much the processor did for it until it ended [s]."""
    *before, call = program.strip().splitlines()
    words = run_program("\n".join(before) + f"""
import signal, time
def interrupt():
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGINT)
try:
    begun = time.process_time()
    threading.Thread(target=interrupt, daemon=True).start()
    {call}
    print("inf")
except KeyboardInterrupt:
    print(time.process_time() - begun)
""", *arguments)
    return float(words[0])


def test_ctrl_c_ends_a_long_motion():
    assert interrupted_after("""
scene = palpate.scene("sphere:32x32x32")
settings = palpate.MotionSettings(duration_s=8, rate_hz=5e5)  # means of 15,000 samples each
palpate.motion("slide", palpate.Field(scene.volume), scene.isovalue, settings)
""") < 10  # of minutes; usually 0.6


def test_ctrl_c_ends_the_making_of_a_large_scene():
    assert interrupted_after("palpate.scene('marschner-lobb:1024x1024x1024')") < 10  # of minutes


class SilentAbout(http.server.SimpleHTTPRequestHandler):
    """Answers for all of a folder but the last chunk of the finest level."""

    def do_GET(self):
        if self.path.endswith("/0/c/3/3/3"):
            threading.Event().wait()
        super().do_GET()


def test_ctrl_c_ends_an_edit_that_waits_for_samples(tmp_path):
    subprocess.run([os.environ["PALPATE"], "convert", "-q", "synthetic:sphere:200x200x200", tmp_path / "v.zarr",
                    "--chunk", "64"], check=True)
    assert interrupted_after("""
run = palpate.Run(palpate.open_store(sys.argv[2]), palpate.Setup(isovalue=100, real_time=False))
run.start()
run.edit(palpate.Fill([195, 195, 195], [198, 198, 198], 80))
""", serve(tmp_path, SilentAbout) + "v.zarr") < 10  # without the signal, an InputError after 50 s


def test_ctrl_c_ends_an_edit_in_memory():
    for call in ("palpate.Editor(volume).apply(edit)",
                 "palpate.Run(volume, palpate.Setup(isovalue=100, real_time=False)).edit(edit)"):
        assert interrupted_after(f"""
volume = palpate.load("synthetic:sphere:640x640x640").volume
edit = palpate.Stroke(palpate.Brush(kind="smooth", radius=1000), [0, 0, 0], [0, 0, 0])
{call}
""") < 10  # of a minute


def test_ctrl_c_ends_the_wait_for_a_silent_server():
    with socket.create_server(("127.0.0.1", 0)) as silent:  # connects, and never answers
        address = f"http://127.0.0.1:{silent.getsockname()[1]}/v.zarr"
        assert interrupted_after("palpate.open_store(sys.argv[2])", address) < 10  # the same


class SilentAboutMost(http.server.SimpleHTTPRequestHandler):
    """Answers for all of a folder but chunks of the finest level, of which it gives only the first."""

    def do_GET(self):
        if "/0/c/" in self.path and not self.path.endswith("/0/c/0/0/0"):
            threading.Event().wait()
        super().do_GET()


def is_pending(number, process):
    """A signal was sent to the process, which has not handled it yet."""
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as status:
        pending = next(line for line in status if line.startswith("ShdPnd:"))
    return int(pending.split()[1], 16) >> (number - 1) & 1


@pytest.mark.parametrize("how", ["option", "command"])
def test_ctrl_c_ends_the_saving_of_edits_and_they_are_rescued_without_the_server(tmp_path, how):
    subprocess.run([os.environ["PALPATE"], "convert", "-q", "synthetic:sphere:200x200x200", tmp_path / "v.zarr",
                    "--chunk", "64"], check=True)
    save = ["--save", "e.zarr"] if how == "option" else []
    (tmp_path / "c.txt").write_text("0.1 fill 1,1,1:4,4,4 9\n0.2 redo\n"
                                    + ("" if save else "0.3 save e.zarr\n"))
    touch = subprocess.Popen([os.environ["PALPATE"], "touch", serve(tmp_path, SilentAboutMost) + "v.zarr", "--headless",
                              "--normal-priority", "--device", "simulated:hand=hold", "--isovalue", "100",
                              "--commands", "c.txt", *save], cwd=tmp_path,
                             env={**os.environ, "TMPDIR": str(tmp_path)}, stderr=subprocess.PIPE, text=True)
    assert any("nothing to redo" in line for line in touch.stderr)  # so the samples are filled
    if how == "option":
        touch.send_signal(signal.SIGINT)  # ends the session, so that saving begins
    live_test.until(lambda: list(tmp_path.glob(".palpate-*.part")))
    if how == "command":
        touch.send_signal(signal.SIGINT)  # ends the session, which waits for what is saved
        live_test.until(lambda: not is_pending(signal.SIGINT, touch))
    touch.send_signal(signal.SIGINT)  # ends saving. A third one would end the rescue
    told = touch.communicate()[1]
    assert "saving was interrupted; the edits are kept in" in told, told
    [kept] = tmp_path.glob("palpate-edits-*/edits.zarr")
    Server = http.server.SimpleHTTPRequestHandler  # the original is back, at another address
    note = json.loads((kept / "palpate-edits.json").read_text())
    note["of"] = serve(tmp_path, Server) + "v.zarr"
    (kept / "palpate-edits.json").write_text(json.dumps(note))
    assert palpate.open_store(kept).read([2, 2, 2], [3, 3, 3]).array.max() == 9
