"""The experiment recorded: its files, the modelled hand, scanned surfaces and planes."""

import dataclasses

import numpy
import palpate
import pytest

from palpate.evaluate import bodies, human, recorded
from palpate.evaluate.experiment import Options, Table
from palpate.evaluate.subjects import of_text


def write(recording, path):
    rows = numpy.column_stack([recording.time, recording.position, recording.force])
    numpy.savetxt(path, rows, fmt=["%.3f"] + 6 * ["%.4f"], header=" ".join(recorded.COLUMNS), comments="# ")


def test_a_recording_reads_back_as_it_was_written_and_damage_is_named(tmp_path):
    made = recorded.modelled(1, 1)
    write(made, tmp_path / "hand.traj")
    again = recorded.read(tmp_path / "hand.traj")
    assert again.name == "hand" and abs(again.position - made.position).max() < 1e-4 and abs(again.force - made.force).max() < 1e-4
    (tmp_path / "other.traj").write_text("% fx fy fz t x y z extra\n1, 2, 3, 0.5, 7, 8, 9, 0\n1 2 3 0.6 7 8 9 0\n")
    other = recorded.read(tmp_path / "other.traj")
    assert (other.force == [1, 2, 3]).all() and (other.position == [7, 8, 9]).all() and list(other.time) == [0.5, 0.6]
    for text, said in (("0 1 2 3 4 5 6\n1 2 3\n", "line 2"), ("0 1 2 3 4 5 six\n", "line 1"), ("0 1 2 3 4 5 6\n", "two samples"),
                       ("0 1 2 3 4 5 6\n0 1 2 3 4 5 6\n", "rise"), ("0 1 2 3 4 5 6\n1 1 2 3 4 5 nan\n", "finite")):
        (tmp_path / "bad.traj").write_text(text)
        with pytest.raises(ValueError, match=said):
            recorded.read(tmp_path / "bad.traj")


def test_a_modelled_hand_trembles_reacts_late_and_presses_as_wanted():
    person, random = human.Human(), numpy.random.default_rng(3)
    shaking = human.trembling(person, random, 8000)
    frequency = numpy.fft.rfftfreq(8000, 1 / human.RATE)
    power = (abs(numpy.fft.rfft(shaking, axis=0))**2).sum(axis=1)
    assert power[(frequency > 6) & (frequency < 15)].sum() > 0.9 * power.sum()
    tip, force = human.press(person, random, 6, 1.5, 10, 0.2)
    pressed = force[:, 2] > 0
    assert (tip[pressed, 2] <= 0).all() and (force[~pressed] == 0).all() and 0.4 < pressed.mean() < 0.95
    assert (numpy.linalg.norm(force[:, :2], axis=1) <= 0.2 * force[:, 2] + 1e-12).all()
    assert force[int(5.5 * human.RATE):, 2].mean() == pytest.approx(1.5, rel=0.15)
    # A hand that does not react does the same until the reaction to the first touch.
    numb, alive = (human.press(dataclasses.replace(person, gain=gain), numpy.random.default_rng(3), 2, 1.5, 10, 0.2) for gain in (0, 2))
    touched, differs = (numpy.flatnonzero(changed)[0] / human.RATE for changed in (
        alive[1][:, 2] > 0, abs(alive[0] - numb[0]).max(axis=1) > 0))
    assert differs - touched == pytest.approx(person.delay, abs=2e-3)


def test_a_free_hand_trembles_as_much_as_people_do():
    person = human.Human(gain=0)
    free, calm = (human.press(dataclasses.replace(person, tremor=tremor), numpy.random.default_rng(3), 12, 1.5, 1e-9, 0)[0][human.RATE:, :2]
                  for tremor in (person.tremor, 0))
    wide = human.in_band(free - calm, (4, 24), "bandpass")
    assert numpy.sqrt((wide**2).mean(axis=0)) == pytest.approx(person.tremor, rel=0.15)
    assert numpy.sqrt(((free - calm - wide)**2).mean()) < 0.25 * person.tremor


