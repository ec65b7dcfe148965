"""Attack with signals: each that a program can catch, at any moment of a live session. The device has no
force afterwards, the exit status names the signal, and the recording is whole."""

import signal
import time

from haply_service import Service
from program import Finding, expect_tidy
from services import check, touch

ENDING = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGALRM, signal.SIGUSR1,
          signal.SIGUSR2, signal.SIGXCPU, signal.SIGVTALRM, signal.SIGPROF, signal.SIGIO, signal.SIGSYS,
          signal.SIGTRAP, signal.SIGSEGV, signal.SIGBUS, signal.SIGILL, signal.SIGFPE, signal.SIGABRT,
          signal.SIGPWR, signal.SIGSTKFLT]
HARMLESS = [signal.SIGCHLD, signal.SIGURG, signal.SIGWINCH, signal.SIGCONT, signal.SIGTSTP, signal.SIGTTIN,
            signal.SIGTTOU, signal.SIGPIPE]


def one(program, random, folder, counts):
    service = Service(random, lambda s, n: s.good())
    process = program.start(touch(service.port, "--record", "r.csv"), folder)
    felt = wait_for_force(service, process, 8)
    time.sleep(random.uniform(0, 0.3))
    which = random.choice(ENDING)
    for _ in range(random.choice((0, 0, 3))):
        process.send_signal(random.choice(HARMLESS))
        time.sleep(random.uniform(0, 0.02))
    for _ in range(random.choice((1, 1, 1, 5))):
        process.send_signal(which)
        time.sleep(random.uniform(0, 0.004))
    ended = program.finish(process, 10)
    service.close()
    what = f"{which.name}: {ended}"
    if ended.timed_out:
        raise Finding(f"does not end: {what}")
    if ended.status not in (128 + which, -which):
        raise Finding(f"an unexpected status: {what}")
    counts[which.name] += 1
    counts["with force"] += felt
    check(service, what)
    expect_tidy(folder, ended)
    validated = program.run(["replay", "r.csv", "--validate", "--quiet"], folder)
    if validated.status != 0 and not (ended.status < 0 and validated.status == 3):
        raise Finding(f"the recording does not validate: {validated}; {what}")


def wait_for_force(service, process, seconds):
    limit = time.monotonic() + seconds
    while time.monotonic() < limit and process.poll() is None:
        if service.forces and any(service.forces[-1][2:]):
            return True
        time.sleep(0.01)
    return False
