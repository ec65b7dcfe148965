"""Attack with kills: `palpate convert`, and edits that are saved over earlier ones, end at a random moment of
their run. Afterwards the data of before or the new data is there, whole, and the next run completes it."""

import random as random_module
import shutil
import signal
import time

from program import Finding, expect_tidy, judge

SIZE = 48
BOX = (3, 20)  # of edits, along each axis


def one(program, random, folder, counts):
    source = random_module.Random(random.random()).randbytes(SIZE ** 3)
    (folder / "v.nrrd").write_bytes(
        f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {SIZE} {SIZE} {SIZE}\nspacings: 1 1 1\nencoding: raw\n\n"
        .encode() + source)
    random.choice((conversion, saved_edits))(program, random, folder, counts, source)


def killed(program, random, folder, words, seconds):
    """Whether the run had ended before."""
    process = program.start(words, folder)
    time.sleep(random.uniform(0, 1.1 * seconds))
    process.send_signal(signal.SIGKILL)
    return program.finish(process, 10).status == 0


def samples_of(program, folder, name):
    judge(program.run(["convert", name, "now.raw"], folder), {0})
    samples = (folder / "now.raw").read_bytes()
    (folder / "now.raw").unlink()
    return samples


def convert(out):
    return ["convert", "v.nrrd", out, "--chunk", "16"]


def conversion(program, random, folder, counts, source):
    seconds = judge(program.run(convert("w.zarr"), folder), {0}).seconds
    ended = killed(program, random, folder, convert("v.zarr"), seconds)
    is_there = (folder / "v.zarr").exists()
    counts["conversions: " + ("ended before" if ended else "whole" if is_there else "nothing")] += 1
    left = folder / "v.zarr.partial"
    if is_there and left.exists():  # between the rename into place and the removal of the empty folder
        if [path.name for path in left.iterdir()] != ["palpate-partial.json"]:
            raise Finding("a conversion is in place, and its partial folder holds more than its marker")
        shutil.rmtree(folder / "v.zarr")
        counts["conversions: an empty folder left"] += 1
        is_there = False
    if not is_there:
        expect_tidy(folder, judge(program.run(convert("v.zarr"), folder), {0}))
    if samples_of(program, folder, "v.zarr") != source:
        raise Finding("a conversion that was killed is there, or was completed, with other samples")
    expect_names(folder, ["v.nrrd", "v.zarr", "w.zarr"])


def save(folder, value):
    """A session whose edit fills a box."""
    low, high = (",".join([str(at)] * 3) for at in BOX)
    (folder / "c.txt").write_text(f"0.02 fill {low}:{high} {value}\n")
    return ["touch", "v.zarr", "--isovalue", "128", "--device", "simulated", "--unpaced", "--seconds", "0.1",
            "--commands", "c.txt", "--save", "e.zarr"]


def saved_edits(program, random, folder, counts, source):
    judge(program.run(convert("v.zarr"), folder), {0})
    seconds = judge(program.run(save(folder, 50), folder), {0}).seconds
    ended = killed(program, random, folder, save(folder, 90), seconds)
    value = value_in(samples_of(program, folder, "e.zarr"), source)
    counts["edits: " + ("ended before" if ended else "the new ones" if value == 90 else "the old ones")] += 1
    judge(program.run(save(folder, 70), folder), {0})
    if value_in(samples_of(program, folder, "e.zarr"), source) != 70:
        raise Finding("edits that were saved after a kill are other ones")
    expect_names(folder, ["c.txt", "e.zarr", "v.nrrd", "v.zarr"])


def value_in(samples, source):
    """The number in the box, all of which holds it; elsewhere the source is as it was."""
    inside = bytearray(source)
    low, high = BOX
    row = slice(low, high + 1)
    values = set()
    for z in range(low, high + 1):
        for y in range(low, high + 1):
            at = (z * SIZE + y) * SIZE
            values |= set(samples[at:at + SIZE][row])
            inside[at + low:at + high + 1] = samples[at + low:at + high + 1]
    if len(values) != 1 or bytes(inside) != samples or not values <= {50, 70, 90}:
        raise Finding(f"edits are neither the old ones nor the new ones: {sorted(values)}")
    return values.pop()


def expect_names(folder, names):
    there = sorted(path.name for path in folder.iterdir())
    if there != names:
        raise Finding(f"a run left {sorted(set(there) - set(names))} and lost {sorted(set(names) - set(there))}")
