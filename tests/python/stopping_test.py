"""Ctrl-C while large arrays are copied: it ends the call before the copy is whole. Memory tells, not time."""

import os
import subprocess
import sys

import pytest

MOST_TRIES = 10  # the signal may come before the copy begins or after its end

# A process of its own, since the call may hold Python's lock: sends SIGINT once a process has so many bytes.
WATCHER = """
import os, signal, sys, time
process, limit = map(int, sys.argv[1:])
print("watches", flush=True)
while True:
    with open(f"/proc/{process}/statm", encoding="utf-8") as memory:
        if int(memory.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") > limit:
            break
    time.sleep(1e-4)
os.kill(process, signal.SIGINT)
"""

PROGRAM = f"""
import os, subprocess, sys
import numpy, palpate

def resident(line):
    with open("/proc/self/status", encoding="utf-8") as status:
        return next(int(text.split()[1]) for text in status if text.startswith(line)) << 10

def interrupted(call, size):
    with open("/proc/self/clear_refs", "w", encoding="utf-8") as peak:
        peak.write("5")
    before = resident("VmRSS:")
    words = [sys.executable, "-c", {WATCHER!r}, str(os.getpid()), str(before + size // 8)]
    watcher = subprocess.Popen(words, stdout=subprocess.PIPE, start_new_session=True)
    watcher.stdout.readline()
    try:
        try:
            call()
            result = False
        except KeyboardInterrupt:
            result = resident("VmHWM:") - before < size * 3 // 4
        watcher.kill()
        watcher.wait()
    except KeyboardInterrupt:
        watcher.wait()
        result = False
    return result
"""

CASES = {
    "copied": ("array = numpy.ones((400, 1000, 1000), 'uint8')",
               "palpate.Volume(array, copy=True)", 400_000_000),
    "swapped": ("array = numpy.ones((100, 1000, 1000), '>f4')",
                "palpate.Volume(array, copy=True)", 400_000_000),
    "converted": ("array = numpy.ones((100, 1000, 1000))",
                  "palpate.as_volume(array)", 400_000_000),
    "not finite": ("array = numpy.ones((100, 1000, 1000), 'float32'); array[0, 0, 0] = numpy.nan",
                   "palpate.as_volume(array)", 400_000_000),
    "mesh": ("triangles = numpy.zeros((20_000_000, 3), 'uint32'); vertices = numpy.zeros((1, 3))",
             "palpate.Mesh(vertices, triangles)", 240_000_000),
    "mesh of signed numbers": ("triangles = numpy.zeros((20_000_000, 3), 'int64'); vertices = numpy.zeros((1, 3))",
                               "palpate.Mesh(vertices, triangles)", 480_000_000),
    "blended": ("v = [palpate.Volume(numpy.full((100, 1000, 1000), x, 'float32')) for x in (0, 1)]\n"
                "samples = palpate.Samples([(0, v[0]), (1, v[1])])",
                "samples.volume(0.5)", 400_000_000),
}


@pytest.mark.parametrize("name", CASES)
def test_ctrl_c_ends_the_copying_of_a_large_array(name):
    before, call, size = CASES[name]
    program = f"""{PROGRAM}
import warnings
warnings.simplefilter("ignore")
{before}
print(any(interrupted(lambda: {call}, {size}) for _ in range({MOST_TRIES})))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert done.stdout == "True\n", done.stderr
