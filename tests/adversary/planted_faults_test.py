#!/usr/bin/env python3
"""Each attack finds a fault that is planted in the program: a wrapper that passes the words on and then
does one thing wrong. usage: planted_faults_test.py PALPATE"""

import stat
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
WRAPPER = """#!{python}
import os, subprocess, sys, time
words = sys.argv[1:]
def real(words):
    return subprocess.run([{program!r}, *words]).returncode
{fault}
"""
FAULTS = {
    ("proxies", "another level is felt than was asked for", "the SCP is"):
        "sys.exit(real(['--isovalue=60%' if w.startswith('--isovalue=') else w for w in words]))",
    ("lives", "the other field is felt", "a density of|refused without a reason"):
        "sys.exit(real([{'linear': 'cubic', 'cubic': 'linear'}.get(w, w) for w in words]))",
    ("readers", "damaged files are read in silence", "in place of one|without a word"):
        "subprocess.run([%(program)r, *words], stderr=subprocess.DEVNULL); sys.exit(3)",
    ("readers", "a library's source path is shown", "a message shows"):
        "r = subprocess.run([%(program)r, *words], capture_output=True, text=True)\n"
        "print(r.stderr.replace(';', ' (itkNiftiImageIO.cxx:309);'), end='', file=sys.stderr)\n"
        "sys.exit(r.returncode)",
    ("texts", "a signal does not end it", "does not end|status"):
        "import signal\nfor s in (1, 2, 15): signal.signal(s, signal.SIG_IGN)\n"
        "s = real(words)\nif s < 0 or s > 128: time.sleep(1000)\nsys.exit(s)",
    ("recordings", "every recording is the same", "validates as the same"):
        "sys.exit(0 if '--validate' in words else real(words))",
    ("services", "forces go beyond the limit", "a force of"):
        "words = ['20' if w == '4.0' else '0.69' if w == '0.5' else w for w in words]\nsys.exit(real(words))",
    ("signals", "no signal is passed on", "does not end|status"):
        "import signal\nfor s in range(1, 32):\n  if s not in (9, 19): signal.signal(s, signal.SIG_IGN)\n"
        "p = subprocess.Popen([%(program)r, *words])\n"
        "time.sleep(60); p.kill(); sys.exit(0)",
    ("outputs", "a temporary file stays", "left behind|took away"):
        "s = real(words)\nopen('.palpate-1-0.part', 'w').close()\nsys.exit(s)",
    ("kills", "a sample is another one", "other samples|neither"):
        "if 'now.raw' not in words: os.execv(%(program)r, [%(program)r, *words])\n"
        "s = real(words)\nb = bytearray(open('now.raw', 'rb').read())\nb[0] ^= 255\n"
        "open('now.raw', 'wb').write(b)\nsys.exit(s)",
}


def main():
    program = str(Path(sys.argv[1]).resolve())
    missed = []
    for (attack, what, expected), fault in FAULTS.items():
        # Where the fault is a program that does not end, half the usual time suffices; elsewhere a busy machine takes long.
        slower = "0.5" if "does not end" in expected else "20"
        with tempfile.TemporaryDirectory() as folder:
            wrapper = Path(folder) / "wrapper"
            wrapper.write_text(WRAPPER.format(python=sys.executable, program=program,
                                              fault=fault.replace("%(program)r", repr(program))))
            wrapper.chmod(wrapper.stat().st_mode | stat.S_IXUSR)
            ran = subprocess.run([sys.executable, "-B", HERE / "adversary.py", "--program", wrapper, "--only",
                                  attack, "--seeds", "300", "--most-findings", "1",
                                  "--slower", slower], capture_output=True, text=True)
        found = any(word in ran.stdout for word in expected.split("|"))
        print(f"{attack}: {what}: {'found' if ran.returncode == 1 and found else 'MISSED'}", flush=True)
        if ran.returncode != 1 or not found:
            missed.append(f"{attack}: {what}\n{ran.stdout[-2000:]}{ran.stderr[-2000:]}")
    print("\n".join(missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
