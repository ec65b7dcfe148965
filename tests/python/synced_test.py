"""Whatever is renamed into its place is on the disk before, and its new name afterwards. A file that is written under its own name is
on the disk at the end. strace watches the programs, so that no writer has to be named: every file under the test's folder counts.

The disk cache (--cache) is the one exception, and outside of these folders. Losing an entry loses nothing, and syncing each would take
longer than its request. tests/stream/disk_cache_test.cpp shows that an entry whose bytes did not reach the disk is never returned."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = os.environ["PALPATE"]
CALLS = "openat,write,pwrite64,writev,ftruncate,fsync,fdatasync,syncfs,sync,rename,renameat,renameat2,mkdir,mkdirat"
LINE = re.compile(r"(?:\d+ +)?(\w+)\((.*)\) += (-?\d+)(?:<([^>]*)>)?")
UNFINISHED = re.compile(r"(\d+) +(.*) <unfinished \.\.\.>$")
RESUMED = re.compile(r"(\d+) +<\.\.\. \w+ resumed>(.*)$")
OPEN = re.compile(r"^-?\w+<([^>]*)>")
NAMES = re.compile(r'(?:AT_FDCWD(?:<[^>]*>)?|\d+<([^>]*)>)?(?:, )?"((?:[^"\\]|\\.)*)"')


def calls_of(log):
    """(name, arguments, path of the result) of the calls that succeeded, in order."""
    begun = {}
    for line in log.read_text(errors="replace").splitlines():
        if match := UNFINISHED.match(line):
            begun[match[1]] = match[2]
            continue
        if match := RESUMED.match(line):
            line = f"{match[1]} {begun.pop(match[1], '')}{match[2]}"
        match = LINE.match(line)
        if match and int(match[3]) >= 0:
            yield match[1], match[2], Path(match[4] or ".")


def is_growing(path):
    """In a folder that becomes a result as a whole, or under a temporary name."""
    return any(part.startswith(".palpate-") or part.endswith(".partial") for part in path.parts)


def moved(paths, before, path):
    return {path / p.relative_to(before) if p.is_relative_to(before) else p for p in paths}


def faults_in(log, folder):
    """How many files were put in place in `folder`, and those of them that were not synced, or whose names were not."""
    unsynced, names, faults, places = set(), set(), [], 0
    for call, given, result in calls_of(log):
        if call in ("sync", "syncfs"):
            unsynced.clear()
            names.clear()
        elif call == "openat" and "O_CREAT" in given and result.is_relative_to(folder) and not is_growing(result):
            places += 1
            names.add(result)
        elif call.startswith("mkdir"):
            at, name = NAMES.findall(given)[0]
            path = Path(os.path.normpath(os.path.join(at or folder, name)))
            names.update({path} if path.is_relative_to(folder) and not is_growing(path) else ())
        elif call in ("write", "pwrite64", "writev", "ftruncate"):
            unsynced.add(Path(OPEN.match(given)[1]))
        elif call in ("fsync", "fdatasync"):
            path = Path(OPEN.match(given)[1])
            unsynced.discard(path)
            names = {name for name in names if name.parent != path}
        elif call.startswith("rename"):
            before, path = (Path(os.path.normpath(os.path.join(at or folder, name)))
                            for at, name in NAMES.findall(given)[:2])
            if "RENAME_EXCHANGE" in given:
                unsynced = moved(moved(moved(unsynced, before, before / "*"), path, before), before / "*", path)
            else:
                unsynced = moved({p for p in unsynced if not p.is_relative_to(path)}, before, path)
            names = moved(names, before, path)
            if not path.is_relative_to(folder) or is_growing(path):
                continue
            places += 1
            names.add(path)
            faults += [f"{p} was renamed without being synced" for p in unsynced if p.is_relative_to(path)]
    left = {p for p in unsynced if p.is_relative_to(folder) and not is_growing(p)}
    return places, [*faults, *(f"{p} was not synced" for p in left if p.exists()),
                    *(f"the name {p} was not synced" for p in names if p.exists())]


def watched(folder, words):
    """Runs a program in `folder`; the files that it has put in place there, all of them synced."""
    log = folder.parent / f"{folder.name}.log"
    own = {"HOME": str(folder.parent), "MPLCONFIGDIR": str(folder.parent / "mpl")}
    done = subprocess.run(["strace", "-f", "-y", "-qq", "-s", "4096", "-e", "signal=none", "-e", f"trace={CALLS}", "-o", log,
                           *words], cwd=folder, env={**os.environ, **own}, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    places, faults = faults_in(log, folder)
    assert places > 0, "nothing was written"
    assert not faults, "\n".join(faults)


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "work"
    path.mkdir()
    return path


@pytest.fixture
def store(folder):
    subprocess.run([PROGRAM, "convert", "-q", "synthetic:sphere:64x64x64", folder / "ball.zarr"], check=True)
    return "ball.zarr"


@pytest.mark.parametrize("out", ["o.nrrd", "o.nhdr", "o.mhd", "o.mha", "o.nii.gz", "o.vti", "o.zarr"])
def test_conversions(folder, out):
    watched(folder, [PROGRAM, "convert", "-q", "synthetic:sphere:40x40x40", out])


@pytest.mark.parametrize("out", ["o.ply", "o.obj", "o.stl", "o.vtp"])
def test_meshes(folder, out):
    watched(folder, [PROGRAM, "extract", "-q", "synthetic:sphere:24x24x24", "-i", "50%", "--output", out])


def test_pictures(folder):
    watched(folder, [PROGRAM, "render", "-q", "synthetic:sphere:24x24x24", "-i", "50%", "--output", "o.png"])


def test_recordings_traces_and_paths(folder):
    watched(folder, [PROGRAM, "record", "synthetic:sphere:24x24x24", "--unpaced", "--device", "simulated:hand=press",
                     "--seconds", "0.5", "--output", "r.csv"])
    watched(folder, [PROGRAM, "replay", "synthetic:sphere:24x24x24", "--trajectory", "r.csv", "-i", "50%", "--output", "t.csv",
                     "--path", "p.csv"])


def test_edited_volumes(folder):
    (folder / "c.txt").write_text("0.1 fill 1,1,1:9,9,9 90%\n0.2 save a.nrrd\n0.4 quit\n")
    watched(folder, [PROGRAM, "touch", "synthetic:sphere:24x24x24", "--unpaced", "--device", "simulated:hand=hold",
                     "--commands", "c.txt", "--save", "b.zarr"])


def test_edits_of_a_store_also_in_place_of_older_ones(folder, store):
    (folder / "c.txt").write_text("0.1 fill 1,1,1:9,9,9 90%\n0.2 save e.zarr\n0.4 fill 1,1,1:9,9,9 50%\n0.6 quit\n")
    watched(folder, [PROGRAM, "touch", store, "--level", "0", "--unpaced", "--device", "simulated:hand=hold",
                     "--commands", "c.txt", "--save", "e.zarr"])


def test_demo(folder):
    watched(folder, [PROGRAM, "demo", "--output", "demo"])


def test_contact_points(folder):
    watched(folder, [PROGRAM, "tool", "sphere:2", "--points", "p.csv"])


def test_live_files(folder):
    watched(folder, [sys.executable, "-c", "import palpate\n"
                     "palpate.LiveWriter('v.live', palpate.Geometry(size=(8, 8, 8)), 'uint8')"])


def test_experiments(folder):
    watched(folder, [PROGRAM, "evaluate", "fall-through", "--quick", "--seeds", "1", "--output", "results"])


STUDY = """
import distributed, palpate
from palpate.study import study
with distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster:
    with distributed.Client(cluster) as client:
        scene = palpate.scene("torus:24x24x24")
        motion = palpate.motion("slide", palpate.Field(scene.volume), scene.isovalue, palpate.MotionSettings(duration_s=0.1))
        study(client, "synthetic:torus:24x24x24", scene.isovalue, *motion[:2], {"soft": {"stiffness": 0.2}}, "traces")
"""


def test_studies(folder):
    watched(folder, [sys.executable, "-c", STUDY])


def test_conversions_by_workers(folder, store):
    watched(folder, [PROGRAM, "distribute", store, "o.zarr", "--chunk", "16", "--block", "32", "--workers", "1"])


TRIALS = """
from palpate.trials import Plan, session
session("answers.csv", Plan(0.3, differences=(0.5,), repeats=1), lambda trial: 1)
"""


def test_answers_of_people(folder):
    watched(folder, [sys.executable, "-c", TRIALS])


def test_a_rename_without_sync_is_found(folder):
    with pytest.raises(AssertionError, match="o.txt was renamed without being synced"):
        watched(folder, [sys.executable, "-c", "import os\nopen('a', 'w').write('x')\nos.rename('a', 'o.txt')"])
    with pytest.raises(AssertionError, match="the name .*o.txt was not synced"):
        watched(folder, [sys.executable, "-c", "import os\nf = open('a', 'w')\nf.write('x')\nf.flush()\n"
                         "os.fsync(f.fileno())\nos.rename('a', 'o.txt')"])
