"""Attack on recordings: a row less, a row twice, two rows exchanged, a digit changed, the end cut off. A recording
that was changed never validates as the same."""

import re

from damage import bytes_changed
from program import Finding, expect_tidy, judge

MEASURED = {"update_ns"}  # a measurement, which is not compared


def one(program, random, folder, counts):
    words = ["touch", "synthetic:sphere:16x16x16", "--headless", "--unpaced", "--quiet", "--seconds", "0.4",
              "--device", f"simulated:hand={random.choice(('press', 'explore', 'circle'))}",
             "--record", "r.csv"]
    (folder / "c.txt").write_text("0.1 isovalue 60%\n0.15 scale 2\n0.2 freeze on\n0.25 freeze off\n")
    judge(program.run([*words, "--commands", "c.txt"], folder), {0})
    whole = (folder / "r.csv").read_bytes()
    if not validates(program, folder, whole):
        raise Finding("a recording as it was made does not validate")
    for _ in range(12):
        how = random.choice(DAMAGE)
        data = how(whole, random)
        if data is None or data == whole:
            continue
        counts[how.__name__] += 1
        if validates(program, folder, data):
            (folder / "same.csv").write_bytes(data)
            raise Finding(f"{how.__name__}: a recording that was changed validates as the same")


def validates(program, folder, data):
    """Whether it is said to be the same, and complete: one that was cut off may be felt as far as it goes."""
    (folder / "d.csv").write_bytes(data)
    ended = judge(program.run(["replay", "d.csv", "--validate"], folder), {0, 3})
    expect_tidy(folder, ended)
    return ended.status == 0 and "was cut off" not in ended.out + ended.err


def parts_of(data):
    """Head, lines after it, and which of these are ticks."""
    lines = data.split(b"\n")
    first = next(i for i, line in enumerate(lines) if line.startswith(b"t,"))
    ticks = [i for i in range(first + 1, len(lines)) if lines[i] and not lines[i].startswith(b"#")]
    return lines, ticks


def a_tick_less(data, random):
    lines, ticks = parts_of(data)
    del lines[random.choice(ticks)]
    return b"\n".join(lines)


def several_ticks_less(data, random):
    lines, ticks = parts_of(data)
    at = random.choice(ticks)
    del lines[at:at + random.randint(2, 50)]
    return b"\n".join(lines)


def a_tick_twice(data, random):
    lines, ticks = parts_of(data)
    at = random.choice(ticks)
    lines.insert(at, lines[at])
    return b"\n".join(lines)


def ticks_exchanged(data, random):
    lines, ticks = parts_of(data)
    a, b = random.sample(ticks, 2)
    lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def a_command_less(data, random):
    lines, _ = parts_of(data)
    commands = [i for i, line in enumerate(lines) if line.startswith(b"# command")]
    if not commands:
        return None
    del lines[random.choice(commands)]
    return b"\n".join(lines)


def a_digit_changed(data, random):
    """In a tick's row, in any column."""
    lines, ticks = parts_of(data)
    at = random.choice(ticks)
    digits = list(re.finditer(rb"\d", lines[at]))
    one_ = random.choice(digits).start()
    new = b"%d" % ((int(lines[at][one_:one_ + 1]) + random.randint(1, 9)) % 10)
    lines[at] = lines[at][:one_] + new + lines[at][one_ + 1:]
    return b"\n".join(lines)


def cut_off(data, random):
    """Cut off, with an end that says it is whole."""
    lines, ticks = parts_of(data)
    return b"\n".join(lines[:random.choice(ticks)]) + b"\n# end {\"lost\":0,\"ticks\":%d}\n" % len(ticks)


def bytes_anywhere(data, random):
    """Among the rows; the head's fields are free text in part."""
    at = data.index(b"\nt,") + 1
    return data[:at] + bytes_changed(data[at:], random)


DAMAGE = (a_tick_less, several_ticks_less, a_tick_twice, ticks_exchanged, a_command_less, a_digit_changed,
          cut_off, bytes_anywhere)
