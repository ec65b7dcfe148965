"""Runs the program under test and judges how it ended: in time, with a status of the contract, with one
line that a person can use, and with nothing left behind. Linux, Python's standard library alone."""

import os
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

STATUSES = {0, 1, 2, 3, 4, 5}
INTERRUPTED = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129, signal.SIGQUIT: 131}
# What a message never shows: a library's source files, pointers, mangled names.
INTERNAL = re.compile(r"[\w/.+-]+\.(?:cxx|cpp|cc|hxx|hpp|txx)\b|[\w/.+-]+\.h:\d|\b0x[0-9a-f]{5,}\b"
                      r"|\b_ZN\w+|std::|terminate called")
LEFT_BEHIND = re.compile(r"\.palpate-|\.part$|^core(\.\d+)?$")


@dataclass
class Ended:
    """How a run ended. `status` is negative for the signal that killed it."""
    words: list
    status: int
    out: str
    err: str
    seconds: float
    timed_out: bool = False
    peak_mb: float = 0.0

    def __str__(self):
        return (f"{' '.join(map(str, self.words))}\n  status {self.status} after {self.seconds:.1f} s, "
                f"{self.peak_mb:.0f} MB\n  stderr: {self.err.strip()[-600:]!r}")


class Finding(Exception):
    """Something that must not happen. The text says what; files that show it are kept."""


class Program:
    """The program under test, found once. Each run gets a time limit, and optionally a file size limit."""

    def __init__(self, path, scale=1.0):
        self.path = str(Path(path).resolve())
        self.scale = scale  # of time limits: sanitizers and loaded machines are slower
        self.runs = 0
        self.lock = threading.Lock()

    def start(self, words, folder, stdin=subprocess.DEVNULL, stdout=None, limits=(), environment=None):
        """The running process; its standard error and output are files in a folder of their own."""
        def restrict():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            for which, value in limits:
                resource.setrlimit(which, (value, value))
        with self.lock:
            self.runs += 1
        env = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
        env.update(environment or {})
        streams = Path(tempfile.mkdtemp(prefix="palpate-streams-"))
        process = subprocess.Popen(
            [self.path, *map(str, words)], cwd=folder, stdin=stdin, env=env, preexec_fn=restrict,
            stdout=stdout if stdout is not None else open(streams / "out", "wb"),
            stderr=open(streams / "err", "wb"), start_new_session=True)
        process.streams, process.words, process.begun = streams, list(words), time.monotonic()
        return process

    def finish(self, process, seconds=60.0):
        """Waits for the end. A process that does not end in time is killed with its children."""
        peak = 0.0
        limit = process.begun + seconds * self.scale
        timed_out, pause = False, 0.002
        while process.poll() is None:
            peak = max(peak, resident_mb(process.pid))
            if time.monotonic() > limit:
                timed_out = True
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                break
            time.sleep(pause)
            pause = min(0.05, pause * 1.5)
        text = {}
        for name in ("out", "err"):
            file = process.streams / name
            text[name] = file.read_bytes().decode(errors="replace") if file.exists() else ""
        shutil.rmtree(process.streams, ignore_errors=True)
        return Ended(process.words, process.returncode, text["out"], text["err"],
                     time.monotonic() - process.begun, timed_out, peak)

    def run(self, words, folder, seconds=60.0, **more):
        return self.finish(self.start(words, folder, **more), seconds)


def children_of(pid):
    try:
        with open(f"/proc/{pid}/task/{pid}/children") as file:
            return [int(word) for word in file.read().split()]
    except OSError:
        return []


def resident_mb(pid):
    """Private memory of a process and its children [MB]; 0 once they are gone."""
    total = 0.0
    for each in [pid, *children_of(pid)]:
        try:
            with open(f"/proc/{each}/status") as file:
                for line in file:
                    if line.startswith(("RssAnon:", "RssShmem:")):
                        total += int(line.split()[1]) / 1024
        except OSError:
            pass
    return total


def judge(ended, allowed=STATUSES):
    """Raises a Finding unless the run ended as the contract says."""
    if ended.timed_out:
        raise Finding(f"does not end: {ended}")
    if ended.status not in allowed:
        raise Finding(f"ended with a status that is not among {sorted(allowed)}: {ended}")
    if ended.status in (0, 1):
        return ended
    lines = [line for line in ended.err.splitlines() if line.strip()]
    errors = [line for line in lines if not line.startswith((" ", "palpate: warning", "palpate: note"))]
    if not lines:
        raise Finding(f"fails without a word: {ended}")
    if ended.status in (2, 3, 4, 5) and len(errors) != 1:
        raise Finding(f"fails with {len(errors)} lines in place of one: {ended}")
    if len(lines[-1]) > 1000:
        raise Finding(f"a message of {len(lines[-1])} characters: {ended}")
    shown = INTERNAL.search(ended.err)
    if shown:
        raise Finding(f"a message shows {shown.group(0)!r}: {ended}")
    if any(ord(c) < 32 and c not in "\n\t\r" for c in ended.err):
        raise Finding(f"a message has control characters: {ended}")
    return ended


def left_behind(folder):
    """Temporary files and core dumps below a folder."""
    return [path for path in Path(folder).rglob("*") if LEFT_BEHIND.search(path.name)]


def expect_tidy(folder, ended):
    remains = left_behind(folder)
    if remains:
        raise Finding(f"left behind: {', '.join(path.name for path in remains)} by {ended}")
