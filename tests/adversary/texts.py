"""Attack with text: trajectories, lists of commands, command lines; from files, pipes and devices that give
too much, nothing, or never end."""

import os
import signal
import threading
import time

from damage import ODD_INTEGERS, ODD_NUMBERS, bytes_changed
from program import Finding, expect_tidy, judge

REPLAY = ["replay", "synthetic:sphere:16x16x16", "--output", "o.csv", "--quiet", "--trajectory"]
TOUCH = ["touch", "synthetic:sphere:16x16x16", "--headless", "--normal-priority", "--seconds", "0.3"]


def one(program, random, folder, counts):
    what = random.choice(FORMS)
    counts[what.__name__] += 1
    what(program, random, folder, counts)


def odd_number(random):
    return random.choice(ODD_NUMBERS + tuple(map(str, ODD_INTEGERS)))


def trajectory(random, rows=20):
    lines = ["t,x,y,z"] + [f"{i / 100},{random.uniform(-10, 10)},{random.uniform(-10, 10)},0"
                           for i in range(rows)]
    for _ in range(random.choice((0, 1, 1, 3))):
        at = random.randrange(len(lines))
        cells = lines[at].split(",")
        how = random.randrange(5)
        if how == 0:
            cells[random.randrange(len(cells))] = odd_number(random)
        elif how == 1:
            cells *= random.choice((2, 1000))
        elif how == 2:
            cells = cells[:-1]
        elif how == 3:
            cells[0] = " " * random.choice((1, 10**6)) + cells[0]
        lines[at] = ",".join(cells)
    text = random.choice(("\n", "\n", "\r\n", "\r")).join(lines).encode(errors="replace")
    text = random.choice((b"", b"", b"\xef\xbb\xbf", b"\xff\xfe", b"# a\n\n")) + text
    return bytes_changed(text, random) if random.random() < 0.3 else text


def a_trajectory(program, random, folder, counts):
    (folder / "t.csv").write_bytes(trajectory(random))
    ended = judge(program.run([*REPLAY, "t.csv"], folder), {0, 2, 3})
    counts["refused" if ended.status else "done"] += 1
    if ended.status == 3 and "t.csv" not in ended.err:
        raise Finding(f"the message does not name t.csv: {ended}")
    if (ended.status == 0) != (folder / "o.csv").exists():
        raise Finding(f"a status that disagrees with the output: {ended}")
    expect_tidy(folder, ended)


COMMANDS = ("isovalue {}", "isovalue {}%", "stiffness {}", "damping {}", "viscosity {}", "friction {},{}",
            "penetrability off", "penetrability threshold {}", "penetrability ranges {} {}:{}", "forces off",
            "forces on", "freeze on", "freeze off", "clutch on", "clutch off", "lift", "scale {}",
            "brush carve {}", "brush paint {} {} {}", "brush off", "carve {},{},{} {}", "fill 1,{},1 {}",
            "undo", "redo", "play {}", "pause", "step {}", "seek {}", "loop on", "nonsense", "")
SMALL = ("0", "0.5", "1", "2", "50", "100", "-1")


def commands(random):
    lines = []
    for i in range(random.choice((1, 5, 50))):
        form = random.choice(COMMANDS)
        number = lambda: random.choice(SMALL) if random.random() < 0.7 else odd_number(random)
        while "{}" in form:
            form = form.replace("{}", number(), 1)
        when = f"{0.3 * random.random()}" if random.random() < 0.97 else odd_number(random)
        lines.append(f"{when} {form}")
    text = "\n".join(lines).encode(errors="replace")
    text = random.choice((b"", b"", b"\xef\xbb\xbf")) + text
    return bytes_changed(text, random) if random.random() < 0.2 else text


def a_list_of_commands(program, random, folder, counts):
    (folder / "c.txt").write_bytes(commands(random))
    ended = judge(program.run([*TOUCH, "--commands", "c.txt", "--record", "r.csv", "--device",
                               "simulated:hand=press"], folder), {0, 2, 3})
    counts["refused" if ended.status else "done"] += 1
    if ended.status == 0:
        check_recording(program, folder, counts)
    expect_tidy(folder, ended)


