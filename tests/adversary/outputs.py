"""Attack on outputs: disks that are full after any number of bytes, places that cannot be written, runs that
are killed. Outputs of a run appear together or not at all, and nothing stays behind."""

import random as random_module
import resource
import signal
import time

from program import Finding, expect_tidy, judge, left_behind


def one(program, random, folder, counts):
    what = random.choice((full_disk, full_disk, killed, a_place_that_cannot_be_written))
    counts[what.__name__] += 1
    what(program, random, folder, counts)


def trajectory(folder, rows):
    chance = random_module.Random(rows)
    lines = [f"{i / 1000},{chance.uniform(-9, 9)},{chance.uniform(-9, 9)},{chance.uniform(-9, 9)}\n"
             for i in range(rows)]
    (folder / "t.csv").write_text("t,x,y,z\n" + "".join(lines))


# Words, and the files that appear.
RUNS = (
    (["replay", "synthetic:sphere:16x16x16", "--trajectory", "t.csv", "--output", "o.csv", "--path", "p.csv"],
     {"o.csv", "p.csv"}),
    (["extract", "synthetic:noise:16x16x16", "--output", "s.ply"], {"s.ply"}),
    (["extract", "synthetic:noise:16x16x16", "--output", "s.obj"], {"s.obj"}),
    (["extract", "synthetic:noise:16x16x16", "--output", "s.vtp"], {"s.vtp"}),
)


def full_disk(program, random, folder, counts):
    trajectory(folder, 3000)
    words, outputs = random.choice(RUNS)
    size = int(10 ** random.uniform(0, 6))
    ended = judge(program.run(words, folder, limits=[(resource.RLIMIT_FSIZE, size)]), {0, 5})
    there = {name for name in outputs if (folder / name).exists()}
    if there != (outputs if ended.status == 0 else set()):
        raise Finding(f"of {sorted(outputs)} there are {sorted(there)} with files of at most {size} bytes: "
                      f"{ended}")
    counts["refused" if ended.status else "done"] += 1
    expect_tidy(folder, ended)


def killed(program, random, folder, counts):
    """What a killed run leaves behind, the next one in that folder takes away."""
    trajectory(folder, 60000)
    words, outputs = random.choice(RUNS[:2])
    process = program.start(words, folder)
    limit = time.monotonic() + 5
    while process.poll() is None and time.monotonic() < limit and not left_behind(folder):
        time.sleep(0.001)
    process.send_signal(signal.SIGKILL)
    program.finish(process, 10)
    counts["left by a kill"] += bool(left_behind(folder))
    judge(program.run(words, folder), {0})
    if left_behind(folder):
        raise Finding(f"a run took away nothing of what a killed one left: {left_behind(folder)}")


def a_place_that_cannot_be_written(program, random, folder, counts):
    trajectory(folder, 100)
    (folder / "folder").mkdir()
    place = random.choice(("folder", "folder/", "missing/o.csv", "t.csv/o.csv", "/dev/full", "/proc/o.csv",
                           "o" * 300 + ".csv"))
    words = list(RUNS[0][0])
    which = random.choice((5, 7))
    words[which] = place
    before = sorted(p.name for p in folder.iterdir())
    ended = judge(program.run(words, folder), {2, 5})
    if sorted(p.name for p in folder.iterdir()) != before:
        raise Finding(f"an output beside one that cannot be written: {ended}")
