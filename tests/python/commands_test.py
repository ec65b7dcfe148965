"""Commands in Python: whatever goes wrong is one line with its exit status, options that change nothing are warned of, and names of
files may be any bytes."""

import csv
import io
import os
import subprocess
import sys

import palpate
import pytest
from palpate import command_line, distributed, trials
from palpate.evaluate import __main__ as program
from palpate.evaluate import drift
from palpate.ros import __main__ as ros

ODD = os.fsdecode(b"caf\xe9")


def failing(error):
    def work():
        raise error
    return work


@pytest.mark.parametrize("error, status, told", [
    (MemoryError(), 3, "not enough memory: use a smaller volume, or one of fewer bits"), (palpate.InputError("a: is bad"), 3, "a: is bad"),
    (palpate.DeviceError("no arm"), 4, "no arm"), (OSError("full"), 5, "full"), (ValueError("wrong"), 2, "wrong"),
    (KeyError("x"), 2, "KeyError: 'x' (PALPATE_TRACEBACK=1 shows where)"),
    (type("KilledWorker", (Exception,), {})("3 times\nat a"), 2, "KilledWorker: 3 times at a (PALPATE_TRACEBACK=1 shows where)")], ids=str)
def test_whatever_goes_wrong_is_one_line_and_never_a_claim_that_does_not_hold(capsys, monkeypatch, error, status, told):
    monkeypatch.setattr(command_line.signal, "signal", lambda *of: None)
    assert command_line.run(failing(error)) == status
    assert capsys.readouterr().err == f"palpate: {told}\n"


def test_a_traceback_is_shown_on_request(capsys, monkeypatch):
    monkeypatch.setattr(command_line.signal, "signal", lambda *of: None)
    monkeypatch.setenv("PALPATE_TRACEBACK", "1")
    assert command_line.run(failing(KeyError("x"))) == 2
    assert "in work" in capsys.readouterr().err


@pytest.mark.parametrize("words, warned", [
    ("head.nrrd --model omega7 --pose-rate 10 --axes x,y,z", "--axes, --pose-rate, --model do nothing: there is no --arm"),
    ("head.nrrd --model omega7", "--model does nothing: there is no --arm"), ("head.nrrd --arm /left --model omega7", None)])
def test_options_for_an_arm_of_ros_are_warned_of_without_one(capsys, words, warned):
    ros.arguments_from(words.split())
    assert capsys.readouterr().err == (f"palpate: warning: {warned}\n" if warned else "")


@pytest.mark.parametrize("words, warned", [
    ("drift --quick", "--quick uses no real volume"), ("drift", None), ("recorded --quick", None), ("all --quick", None),
    ("walk-through", "it is for drift, performance, scaling, penetration, layers, notice, recorded")])
def test_a_folder_of_data_that_no_experiment_reads_is_warned_of(tmp_path, capsys, words, warned):
    chosen = program.arguments([*words.split(), "--data", str(tmp_path)])
    program.warn_of_no_effect(chosen, program.names_of(chosen))
    assert capsys.readouterr().err == (f"palpate: warning: --data does nothing: {warned}\n" if warned else "")


@pytest.mark.parametrize("error", [palpate.InputError("lobster.nrrd: is damaged"), ValueError("a defect")], ids=str)
def test_all_ends_with_an_experiment_that_fails(tmp_path, monkeypatch, error):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(program, "EXPERIMENTS", ("drift", "penetration"))
    monkeypatch.setattr(drift, "run", lambda options: failing(error)())
    words = ["all", "--quick", "-q", "-o", "found"]
    with pytest.raises(type(error), match=str(error)):
        program.evaluate(program.arguments(words), words)