def test_a_scanned_ball_is_felt_as_it_was_recorded(tmp_path):
    angle = numpy.linspace(0, 6, 500)
    out = bodies.around(angle, 0.3 * numpy.sin(3 * angle))
    out /= numpy.linalg.norm(out, axis=1, keepdims=True)
    pressure = 1 + 0.5 * numpy.sin(5 * angle)
    ball = of_text("synthetic:sphere:48x48x48")
    mesh = palpate.extract(ball.field, ball.isovalue)
    radius = numpy.linalg.norm(mesh.vertices, axis=1).mean()
    folder = tmp_path / "ball"
    folder.mkdir()
    write(recorded.Recording("ball", angle, radius * out, pressure[:, None] * out), folder / "probe.traj")
    mesh.write(folder / "ball.obj")
    recording, surface = list(recorded.recordings_of(Options(quick=True, seeds=0, data=tmp_path)))[-1]
    assert recording.name == "ball" and surface.name == "scanned"
    on, normal = surface.nearest(1.2 * radius * out)
    assert abs(numpy.linalg.norm(on, axis=1) - radius).max() < 0.1 and (normal * out).sum(axis=1).min() > 0.98
    assert (surface.height(0.8 * radius * out) < 0).all() and (surface.height(1.2 * radius * out) > 0).all()
    rows = Table(row for row, _ in recorded.rows_of(recording, surface, "float32", 1.5))
    exact = rows.where(method="exact")[0]
    assert exact["contact_share"] == 1 and exact["mean_force_n"] == pytest.approx(1, abs=0.1)
    assert exact["force_n_rms"] < 0.1 and exact["position_mm_rms"] < 0.3
    with pytest.raises(ValueError, match="ball: only 0 of 500 samples .* outwards"):  # it would have nothing to render
        recorded.device_of(recording._replace(force=-recording.force), surface)


def test_a_shifted_surface_is_an_error_of_its_spring_in_the_metrics_of_recordings():
    made = recorded.modelled(2, 2)
    off = recorded.metrics("off", made.force, made.force + [0, 3, 4])
    assert off == pytest.approx({"off_mean": 5, "off_rms": 5, "off_max": 5})
    plane = recorded.plane_through(made)
    out, hands, force = recorded.device_of(made, plane)
    sunk = numpy.linalg.norm(out - hands, axis=1)
    assert abs(sunk - numpy.linalg.norm(force, axis=1) / recorded.STIFFNESS).max() < 1e-9 and sunk.max() > 1
    with pytest.raises(ValueError, match="hardly touches"):
        recorded.plane_through(made._replace(force=0 * made.force))
    pulled = made._replace(force=-made.force)  # the force on the surface, which is not that on the hand
    with pytest.raises(ValueError, match="outwards"):
        recorded.device_of(pulled, recorded.plane_through(pulled))


def test_the_page_says_which_recordings_were_read(tmp_path):
    assert recorded.origin_of([]).startswith("None were available")
    (tmp_path / "mine").mkdir()
    write(recorded.modelled(1, 2), tmp_path / "mine/probe.traj")
    made = " ".join(recorded.run(Options(quick=True, seeds=1, data=tmp_path)).paragraphs)
    assert "From there: mine. The others here are modelled." in made and "None were available" not in made


def test_a_recording_without_friction_fails_no_claim(tmp_path):
    made = recorded.modelled(1, 2)
    _, _, normal_force = recorded.device_of(made, recorded.plane_through(made))
    (tmp_path / "mine").mkdir()
    write(made._replace(force=normal_force), tmp_path / "mine/probe.traj")
    claims = list(recorded.run(Options(quick=True, seeds=1, data=tmp_path)).claims)
    assert len(claims) == 4 and all("control" not in claim.statement or claim.held for claim in claims)