def check_recording(program, folder, counts):
    """Every number is one, forces stay within the limit, and the recording is the same again."""
    lines = (folder / "r.csv").read_text().splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    columns = rows[0].split(",")
    where = {name: columns.index(name) for name in ("scp_x", "force_x", "force_y", "force_z")}
    for row in rows[1:]:
        cells = row.split(",")
        force = [float(cells[where[f"force_{c}"]]) for c in "xyz"]
        if not sum(f * f for f in force) <= 20.0 ** 2 or cells[where["scp_x"]] in ("nan", "inf", "-inf"):
            raise Finding(f"a force of {force} N, an SCP at {cells[where['scp_x']]}: {row}")
    counts["ticks"] += len(rows) - 1
    judge(program.run(["replay", "r.csv", "--validate", "--quiet"], folder), {0})


def an_endless_source(program, random, folder, counts):
    """A device that gives bytes for ever: refused, in time and in little memory."""
    source = random.choice(("/dev/zero", "/dev/urandom"))
    use = random.choice(([*REPLAY, source], [*TOUCH, "--commands", source],
                         ["replay", source, "--validate"],
                         [*TOUCH, "--device", f"recorded:{source}"]))
    ended = judge(program.run(use, folder, seconds=30), {2, 3, 4})
    if ended.peak_mb > 600:
        raise Finding(f"{ended.peak_mb:.0f} MB from an endless source: {ended}")
    expect_tidy(folder, ended)


def a_long_line(program, random, folder, counts):
    """A pipe that gives one line for ever."""
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    stop = threading.Event()

    def feed():
        try:
            with open(pipe, "wb", buffering=0) as file:
                file.write(random.choice((b"", b"t,x,y,z\n")))
                while not stop.is_set():
                    file.write(b"1" * 65536)
        except OSError:
            pass
    feeder = threading.Thread(target=feed, daemon=True)
    feeder.start()
    use = random.choice(([*REPLAY, "pipe"], [*TOUCH, "--commands", "pipe"]))
    ended = program.run(use, folder, seconds=60)
    stop.set()
    judge(ended, {2, 3})
    if ended.peak_mb > 600:
        raise Finding(f"{ended.peak_mb:.0f} MB from a pipe: {ended}")


def a_silent_pipe(program, random, folder, counts):
    """A pipe without a writer, or whose writer says nothing: a signal ends the wait."""
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    writer = os.open(pipe, os.O_RDWR) if random.random() < 0.5 else None
    use = random.choice(([*REPLAY, "pipe"], [*TOUCH, "--commands", "pipe"], ["info", "pipe"],
                         ["replay", "pipe", "--validate"]))
    which = random.choice((signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
    process = program.start(use, folder)
    time.sleep(random.uniform(0.3, 0.6))
    process.send_signal(which)
    ended = program.finish(process, 10)
    if writer is not None:
        os.close(writer)
    if ended.timed_out:
        raise Finding(f"{which.name} does not end the wait for a pipe: {ended}")
    if ended.status not in (128 + which, -which, 2, 3):
        raise Finding(f"{which.name}: an unexpected end: {ended}")


def odd_options(program, random, folder, counts):
    """Numbers of the command line at the edge of what they can be."""
    (folder / "t.csv").write_text("t,x,y,z\n0,-20,0,0\n0.1,0,0,0\n0.2,1,1,1\n")
    options = ("--isovalue", "--stiffness", "--damping", "--viscosity", "--friction", "--force-limit",
               "--force-rate", "--ramp", "--rate", "--scale", "--step-budget", "--background", "--threshold",
               "--magnet", "--texture", "--seconds")
    words = [*REPLAY, "t.csv"]
    if random.random() < 0.3:
        words = [*TOUCH[:-2], "--seconds", "0.2"]
    for _ in range(random.choice((1, 2))):
        name = random.choice(options)
        value = odd_number(random)
        if name in ("--friction", "--magnet", "--texture") and random.random() < 0.8:
            value = f"{value},{random.choice(SMALL)}"
        words.append(f"{name}={value}")
    # A live session that was given a time of no end is ended by a signal.
    process = program.start(words, folder)
    time.sleep(0.01)
    if words[0] == "touch":
        time.sleep(2)
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
    ended = program.finish(process, 30)
    judge(ended, {0, 2, 3, 143})
    counts["refused" if ended.status else "done"] += 1
    if "Traceback" in ended.err or ended.out.lower().count("nan"):
        raise Finding(f"a number that is none is shown: {ended} {ended.out}")


FORMS = (a_trajectory, a_trajectory, a_list_of_commands, an_endless_source, a_long_line, a_silent_pipe,
         odd_options, odd_options)
