"""A study on Dask has the traces of one machine, and keeps those that are there and whole."""

import os
import signal

import distributed
import numpy
import palpate
import pytest
from palpate.study import study

SETUPS = {"soft": {"stiffness": 0.2}, "hard": {"stiffness": 1.0}, "paper": {"method": "paper"},
          "rough": palpate.RenderSetup(friction=palpate.Friction(static_coefficient=0.5,
                                                                 dynamic_coefficient=0.4)),
          "ball": {"tool": "sphere:2"}}
SOURCE = "synthetic:torus:40x40x40"
FIELD = {"interpolation": "linear"}


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster:
        with distributed.Client(cluster) as connected:
            yield connected


@pytest.fixture(scope="module")
def motion():
    scene = palpate.scene("torus:40x40x40")
    settings = palpate.MotionSettings(duration_s=0.5, seed=9)
    return scene.isovalue, *palpate.motion("slide", palpate.Field(scene.volume), scene.isovalue, settings)


def same(trace, other):
    return all(numpy.array_equal(getattr(trace, name), getattr(other, name))
               for name in ("t", "hip", "scp", "force", "torque", "density", "constrained", "contacts",
                            "proxy_orientation_xyzw"))


def on_one_machine(setup, motion, field):
    own = {"setup": setup} if isinstance(setup, palpate.RenderSetup) else setup
    return palpate.replay(palpate.Field(palpate.load(SOURCE).volume, **field), *motion, **own)


def test_traces_have_the_bits_of_one_machine_though_a_worker_is_killed(client, motion, tmp_path):
    setups = {name: setup for name, setup in SETUPS.items() if name != "ball"}
    killed = []

    def kill(stage, done, count):
        assert (stage, count) == ("study", 4)
        if not killed:
            killed.append(list(client.run(os.getpid).values())[0])
            os.kill(killed[0], signal.SIGKILL)

    traces = study(client, os.fsencode(SOURCE), *motion, setups, tmp_path, field=FIELD, progress=kill)
    assert killed and list(traces) == list(setups)
    for name, trace in traces.items():
        one = on_one_machine(setups[name], motion, FIELD)
        assert trace.constrained.any() and same(trace, one), name
        assert trace.summary["largest_force"] == one.summary["largest_force"]
    assert not same(traces["soft"], traces["hard"])


def test_what_is_there_and_whole_is_kept_and_a_setup_is_added(client, motion, tmp_path):
    first = {name: SETUPS[name] for name in ("soft", "hard", "rough")}
    study(client, SOURCE, *motion, first, str(tmp_path))
    before = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    damaged = bytearray((tmp_path / "hard.npz").read_bytes())
    damaged[len(damaged) // 2] ^= 1
    (tmp_path / "hard.npz").write_bytes(damaged)
    second = {**first, "soft": {"stiffness": 0.3}, "ball": SETUPS["ball"]}
    traces = study(client, SOURCE, *motion, second, str(tmp_path))
    after = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert sorted(after) == ["ball.npz", "hard.npz", "rough.npz", "soft.npz"]
    assert [name for name in before if after[name] == before[name]] == ["rough.npz"]
    for name, trace in traces.items():
        assert same(trace, on_one_machine(second[name], motion, {})), name
    assert traces["ball"].has_tool and traces["ball"].contacts.max() > 0


@pytest.mark.parametrize("given", [lambda tool: {"tool": str(tool)}, lambda tool: palpate.RenderSetup(tool=str(tool))])
def test_a_trace_is_made_again_when_the_file_of_its_tool_has_changed(client, motion, tmp_path, given):
    tool, made = tmp_path / "tool.csv", []
    for radius in (1, 1, 3):
        tool.write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in palpate.Tool.named(f"sphere:{radius}", 1.0).points))
        made.append(study(client, SOURCE, *motion, {"ball": given(tool)}, tmp_path / "out")["ball"])
    assert same(made[0], made[1]) and not same(made[1], made[2])
    assert same(made[2], on_one_machine({"tool": str(tool)}, motion, {}))


def test_wrong_names_and_fields_are_refused_before_anything_runs(client, motion, tmp_path):
    with pytest.raises(ValueError, match="names of files"):
        study(client, SOURCE, *motion, {"../up": {}}, str(tmp_path / "out"))
    with pytest.raises(TypeError, match="no argument colour"):
        study(client, SOURCE, *motion, {"a": {"colour": 1}}, str(tmp_path / "out"))
    with pytest.raises(palpate.InputError, match="gone.nrrd"):
        study(client, str(tmp_path / "gone.nrrd"), *motion, {"a": {}}, str(tmp_path / "out"))
    assert not list(tmp_path.rglob("*.npz"))
    (tmp_path / "file").touch()
    with pytest.raises(palpate.OutputError, match="file: is no folder"):
        study(client, SOURCE, *motion, {"a": {}}, tmp_path / "file")


@pytest.mark.parametrize("written, read", [("v.nrrd", "v.nrrd"), ("v.nhdr", "v.nhdr"), ("v.mhd", "v.mhd"), ("v_01.nrrd", "v_%02d.nrrd")])
def test_a_file_that_changed_is_read_again_by_the_same_workers(client, tmp_path, written, read):
    time, position = numpy.arange(50) / 1000, numpy.linspace((-20, 0, 0), (-2, 0, 0), 50)
    for level in (100, 150):
        samples = numpy.where(palpate.scene("sphere:16x16x16").volume.array > level, 200, 0).astype("uint8")
        if level == 150 and written in ("v.nhdr", "v.mhd"):  # the header stays as it was
            (tmp_path / "v.raw").write_bytes(samples.tobytes())
        else:
            palpate.write(palpate.Volume(samples, origin=(-8, -8, -8)), tmp_path / written)
        made = study(client, tmp_path / read, 100, time, position, {"one": {}}, tmp_path / "out")["one"]
        one = palpate.replay(palpate.Field(palpate.load(tmp_path / read).volume), 100, time, position)
        assert one.constrained.any() and same(made, one)
