"""Edits of a Run that were not saved: a word when they are lost, and a file that has them after an error. A program of its own makes
each of them, because most are told of when it ends."""

import os
import re
import subprocess
import sys
import time

import numpy
import palpate
import pytest

EDITED, UNSAVED = 200, "the edits of synthetic:sphere:16x16x16 were not saved"
BEGIN = f"""
import sys, palpate
def edited(data=None):
    run = palpate.Run(data or palpate.load("synthetic:sphere:16x16x16"), palpate.Setup(real_time=False))
    run.edit(palpate.Fill((0, 0, 0), (2, 2, 2), {EDITED}))
    return run
def fails(call):
    try:
        call()
    except Exception as e:
        return e
    raise SystemExit("it did not fail")
"""


def told(folder, program, *options, **places):
    """What a program says of its edits, and the files that it left."""
    places = {"TMPDIR": str(folder), "HOME": str(folder), **places}
    ran = subprocess.run([sys.executable, "-B", *options, "-c", BEGIN + program], env={**os.environ, **places}, cwd=folder,
                         stderr=subprocess.PIPE, text=True, timeout=300, check=False)
    return re.findall("[A-Za-z]*Warning: .*", ran.stderr), [path for path in folder.rglob("*.nrrd")]


@pytest.mark.parametrize("program", [
    "run = edited(); run.start(); raise RuntimeError",
    "run = edited(); raise RuntimeError",
    "def work():\n    run = edited()\n    raise KeyboardInterrupt\nwork()",
    "run = edited()\ndef work():\n    with run:\n        raise RuntimeError\nfails(work)",
    "run = edited(); fails(lambda: run.save('nowhere/a.nrrd')); del run; print('end')",
    "run = edited(); run.save('nowhere/../a.nrrd')",
    "run = edited(); other = palpate.Run(run); fails(lambda: other.save('nowhere/a.nrrd')); del run, other",
])
def test_edits_are_kept_after_an_error(tmp_path, program):
    (text,), (file,) = told(tmp_path, program)
    assert text == f"UserWarning: {UNSAVED}; they are kept in {file}"
    assert file.name == "edits.nrrd" and oct(file.parent.stat().st_mode)[-3:] == "700"
    assert (palpate.load(file).volume.array[:3, :3, :3] == EDITED).all()


@pytest.mark.parametrize("program", ["run = edited(); run.start()", "run = edited()", "run = edited(); del run; print('end')",
                                     "run = edited(); run.save('a.mha'); run.edit(palpate.Fill((5, 5, 5), (6, 6, 6), 1))"])
def test_edits_that_nobody_saved_are_a_resource_warning(tmp_path, program):
    assert told(tmp_path, program, "-W", "default") == ([f"ResourceWarning: {UNSAVED}: Run.save() keeps them"], [])
    assert told(tmp_path, program) == ([], [])  # as Python is used


def test_the_last_run_on_the_data_tells(tmp_path):
    first = "run = edited(); other = palpate.Run(run); del run; "
    program = first + "other.save('a.mha')"
    assert told(tmp_path, program, "-W", "default") == ([], [])
    assert len(told(tmp_path, first + "del other", "-W", "default")[0]) == 1


@pytest.mark.parametrize("program", [
    "run = edited(); run.save('a.mha'); raise RuntimeError",
    "run = edited(); run.undo(); raise RuntimeError",
    "run = edited(); fails(lambda: run.save('nowhere/a.mha')); run.save('a.mha')",
    "run = palpate.Run(palpate.load('synthetic:beating:9x9x9'), palpate.Setup(real_time=False)); raise RuntimeError",
    "run = edited()\nimport os\nif os.fork() == 0: raise RuntimeError\nos.wait(); run.save('a.mha')",
])
def test_nothing_is_told_of_edits_that_are_not_lost(tmp_path, program):
    assert told(tmp_path, program, "-W", "default") == ([], [])


def test_where_they_can_be_kept_nowhere_that_is_told(tmp_path):
    program = "import os; os.mkdir('gone'); os.chdir('gone'); os.rmdir('../gone'); run = edited(); raise RuntimeError"
    (text,), files = told(tmp_path, program, TMPDIR="/dev/null", HOME="/dev/null")
    assert text.startswith(f"UserWarning: {UNSAVED}; they could not be kept elsewhere: ") and files == []


def test_a_warning_that_is_an_error_ends_nothing(tmp_path):
    assert len(told(tmp_path, "run = edited(); fails(lambda: run.save('nowhere/a.nrrd')); del run", "-W", "error")[1]) == 1


def test_samples_that_are_sent_to_a_run_are_what_it_edits_shows_and_saves(tmp_path):
    ball, ring = (palpate.scene(f"{name}:24x24x24").volume for name in ("sphere", "torus"))
    with palpate.Run(palpate.LoadedVolume(ball, isovalue=80), palpate.Setup(real_time=False)) as run:
        run.send(palpate.command.Samples(palpate.Samples(ring)))
        while not (run.snapshot() and run.snapshot().version == 1):
            time.sleep(0.005)
        centre = run.field().geometry.centre
        assert run.field().value([centre]) == palpate.Field(ring).value([centre])
        run.edit(palpate.Fill((0, 0, 0), (1, 1, 1), 7))
        expected = ring.array.copy()
        expected[:2, :2, :2] = 7
        run.save(tmp_path / "ring.nrrd")
        assert numpy.array_equal(palpate.load(tmp_path / "ring.nrrd").volume.array, expected)
        assert run.undo() and run.undo() and not run.undo()
        assert run.field().value([centre]) == palpate.Field(ball).value([centre])
        moving = palpate.Samples([(0.0, ball), (0.5, ring)], period=1)
        with pytest.raises(ValueError, match="those of one moment"):
            run.send(palpate.command.Samples(moving))
