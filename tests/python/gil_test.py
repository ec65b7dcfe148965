"""Other threads run while long calls work on many rows. Another thread counts how often it comes to run. It gets the GIL only
where a call releases it, because Python itself would not take it from this thread for a thousand seconds."""

import contextlib
import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy
import palpate
import pytest

ROWS = 300_000
BALL = palpate.scene("sphere:16x16x16")
FIELD = palpate.Field(BALL.volume)
TIMES = numpy.arange(ROWS) / 1000
HIPS = numpy.tile([-9.0, 0, 0], (ROWS, 1))
TURNS = numpy.tile([0, 0, 0, 1.0], (ROWS, 1))
BROKEN = HIPS.copy()
BROKEN[-1] = numpy.nan


@contextlib.contextmanager
def counting_thread():
    """How often another thread has run."""
    count, ended = [0], threading.Event()

    def work():
        while not ended.is_set():
            count[0] += 1
            time.sleep(0)  # gives the GIL back

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield count
    finally:
        ended.set()
        sys.setswitchinterval(interval)
        thread.join()


def refused(call):
    with pytest.raises(ValueError):
        call()


FOLDER = tempfile.TemporaryDirectory()
MESH = FOLDER.name + "/ball.stl"  # takes long to become a tool
palpate.extract(palpate.Field(palpate.scene("sphere:24x24x24").volume), "50%").write(MESH)
CALLS = {
    "Mesh": lambda: palpate.Mesh(HIPS, [[0, 1, 2]]),
    "replay": lambda: palpate.replay(FIELD, BALL.isovalue, TIMES[:5000], HIPS[:5000]),
    "replay, motion": lambda: refused(lambda: palpate.replay(FIELD, BALL.isovalue, TIMES, BROKEN)),
    "replay, orientations": lambda: refused(lambda: palpate.replay(
        FIELD, BALL.isovalue, TIMES, BROKEN, orientation_xyzw=TURNS, tool="sphere:1")),
    "Renderer, tool": lambda: palpate.Renderer(FIELD, BALL.isovalue, palpate.RenderSetup(tool=MESH, tool_spacing=2.0)),
    "cast_rays, ends": lambda: refused(lambda: palpate.cast_rays(FIELD, BALL.isovalue, HIPS, HIPS[1:])),
    "cast_rays": lambda: palpate.cast_rays(FIELD, BALL.isovalue, HIPS[:5000], -HIPS[:5000]),
    "Scene.exact": lambda: BALL.exact(HIPS),
    "Tool": lambda: refused(lambda: palpate.Tool(BROKEN)),
    "follow_each": lambda: refused(lambda: palpate.follow_each(FIELD, BALL.isovalue, BROKEN, [0])),
}


@pytest.mark.parametrize("name", CALLS)
def test_another_thread_runs_for_long_during_a_call(name):
    # In one of the calls, the other thread is quick enough, on a busy machine after many. NumPy's conversions let it run once or twice.
    calls, often = 5000, 20
    most = 0
    with counting_thread() as count:
        for _ in range(calls):
            before = count[0]
            CALLS[name]()
            most = max(most, count[0] - before)
            if most >= often:
                break
    assert most >= often


def test_the_other_thread_does_not_run_without_a_release():
    with counting_thread() as count:
        before = count[0]
        sum(range(100_000))
        assert count[0] == before


def test_a_trace_can_be_written_to_a_pipe_that_another_thread_reads(tmp_path):
    """A pipe takes 64 KiB until it is read. A writer that kept the GIL would wait for ever."""
    os.mkfifo(tmp_path / "pipe")
    ran = subprocess.run([sys.executable, "-B", "-c", """
import sys, threading, numpy, palpate
ball, ticks = palpate.scene("sphere:16x16x16"), 5000
trace = palpate.replay(palpate.Field(ball.volume), ball.isovalue, numpy.arange(ticks) / 1000, numpy.tile([-9.0, 0, 0], (ticks, 1)))
writer = threading.Thread(target=trace.write, args=[sys.argv[1]])
writer.start()
print(sum(1 for line in open(sys.argv[1])))
writer.join()
""", tmp_path / "pipe"], stdout=subprocess.PIPE, text=True, check=True)
    assert ran.stdout == "5001\n"