@pytest.mark.parametrize("text", [b"0 1 2 3 4 5 6\n1 2 3\n", b"0 1 2 3 4 5 6\n", b"0 1 2 3 4 5 6\n1 2 3 4 5 6 \xff\n"], ids=repr)
def test_a_bad_recording_is_named_with_its_folder(tmp_path, text):
    (tmp_path / "plane0").mkdir()
    (tmp_path / "plane0/probe.traj").write_bytes(text)
    ran = subprocess.run([sys.executable, "-B", "-m", "palpate.evaluate", "recorded", "--quick", "--data", tmp_path], cwd=tmp_path,
                         stderr=subprocess.PIPE, text=True, check=False)
    assert ran.returncode == 3 and ran.stderr.startswith(f"palpate: {tmp_path}/plane0/probe.traj") and ran.stderr.count("\n") == 1


def test_a_scheduler_that_does_not_answer_is_told_with_the_remedy(monkeypatch, tmp_path, capsys):
    dask = pytest.importorskip("dask")
    pytest.importorskip("distributed")
    palpate.write(palpate.scene("sphere:8x8x8").volume, tmp_path / "a.nrrd")
    subprocess.run([os.environ["PALPATE"], "convert", tmp_path / "a.nrrd", tmp_path / "a.zarr", "-q"], check=True)
    with dask.config.set({"distributed.comm.timeouts.connect": "100ms"}):
        status = distributed.main([str(tmp_path / "a.zarr"), str(tmp_path / "b.zarr"), "--scheduler", "tcp://127.0.0.1:1"])
    told = capsys.readouterr().err.splitlines()[-1]
    assert status == 2 and told.startswith("palpate: --scheduler tcp://127.0.0.1:1: does not answer: start one with 'dask scheduler'")


@pytest.mark.parametrize("answer", ["2", 0, 3, None], ids=repr)
def test_an_answer_other_than_1_or_2_is_refused_and_not_in_the_file(tmp_path, answer):
    plan, path = trials.Plan(0.3, differences=(0.1,), repeats=1), tmp_path / "p.csv"
    with pytest.raises(ValueError, match="has to return 1 or 2, not"):
        trials.session(path, plan, lambda trial: answer)
    assert trials.read(path) == []


def test_a_session_on_a_file_whose_name_is_no_text_continues_and_is_analysed(tmp_path):
    plan, path = trials.Plan(0.3, differences=(0.1, 0.4), repeats=20), tmp_path / f"{ODD},1.csv"
    observer, asked = trials.Observer(0.03), []

    def ask(trial):
        asked.append(trial)
        if len(asked) == 3:
            raise KeyboardInterrupt
        return observer(trial)

    with pytest.raises(KeyboardInterrupt):
        trials.session(path, plan, ask, f"stiffness of {ODD}")
    rows = trials.session(path, plan, ask, f"stiffness of {ODD}")
    assert len(rows) == 40 and len(asked) == 41 and {row["felt"] for row in trials.read(path, plan)} == {f"stiffness of {ODD}"}
    ran = subprocess.run([sys.executable, "-B", "-m", "palpate", "study", "--analyse", path], stdout=subprocess.PIPE, check=True)
    table = list(csv.reader(io.StringIO(ran.stdout.decode(errors="surrogateescape"))))
    assert table[0][0] == "file" and table[1][:2] == [str(path), "40"] and len(table[1]) == len(table[0])


@pytest.mark.parametrize("setting, standard, fits", [("force.limit", 20, False), ("force.limit", 1, True)])
def test_a_setting_that_the_device_cannot_render_is_refused_before_the_first_touch(tmp_path, setting, standard, fits):
    def touching():
        return trials.touching("synthetic:sphere:16x16x16", None, "simulated:hand=press", setting, 0.1, tmp_path, 2 * standard)
    if fits:
        touching()
    else:
        with pytest.raises(ValueError, match=f"^{setting} = .*: the device renders at most"):
            touching()


def test_a_session_does_not_continue_with_another_device(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(trials, "touching", lambda *of: lambda trial: 1)
    words = ["synthetic:sphere:16x16x16", str(tmp_path / "p.csv"), "--standard", "0.3", "--differences", "0.5", "--repeats", "1"]
    assert trials.main([*words, "--device", "simulated"]) == 0 == trials.main([*words, "--device", "simulated"])
    assert trials.main([*words, "--device", "haply"]) == 3
    assert "by simulated for 3 s, not with stiffness of" in capsys.readouterr().err
