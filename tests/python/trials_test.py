"""Trials with people, by an observer whose threshold is known."""

import contextlib
import copy
import importlib
import os
import subprocess
import sys
import warnings

import numpy
import pytest

import palpate
from palpate import RenderSetup, thresholds, trials
from palpate.__main__ import COMMANDS
from palpate.trials import Observer, Plan, fit, next_trial, psychometric, put, read, session, staircase


ADDRESS = "http://ann:S3CRET@127.0.0.1:9"


def test_touches_of_others_stay_and_those_of_an_interrupted_trial_go(tmp_path):
    plan, folder = Plan(0.3, differences=(0.5,), repeats=1), tmp_path / "p.touches"

    def ask(key):
        return trials.touching("synthetic:sphere:16x16x16", None, "simulated:hand=press", "stiffness", 0.3, folder, 0.45, key)(next_trial(plan, []))

    def interrupted(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ask(interrupted)
    assert not list(folder.iterdir())
    precious = folder / "0-1.csv"
    precious.write_text("mine")
    with pytest.raises(palpate.OutputError, match="is there already"):
        ask(lambda _: "1")
    assert precious.read_text() == "mine" and list(folder.iterdir()) == [precious]


@pytest.mark.parametrize("words", [[ADDRESS + "/v.zarr?sig=TOKEN9"], [ADDRESS], [ADDRESS + "/v.zarr?sig=TOKEN9@5"], ["v.nrrd", "a.csv", ADDRESS]])
def test_no_message_has_the_password_or_the_query_of_an_address(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) if len(words) > 1 else contextlib.nullcontext():
        assert trials.main([*words, "p.csv", "--standard", "0.3"]) != 0
    said = capsys.readouterr().err
    assert "127.0.0.1:9" in said and "S3CRET" not in said and "TOKEN9" not in said
    if len(words) == 1:
        with pytest.raises((ValueError, palpate.Error)) as error:
            palpate.subject(words[0])
        assert "S3CRET" not in str(error.value) and "TOKEN9" not in str(error.value)


@pytest.mark.parametrize("plan", [Plan(0.3), Plan(0.3, differences=(0.03, 0.06, 0.1, 0.2, 0.4), repeats=40)])
@pytest.mark.parametrize("threshold, slope", [(0.06, 2), (0.15, 2), (0.1, 1), (0.1, 4)])
def test_a_known_threshold_comes_back(tmp_path, plan, threshold, slope):
    found = []
    for seed in range(6):
        rows = session(tmp_path / f"{seed}.csv", Plan(**{**vars(plan), "seed": seed}), Observer(threshold, slope, seed))
        found.append(fit(rows)[0])
    assert numpy.exp(numpy.log(found).mean()) == pytest.approx(threshold, rel=0.3)


def simulated(plan, observer):
    rows = []
    while trial := next_trial(plan, [row["correct"] for row in rows]):
        rows.append({"difference": trial.difference, "correct": (observer(trial) == 2) == (trial.second > trial.first)})
    return rows


@pytest.mark.parametrize("plan", [dict(), dict(down=2, steps=(1.6, 1.2)), dict(differences=(0.03, 0.06, 0.1, 0.2, 0.4))], ids=str)
def test_intervals_contain_the_threshold_as_often_as_they_say(plan):
    """Of 100 intervals that cover 95 %, fewer than 90 contain the threshold in 1 of 35 such tests. With a bootstrap by trials, 85 did."""
    people, inside = [(0.06, 2), (0.1, 1.5), (0.1, 2), (0.1, 4), (0.2, 2)], 0
    for threshold, slope in people:
        for seed in range(20):
            _, low, high, _ = fit(simulated(Plan(0.3, seed=seed, **plan), Observer(threshold, slope, seed)))
            inside += low <= threshold <= high
    assert inside >= 90


def test_answers_that_do_not_bound_the_threshold_have_an_interval_without_bounds():
    plan = Plan(1.0, differences=(0.1, 0.2), repeats=20)
    _, low, high, _ = fit(simulated(plan, Observer(0.01)))
    assert low == 0 and high < 0.2
    _, low, high, _ = fit(simulated(plan, Observer(5.0)))
    assert low > 0.05 and numpy.isinf(high)


def test_a_staircase_goes_down_after_three_right_answers_and_up_after_a_wrong_one():
    plan = Plan(1.0, difference=0.4, most=100)
    assert staircase(plan, [1, 1]) == (0.4, [], 0)
    assert staircase(plan, [1, 1, 1]) == (0.2, [], 0)
    assert staircase(plan, [1, 1, 1, 0]) == (0.4, [0.2], 0)
    assert staircase(plan, [0, 0]) == (1.6, [], 0)
    assert staircase(Plan(1.0, difference=0.4), [0, 0, 0, 0]) == (1.0, [], 2)
    difference, reversals, _ = staircase(plan, [1, 1, 1, 0, 1, 1, 1])
    assert reversals == [0.2, 0.4] and difference == pytest.approx(0.4 / 1.3)
    assert staircase(Plan(1.0, difference=0.4, down=1, steps=(4, 2)), [1, 1]) == (0.025, [], 0)


@pytest.mark.parametrize("plan", [Plan(0.2), Plan(1 / 3, difference=0.1, most=2, seed=2**64 - 1, down=2, steps=[3, 1.5], reversals=7, trials=9),
                                  Plan(0.3, differences=[0.1, numpy.float64(0.2)], repeats=3)])
def test_a_file_has_its_plan_and_its_rows_are_checked_against_it(tmp_path, plan):
    path = tmp_path / "p.csv"
    rows = session(path, plan, Observer(0.1))
    again = Plan.of_text(rows[-1]["plan"])
    assert again.text == plan.text and read(path) == read(path, plan) == rows
    assert len(rows) == len(plan.differences) * plan.repeats or next_trial(again, [row["correct"] for row in rows]) is None
    text = path.read_text()
    number = rows[1]["difference"]
    path.write_text(text.replace(f"\n1,{number!r},", f"\n1,{number * 1.5!r},"))
    with pytest.raises(palpate.InputError, match="line 3: this is no trial of the plan"):
        read(path)
    path.write_text(text.replace("standard=", "standart="))
    with pytest.raises(palpate.InputError, match="line 2: this is no plan of trials: standart="):
        read(path)


def test_a_file_without_a_plan_opens_says_so_and_continues_as_it_began(tmp_path, recwarn):
    plan, path = Plan(0.3, seed=5), tmp_path / "old.csv"
    whole = session(tmp_path / "new.csv", plan, Observer(0.1))
    lines = [",".join(trials.COLUMNS[:-1]), *(",".join(str(row[name]) for name in trials.COLUMNS[:-1]) for row in whole)]
    path.write_text("\n".join(lines[:20]) + "\n")
    with pytest.warns(UserWarning, match="old.csv: the plan of its trials is missing"):
        assert len(read(path)) == 19
    recwarn.clear()
    rest = iter(whole[19:])
    rows = session(path, plan, lambda _: next(rest)["answer"])
    assert [{**row, "plan": plan.text} for row in rows] == whole and not recwarn and fit(rows) == fit(whole)
    assert {line.count(",") for line in path.read_text().splitlines()} == {len(trials.COLUMNS) - 2}


def test_a_last_line_without_its_end_is_ended_or_asked_again_and_never_continued(tmp_path):
    plan, path = Plan(0.2, differences=(0.25, 0.5), repeats=4), tmp_path / "p.csv"
    whole = session(path, plan, lambda trial: 1 + trial.trial % 2, "a ball, for 1 s")
    text = path.read_text()
    lengths = [*range(1, text.index("\n") + 2), *range(len(text) - 250, len(text))]
    for length in lengths:
        path.write_text(text[:length])
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            assert session(path, plan, lambda trial: 1 + trial.trial % 2, "a ball, for 1 s") == whole
        assert path.read_text() == text
        assert bool(said) == (text[length] != "\n" and text[length - 1] != "\n")
    path.write_text(text[:-1])
    with pytest.raises(palpate.InputError, match="not with a cube"):
        session(path, plan, lambda trial: 1, "a cube")
    with pytest.raises(palpate.InputError, match="another plan"):
        session(path, Plan(0.3), lambda trial: 1, "a ball, for 1 s")
    assert path.read_text() == text[:-1]


def test_an_answer_that_could_not_be_written_leaves_whole_lines(tmp_path):
    script = """
import resource, sys
from palpate.trials import Plan, session
plan = Plan(0.2, differences=(0.25, 0.5), repeats=8)
def ask(trial):
    if trial.trial == 3:
        size = sys.argv[1] and __import__("os").path.getsize(sys.argv[1])
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 20, -1))
    return 1
session(sys.argv[1], plan, ask)
"""
    path = tmp_path / "p.csv"
    done = subprocess.run([sys.executable, "-c", script, path], capture_output=True, text=True)
    assert "OutputError" in done.stderr and "cannot be written: File too large" in done.stderr
    assert path.read_bytes().endswith(b"\n") and len(read(path)) == 3


@pytest.mark.parametrize("most", [0.5, 1, 3])
def test_somebody_who_guesses_never_gets_more_than_the_plan_allows_and_is_soon_done(tmp_path, most):
    lengths = []
    for seed in range(20):
        random, plan = numpy.random.default_rng(seed), Plan(0.2, seed=seed, most=most)
        rows = session(tmp_path / f"{seed}.csv", plan, lambda _, random=random: 1 + int(random.integers(2)))
        lengths.append(len(rows))
        assert max(max(row["first"], row["second"]) for row in rows) <= 0.2 * (1 + most) + 1e-12
        assert sum(row["difference"] >= most for row in rows) <= plan.trials_at_most
    assert numpy.median(lengths) < 50


def test_a_threshold_beyond_the_differences_that_were_asked_is_no_number(tmp_path):
    plan = Plan(1.0, differences=(0.03, 0.06, 0.1), repeats=40)
    for threshold, known in ((0.06, True), (0.4, False), (0.005, False)):
        found, low, high, _ = fit(session(tmp_path / f"{threshold}.csv", plan, Observer(threshold)))
        assert numpy.isfinite(found) == known and low <= high


def test_an_interrupted_session_continues_as_if_it_had_not_been(tmp_path):
    plan = Plan(0.3, seed=5)
    answers = [1 + int(x) for x in numpy.random.default_rng(2).integers(0, 2, plan.trials)]
    whole = session(tmp_path / "whole.csv", plan, lambda trial: answers[trial.trial])

    def ends(trial):
        if trial.trial == 7:
            raise KeyboardInterrupt
        return answers[trial.trial]

    with pytest.raises(KeyboardInterrupt):
        session(tmp_path / "two.csv", plan, ends)
    assert len(read(tmp_path / "two.csv", plan)) == 7
    session(tmp_path / "two.csv", plan, lambda trial: answers[trial.trial])
    assert (tmp_path / "two.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert read(tmp_path / "two.csv", plan) == whole
    with pytest.raises(ValueError, match="no trial of the plan"):
        session(tmp_path / "two.csv", Plan(0.4, seed=5), lambda trial: 1)


def test_a_file_takes_one_session_at_a_time_and_one_setting_of_one_volume(tmp_path):
    plan, path = Plan(0.3, differences=(0.1, 0.3), repeats=2), tmp_path / "p.csv"

    def ask(trial):
        with pytest.raises(palpate.OutputError, match="another session"):
            session(path, plan, lambda trial: 1, "stiffness of a ball")
        return 1

    rows = session(path, plan, ask, "stiffness of a ball")
    assert read(path, plan) == rows and {row["felt"] for row in rows} == {"stiffness of a ball"}
    before = path.read_bytes()
    with pytest.raises(palpate.InputError, match="with stiffness of a ball, not with stiffness of a torus"):
        session(path, plan, ask, "stiffness of a torus")
    assert path.read_bytes() == before


def test_the_order_is_random_and_each_difference_is_asked_as_often():
    plan, seen = Plan(2.0, differences=(0.1, 0.3), repeats=30), []
    while trial := next_trial(plan, [1] * len(seen)):
        assert {trial.first, trial.second} == {2.0, 2.0 * (1 + trial.difference)}
        seen.append(trial)
    assert [t.difference for t in seen].count(0.1) == 30 == len(seen) / 2
    assert 15 < sum(t.first > t.second for t in seen) < 45
    assert [t.difference for t in seen] != sorted(t.difference for t in seen)


@pytest.mark.parametrize("text, said", [("", "no session"), ("a,b\n", "no session"), (",".join(trials.COLUMNS) + "\n0,0.5\n", "line 2"),
                                        (",".join(trials.COLUMNS) + "\n0,x,1,2,1,0\n", "line 2"),
                                        *((",".join(trials.COLUMNS[:-1]) + f"\n0,{row},felt\n", "line 2") for row in
                                          ("-0.5,1,2,2,1", "nan,1,2,2,1", "0.5,1,2,3,1", "0.5,1,2,2,5", "0.5,1,2,1,1"))])
def test_damaged_files_are_refused(tmp_path, text, said):
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(ValueError, match=said):
        read(tmp_path / "bad.csv")


def test_settings_are_found_by_name_and_plans_are_checked():
    setup = RenderSetup()
    put(setup, "force.damping", 0.001)
    put(setup, "stiffness", 0.7)
    assert setup.force.damping == 0.001 and setup.stiffness == 0.7
    with pytest.raises(ValueError, match="no setting"):
        put(setup, "force.stickiness", 1)
    for wrong in ({"standard": 0}, {"standard": 1, "difference": -1}, {"standard": 1, "repeats": 0}, {"standard": 1, "difference": 1.5},
                  {"standard": 1, "differences": (0.1, 3)}, {"standard": 1, "most": numpy.inf}, {"standard": 1, "steps": (1, 2)},
                  {"standard": 1, "steps": (2,)}, {"standard": 1, "down": 0}, {"standard": 1, "trials_at_most": 0}):
        with pytest.raises(ValueError):
            Plan(**wrong)
    assert psychometric(0.1, 0.1, 2) == pytest.approx(thresholds.GUESS + (0.5 - thresholds.LAPSE) * (2 * thresholds.AT - 1)) == pytest.approx(0.782, abs=1e-3)


def test_settings_that_are_none_by_default_are_numbers_too():
    setup = RenderSetup()
    put(setup, "friction.static_coefficient", 0.3)
    put(setup, "penetrability.threshold", 2)
    assert setup.friction == palpate.Friction(static_coefficient=0.3) and setup.penetrability.threshold == 2
    with pytest.raises(ValueError, match="did you mean force.damping"):
        put(setup, "force.dampng", 1)
    for name in ("tool", "layers", "friction", "colour.of.hat"):
        with pytest.raises(ValueError):
            put(setup, name, 0.5)


@pytest.mark.parametrize("name", ["rotational_stiffness", "rotational_damping", "torque_limit", "torque_rate_limit", "stale_after",
                                  "texture.wavelength", "magnet.peak"])
def test_a_setting_that_a_touch_with_a_point_cannot_show_is_refused(tmp_path, capsys, name):
    folder = tmp_path / "p.touches"
    with pytest.raises(ValueError, match=f"^force.{name}: two touches would feel the same: .* does nothing: ") as refused:
        trials.touching("synthetic:sphere:16x16x16", None, "simulated:hand=press", f"force.{name}", 0.2, folder, 1.5)
    assert "choose another tool" not in str(refused.value)  # a study has only the point
    words = ["synthetic:sphere:16x16x16", str(tmp_path / "p.csv"), "--setting", f"force.{name}", "--standard", "1"]
    assert trials.main(words) == 2 and capsys.readouterr().err == f"palpate: {refused.value}\n"
    assert not folder.exists()


@pytest.mark.parametrize("name", ["force.damping", "force.viscosity", "friction.static_coefficient", "penetrability.threshold",
                                  "force.texture.amplitude", "limit", "stiffness", "scale"])
def test_a_setting_that_a_touch_shows_is_not_refused(name):
    trials._refuse_without_difference(name, 0.4)


@pytest.mark.parametrize("answer", [True, numpy.True_, numpy.array([1]), "1", None, 3])
def test_only_1_or_2_is_an_answer_and_the_session_can_continue(tmp_path, answer):
    with pytest.raises(ValueError, match="ask\\(\\) has to return 1 or 2"):
        session(tmp_path / "t.csv", Plan(0.2, differences=(0.5,), repeats=1), lambda _: answer)
    assert len(session(tmp_path / "t.csv", Plan(0.2, differences=(0.5,), repeats=1), lambda _: numpy.float64(2))) == 1
    assert [row["answer"] for row in read(tmp_path / "t.csv")] == [2]
    assert (tmp_path / "t.csv").read_text().splitlines()[1].split(",")[4] == "2"


BALL = ("synthetic:sphere:24x24x24", "x.csv", "--standard", "0.2")


@pytest.mark.parametrize("words, status, said", [
    (BALL[:1], 2, "FILE: it is needed"), ((*BALL, "--secnds", "1"), 2, "there is no option --secnds: did you mean --seconds?"),
    ((*BALL[:2], "--standard", "x"), 2, "--standard: 'x' is not a number"),
    ((BALL[0] + "@abc", *BALL[1:]), 2, "'abc' is not a level"), ((*BALL, "--seconds", "0"), 2, "0 is not a number above 0"),
    ((*BALL, "--setting", "stifness"), 2, "did you mean stiffness?"), ((*BALL, "--device", "haplo"), 2, "no device"),
    ((BALL[0], "nowhere/x.csv", *BALL[2:]), 5, "nowhere/x.csv: cannot be written"),
    (("--analyse", "nowhere.csv"), 3, "nowhere.csv: No such file"), (("--analyse", "text.csv"), 3, "no session of trials")],
    ids=lambda given: given if isinstance(given, str) else "")
def test_what_is_wrong_is_said_in_a_line(tmp_path, monkeypatch, capsys, words, status, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "text.csv").write_text("a,b\n")
    try:
        assert trials.main(words) == status
    except SystemExit as end:
        assert end.code == status
    told = capsys.readouterr().err
    assert told.startswith("palpate: ") and said in told and told.count("\n") == 1


@pytest.mark.parametrize("given, level", [("", None), ("@50%", "50%"), ("@60", "60")])
def test_the_level_is_the_suggested_one_a_number_or_a_percentage(tmp_path, monkeypatch, given, level):
    made = []

    def touching(volume, level, *rest):
        made.append((volume, level))
        palpate.Run(palpate.load(volume), palpate.Setup(isovalue=level))
        return lambda trial: 1

    monkeypatch.setattr(trials, "touching", touching)
    assert trials.main((BALL[0] + given, str(tmp_path / "x.csv"), *BALL[2:], "--differences", "0.5", "--repeats", "1")) == 0
    assert made == [(BALL[0], level)]


def test_a_device_that_tells_only_once_it_is_connected_that_it_is_too_weak_ends_the_session(tmp_path, monkeypatch):
    class Weak(palpate.Run):
        def __enter__(self):
            run, limits = super().__enter__(), copy.copy(self.device.limits)
            limits.physical_damping = 1e-4
            run.send(limits)
            return run

    ask = trials.touching(palpate.sample_volume(), 34.5, "simulated:hand=press", "stiffness", 0.3, tmp_path, 0.4, key=lambda _: "1")
    assert ask(trials.Trial(0, 1.0, 0.4, 0.2)) == 1
    monkeypatch.setattr(palpate, "Run", Weak)
    with pytest.raises(ValueError, match="0.4: the device renders only 0.1 stably"):
        ask(trials.Trial(1, 1.0, 0.4, 0.2))


def test_a_person_at_the_keys_touches_answers_and_is_analysed(tmp_path):
    def start(*words, keys=""):
        return subprocess.run([os.environ["PALPATE"], "study", *words], cwd=tmp_path, input=keys, text=True,
                              capture_output=True, check=False, env=os.environ)

    run = (f"{palpate.sample_volume()}@34.5", "p.csv", "--standard", "0.2", "--differences", "0.5", "--repeats", "2",
           "--seconds", "0.2")
    whole = start(*run, keys="x\n1\n2\n")
    assert whole.returncode == 0 and whole.stderr.endswith("complete: 2 trials. To fit a threshold: palpate study --analyse p.csv\n")
    rows = read(tmp_path / "p.csv")
    assert [row["answer"] for row in rows] == [1, 2] and {rows[0]["first"], rows[0]["second"]} == {0.2, 0.2 * 1.5}
    touches = sorted((tmp_path / "p.touches").iterdir())
    assert [path.name for path in touches] == ["0-1.csv", "0-2.csv", "1-1.csv", "1-2.csv"]
    assert all(palpate.read_recording(path).trace.force.any() for path in touches)
    # A hand far from the head feels nothing and is asked again, until the keys end.
    (tmp_path / "air.csv").write_text("t,x,y,z\n0,0,0,500\n9,0,0,500\n")
    air = start(run[0], "r.csv", *run[2:], "--device", f"simulated:file={tmp_path / 'air.csv'}", keys="\n")
    assert air.stderr.endswith("palpate: standard input ended before an answer\n")
    assert air.returncode == 2 and air.stderr.count("touch 2") == 2 and read(tmp_path / "r.csv") == []
    full = ("bash", "-c", '"$PALPATE" study "$@" <<< 1 >/dev/full', "bash", run[0], "f.csv", *run[2:])
    told = subprocess.run(full, cwd=tmp_path, text=True, stderr=subprocess.PIPE, check=False)
    assert told.returncode == 5 and told.stderr.endswith("touch 2\npalpate: standard output: No space left on device\n")
    stiff = start(run[0], "s.csv", "--standard", "2", "--device", "simulated:touch,jitter=no,hand=press", "--seconds", "0.2", keys="1\n")
    assert stiff.returncode == 2 and "stiffness [N/mm] = 4: must be at most 3.6" in stiff.stderr and "touch 1" not in stiff.stderr
    for name in ("limit", "force.limit"):
        strong = start(run[0], "l.csv", "--setting", name, "--standard", "3", "--most", "0.5", "--seconds", "0.2", keys="1\n")
        assert strong.returncode == 2 and f"{name} = 4.5: the device renders at most 3.3" in strong.stderr
    lost = start("lost.nrrd@35", *run[1:], keys="")
    assert lost.returncode == 3 and lost.stderr.startswith("palpate: lost.nrrd: does not exist")
    session(tmp_path / "q.csv", Plan(0.3), Observer(0.1))
    few = start("--analyse", "q.csv", "p.csv")
    assert few.returncode == 3 and few.stderr.startswith("palpate: p.csv: 10 trials") and few.stdout == ""
    line = start("--analyse", "q.csv").stdout.splitlines()[1].split(",")
    assert line[0] == "q.csv" and float(line[3]) <= float(line[2]) <= float(line[4])


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_in_python_is_known_to_the_program_by_its_own_words(command):
    def said(*words):
        return subprocess.run([os.environ["PALPATE"], *words], text=True, capture_output=True, check=True).stdout

    assert f"  {command:<27} {said(command, '--help').splitlines()[0]}\n" in said("--help")
    assert said(command, "--version") == said("--version")


@pytest.mark.parametrize("command", COMMANDS)
def test_values_that_are_impossible_are_refused_in_a_line_and_examples_are_taken(command, capsys):
    parser = importlib.import_module(f"palpate.{COMMANDS[command]}").PARSER

    def refused(*words):
        with pytest.raises(SystemExit) as end:
            parser.arguments(words)
        told = capsys.readouterr().err
        assert end.value.code == 2 and told.startswith("palpate: ") and told.count("\n") == 1 and len(told) < 420
        return told

    for action in parser.needed * 2:  # the second time as well
        assert "it is needed" in refused()
    for action in parser._actions:
        if not (action.type and action.option_strings):
            continue
        option = action.option_strings[-1]
        assert f"{option}: the value is empty" in refused(option, "")
        assert f"{option} needs a value: {action.help}" in refused(option)
        for value in ("nan", "1e400", "1,5", "0x10") if action.type.shown.startswith(("FLOAT", "UINT")) else ():
            assert f"{option}: " in refused(option, value)
    for example in parser.examples:
        parser.arguments([word for word in example.split()[2:] if ":=" not in word])


@pytest.mark.parametrize("words, text", [
    ("study head.nrrd p.csv", "--standard: it is needed, as in palpate study head.nrrd@34.5 p01.csv --standard 0.3 --difference 0.5"),
    ("study --standard 1 --standard 2", "--standard: it is given more than once"),
    ("study --analyse p.csv --seed 3", "--analyse stands alone, without seed"),
    ("study a b c", "'c' is one argument too many"),
    ("distribute a b --prefilter=3", "--prefilter: this option takes no value"),
    ("distribute a b --compression gzp",
     "--compression: there is no 'gzp': use one of none, gzip, zstd, blosc (did you mean gzip?)"),
    ("distribute a b --workers 2 --scheduler tcp://x:1", "--scheduler and --workers exclude each other"),
    ("ros", "VOLUME: it is needed, as in palpate ros head.nrrd --device haply"),
    ("ros a --arm /a --device haply", "--arm and --device exclude each other"),
    ("ros a --axes x,y", "--axes: 'x,y' are no axes of a rotation: each one is needed once, and not mirrored")])
def test_a_wrong_command_line_is_answered_in_one_line(words, text):
    ran = subprocess.run([os.environ["PALPATE"], *words.split()], text=True, capture_output=True, check=False)
    assert (ran.returncode, ran.stderr, ran.stdout) == (2, f"palpate: {text} (see palpate {words.split()[0]} --help)\n", "")


def test_constant_differences_need_not_reach_the_first_one_of_a_staircase():
    assert next_trial(Plan(0.3, differences=(0.1, 0.2), repeats=1, most=0.3), []).difference <= 0.2
    for plan in (dict(differences=(0.1, 0.4)), dict(difference=0.4)):
        with pytest.raises(ValueError, match="differences have to be at most 0.3"):
            Plan(0.3, most=0.3, **plan)


@pytest.mark.parametrize("words, told", [
    (["--repeats", "3"], "--repeats does nothing: it is for --differences"),
    (["--difference", "0.3", "--differences", "0.4"], "--difference does nothing: --differences has them all")])
def test_an_option_that_does_nothing_is_warned_of(tmp_path, capsys, words, told):
    assert trials.main(["synthetic:none", str(tmp_path / "p.csv"), "--standard", "0.3", *words]) != 0
    assert f"palpate: warning: {told}\n" in capsys.readouterr().err


def test_a_warning_is_one_line_as_those_of_the_commands_in_c(tmp_path):
    words = ["study", "synthetic:sphere:16x16x16@9999", "p.csv", "--standard", "0.3", "--seconds", "0.1"]
    done = subprocess.run([os.environ["PALPATE"], *words], cwd=tmp_path, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    warned = [line for line in done.stderr.splitlines() if "9999" in line]
    assert len(warned) == 1 and warned[0].startswith("palpate: warning: isovalue 9999 (data 0 to ") and ".py" not in done.stderr
