"""Ctrl-C while large arrays are copied: it ends the call before the copy is whole. Memory tells, not time."""

import os
import subprocess
import sys

import pytest

# The array's memory has a page that may not be read. Whoever copies it comes to that page, so that the signal is
# sent in the middle of the copy, however quick the machine is.
PROGRAM = """
import ctypes, mmap, os, signal, sys, threading, warnings
import numpy, palpate

libc = ctypes.CDLL(None)
NOTHING = 0  # PROT_NONE
warnings.simplefilter("ignore")

def resident(line):
    with open("/proc/self/status", encoding="utf-8") as status:
        return next(int(text.split()[1]) for text in status if text.startswith(line)) << 10

def filled(shape, dtype, value):
    \"\"\"An array that begins at a page of its own.\"\"\"
    count = int(numpy.prod(shape))
    array = numpy.frombuffer(mmap.mmap(-1, count * numpy.dtype(dtype).itemsize), dtype, count).reshape(shape)
    array[...] = value
    return array

class Page:
    def __init__(self, array, at):
        self.address = array.ctypes.data + int(array.nbytes * at) // mmap.PAGESIZE * mmap.PAGESIZE

    def allow(self, how):
        assert libc.mprotect(ctypes.c_void_p(self.address), mmap.PAGESIZE, how) == 0

def is_interrupted(call, array, size):
    \"\"\"Whether Ctrl-C, which comes after a part of the copy was made, ends the call before three quarters of it were made.\"\"\"
    with open("/proc/self/clear_refs", "w", encoding="utf-8") as peak:
        peak.write("5")
    before, main, sent = resident("VmRSS:"), threading.main_thread().ident, []
    pages = [Page(array, 1 / 4), Page(array, 0)]

    @ctypes.CFUNCTYPE(None, ctypes.c_int)
    def page_was_read(_):
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])  # until this function has returned
        pages[0].allow(mmap.PROT_READ | mmap.PROT_WRITE)
        grown = resident("VmRSS:") - before
        if grown > size // 16:
            sent.append(grown)
            signal.pthread_kill(main, signal.SIGINT)
        else:  # somebody only looked at the samples, and will read them again from the beginning
            pages.reverse()
            pages[0].allow(NOTHING)

    libc.signal(signal.SIGSEGV, page_was_read)
    pages[0].allow(NOTHING)
    try:
        call()
    except KeyboardInterrupt:
        return bool(sent) and resident("VmHWM:") - before < size * 3 // 4
    return False
"""

CASES = {
    "copied": ("array = filled((100, 1000, 1000), 'uint8', 1)",
               "palpate.Volume(array, copy=True)", 100_000_000),
    "swapped": ("array = filled((25, 1000, 1000), '>f4', 1)",
                "palpate.Volume(array, copy=True)", 100_000_000),
    "converted": ("array = filled((25, 1000, 1000), 'float64', 1)",
                  "palpate.as_volume(array)", 100_000_000),
    "not finite": ("array = filled((25, 1000, 1000), 'float32', 1); array[0, 0, 0] = numpy.nan",
                   "palpate.as_volume(array)", 100_000_000),
    "mesh": ("array = filled((8_000_000, 3), 'uint32', 0); vertices = numpy.zeros((1, 3))",
             "palpate.Mesh(vertices, array)", 96_000_000),
    "mesh of signed numbers": ("array = filled((8_000_000, 3), 'int64', 0); vertices = numpy.zeros((1, 3))",
                               "palpate.Mesh(vertices, array)", 192_000_000),
    "blended": ("array = filled((25, 1000, 1000), 'float32', 0)\n"
                "v = [palpate.Volume(array), palpate.Volume(filled((25, 1000, 1000), 'float32', 1))]\n"
                "samples = palpate.Samples([(0, v[0]), (1, v[1])])",
                "samples.volume(0.5)", 100_000_000),
}


@pytest.mark.parametrize("name", CASES)
def test_ctrl_c_ends_the_copying_of_a_large_array(name):
    before, call, size = CASES[name]
    program = f"{PROGRAM}\n{before}\nprint(is_interrupted(lambda: {call}, array, {size}))\n"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert done.stdout == "True\n", done.stderr
