"""Attack with signals: each that a program can catch, at any moment of a live session in which commands and
edits arrive all the time. The device has no force afterwards, the exit status names the signal, and the
recording validates. With both cores loaded for half an hour this is the soak of docs/safety.md."""

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


COMMANDS = ("isovalue {percent}%", "stiffness {k}", "damping 0.0005", "viscosity 0.0002", "friction 0.5,0.3",
            "friction 0,0", "penetrability off", "penetrability threshold {k}", "forces off", "forces on",
            "freeze on", "freeze off", "clutch on", "clutch off", "lift", "scale {factor}",
            "brush carve 3 20", "brush add 2 20", "brush smooth 3 20", "brush off", "carve {at} 3",
            "add {at} 2", "smooth {at} 4", "fill 1,1,1:4,4,4 {percent}", "undo", "redo")


def commands(random):
    """Half of the sessions are left alone, so that forces last; the others get one command in 20 ms."""
    if random.random() < 0.5:
        return ""
    lines = []
    for i in range(500):
        line = random.choice(COMMANDS)
        at = ",".join(str(random.randint(-8, 8)) for _ in range(3))
        lines.append(f"{i / 50} " + line.format(percent=random.randint(20, 80), at=at,
                                                k=random.choice(("0.1", "0.3", "0.5")),
                                                factor=random.choice(("0.8", "1", "1.25"))))
    return "\n".join(lines) + "\n"


def one(program, random, folder, counts):
    service = Service(random, lambda s, n: s.good())
    (folder / "c.txt").write_text(commands(random))
    process = program.start(touch(service.port, "--record", "r.csv", "--commands", "c.txt"), folder)
    felt = wait_for_force(service, process, 4)
    time.sleep(random.choice((0, 0.1, 0.3, 2)) * random.random())
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
    gave_up = not felt and ended.status == 4  # a busy machine: the service did not answer in time
    if ended.status not in (128 + which, -which) and not gave_up:
        raise Finding(f"an unexpected status: {what}")
    counts[which.name] += 1
    counts["with force"] += felt
    check(service, what)
    expect_tidy(folder, ended)
    if gave_up:
        return
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
