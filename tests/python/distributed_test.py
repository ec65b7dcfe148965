"""Work on Dask has the bytes of one machine, though a worker is killed or the program stopped."""

import os
import pathlib
import re
import signal
import subprocess
import time

import distributed
import numpy
import palpate
import pytest
from palpate import _palpate
from palpate.distributed import HALO, _stages, convert

PROGRAM = os.environ["PALPATE"]


@pytest.fixture(scope="module")
def cluster():
    """Two worker processes, like two machines with one file system."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as local:
        yield local


@pytest.fixture
def client(cluster):
    with distributed.Client(cluster) as connected:
        yield connected


def ball(folder, kind="uint8", size=(70, 50, 60)):
    """A file whose samples are not compressed, of a ball on a gentle slope."""
    x, y, z = (numpy.arange(n) - n / 2 for n in size)
    r = numpy.sqrt(x ** 2 + y[:, None] ** 2 + z[:, None, None] ** 2)
    values = numpy.clip(120 - 2.6 * r, 0, 255)
    if kind == "mask":
        values, kind = 255 * (r < 20), "uint8"
    if kind == "float32":
        values = values + 0.1 * numpy.sin(x)
    path = folder / "ball.nrrd"
    palpate.write(palpate.Volume(values.astype(kind), spacing=(0.5, 0.5, 0.7), origin=(1, 2, 3)), path)
    return str(path)


def files(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in pathlib.Path(folder).rglob("*")
            if p.is_file()}


def on_one_machine(source, out, *options):
    subprocess.run([PROGRAM, "convert", "-q", source, out, *options], check=True)
    return files(out)


@pytest.mark.parametrize("kind, given", [
    ("int16", {}), ("uint16", {"smooth": 3}), ("uint8", {"dequantize": 4}), ("mask", {"dequantize": 5}),
    ("float32", {"dequantize": 3}), ("uint8", {"dequantize": 2, "smooth": 1, "prefilter": True})])
def test_every_filter_and_type_has_the_bytes_of_one_machine(client, tmp_path, kind, given):
    source = ball(tmp_path, kind)
    words = [f"--{name}" + ("" if value is True else f"={value}") for name, value in given.items()]
    expected = on_one_machine(source, tmp_path / "one.zarr", "--chunk", "16", *words)
    done = convert(client, source, str(tmp_path / "many.zarr"), chunk=16, block=32, **given)
    assert files(tmp_path / "many.zarr") == expected
    assert done.kept == 0 and done.blocks > 12
    assert sorted(p.name for p in tmp_path.iterdir()) == ["ball.nrrd", "many.zarr", "one.zarr"]


def test_a_level_of_a_zarr_has_the_bytes_of_one_machine(client, tmp_path):
    source = str(tmp_path / "source.zarr")
    on_one_machine(ball(tmp_path), source, "--chunk", "16", "--ome-version", "0.4")
    expected = on_one_machine(source, tmp_path / "one.zarr", "--chunk", "8", "--level", "1",
                              "--compression", "blosc", "--ome-version", "0.4")
    convert(client, pathlib.Path(source), os.fsencode(tmp_path / "many.zarr"), level=1, chunk=8, block=16, compression="blosc",
            ome_version="0.4")
    assert files(tmp_path / "many.zarr") == expected


def test_a_worker_that_is_killed_on_the_way_changes_no_byte(client, tmp_path):
    source = ball(tmp_path)
    expected = on_one_machine(source, tmp_path / "one.zarr", "--chunk", "16", "--dequantize=8")
    processes = client.run(os.getpid)
    killed = []

    def kill(stage, done, count):
        if stage in ("state-1", "level-0") and done == 3 and len(killed) < 2:
            killed.append(list(client.run(os.getpid).values())[0])
            os.kill(killed[-1], signal.SIGKILL)

    convert(client, source, str(tmp_path / "many.zarr"), chunk=16, block=32, dequantize=8, progress=kill)
    assert len(killed) == 2 and killed[0] in processes.values()
    assert files(tmp_path / "many.zarr") == expected


def stop_at(stage, count):
    def progress(now, done, _):
        if now == stage and done == count:
            raise KeyboardInterrupt
    return progress


@pytest.mark.parametrize("stage", ["survey", "state-0", "state-2", "level-0", "level-1"])
def test_a_run_that_was_stopped_is_continued_with_what_is_whole(client, tmp_path, stage):
    source, out = ball(tmp_path), str(tmp_path / "many.zarr")
    expected = on_one_machine(source, tmp_path / "one.zarr", "--chunk", "16", "--dequantize=8")
    with pytest.raises(KeyboardInterrupt):
        convert(client, source, out, chunk=16, block=32, dequantize=8, progress=stop_at(stage, 1 if stage == "level-1" else 4))
    assert not os.path.exists(out)
    if stage == "level-1":  # a chunk that is damaged is made again
        chunk = pathlib.Path(f"{out}.partial") / "result/0/c/1/1/1"
        data = bytearray(chunk.read_bytes())
        data[len(data) // 2] ^= 1
        chunk.write_bytes(data)
    done = convert(client, source, out, chunk=16, block=32, dequantize=8)
    # Survey, the last whole stage or the levels before, and what there is of this one.
    assert done.kept >= {"survey": 4, "state-0": 12 + 4, "state-2": 12 + 4, "level-0": 12 + 4,
                         "level-1": 12 + 11 + 1}[stage]
    assert files(out) == expected


def test_other_work_is_not_continued(client, tmp_path):
    source, out = ball(tmp_path), str(tmp_path / "many.zarr")
    with pytest.raises(KeyboardInterrupt):
        convert(client, source, out, chunk=16, block=32, progress=stop_at("level-0", 5))
    palpate.write(palpate.Volume(palpate.load(source).volume.array + numpy.uint8(1)), source)
    assert convert(client, source, out, chunk=16, block=32).kept == 0
    assert palpate.open_store(out).range[0] == 1


def no_client():
    pytest.fail("a cluster was started before all else was found good")


def test_a_folder_of_somebody_else_is_refused_before_a_cluster_is_started_and_stays(tmp_path):
    source, precious = ball(tmp_path), tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("years")
    (tmp_path / "linked.zarr.partial").symlink_to(precious)
    (tmp_path / "folder.zarr.partial").mkdir()
    (tmp_path / "folder.zarr.partial" / "thesis.txt").write_text("years")
    for name in ("linked.zarr", "folder.zarr"):
        with pytest.raises(palpate.OutputError, match=f"{name}.partial: is a"):
            convert(no_client, source, str(tmp_path / name), chunk=16, block=32)
        assert (tmp_path / f"{name}.partial" / "thesis.txt").read_text() == "years"


def test_an_interrupted_run_with_a_foreign_file_is_refused_before_a_cluster_is_started(client, tmp_path):
    source, out = ball(tmp_path), str(tmp_path / "foreign.zarr")
    with pytest.raises(KeyboardInterrupt):
        convert(client, source, out, chunk=16, block=32, progress=stop_at("level-0", 5))
    foreign = tmp_path / "foreign.zarr.partial" / "thesis.txt"
    foreign.write_text("years")
    with pytest.raises(palpate.OutputError, match="thesis.txt: was not written by Palpate"):
        convert(no_client, source, out, chunk=16, block=64)
    assert foreign.read_text() == "years"


def test_other_work_that_looks_the_same_is_not_continued(client, tmp_path):
    source, out = ball(tmp_path), str(tmp_path / "many.zarr")
    with pytest.raises(KeyboardInterrupt):
        convert(client, source, out, chunk=16, block=32, progress=stop_at("level-0", 5))
    before = os.stat(source)
    palpate.write(palpate.Volume(palpate.load(source).volume.array + numpy.uint8(1), spacing=(0.5, 0.5, 0.7),
                                 origin=(1, 2, 3)), source)
    os.utime(source, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert os.stat(source).st_size == before.st_size
    assert convert(client, source, out, chunk=16, block=32).kept == 0
    assert palpate.open_store(out).range[0] == 1


def test_what_is_there_and_what_cannot_be_is_refused_in_a_line(client, tmp_path):
    def started():
        pytest.fail("a cluster was started for what cannot be written")

    source, out = ball(tmp_path), tmp_path / "out.zarr"
    with pytest.raises(ValueError, match="multiple of chunk"):
        convert(client, source, str(out), chunk=16, block=40)
    with pytest.raises(ValueError, match="no compression"):
        convert(client, source, str(out), compression="rar")
    with pytest.raises(ValueError, match="there is no level 2"):
        convert(client, source, str(out), level=2)
    with pytest.raises(palpate.InputError, match="does not exist"):
        convert(client, str(tmp_path / "gone.nrrd"), str(out))
    with pytest.raises(palpate.OutputError, match="choose another folder"):
        convert(started, source, str(tmp_path / "no" / "out.zarr"))
    assert [p.name for p in tmp_path.iterdir()] == ["ball.nrrd"]
    out.mkdir()
    with pytest.raises(palpate.OutputError, match="is there already"):
        convert(started, source, str(out))


def test_a_worker_of_another_version_is_refused(client, tmp_path):
    def become(version):
        import palpate.distributed
        palpate.distributed.__version__ = version

    name = list(client.run(os.getpid))[0]
    client.run(become, "0.0.1", workers=[name])
    try:
        with pytest.raises(ValueError, match="1 workers have another version .*: 0.0.1"):
            convert(client, ball(tmp_path), str(tmp_path / "out.zarr"))
    finally:
        client.run(become, palpate.__version__, workers=[name])
    assert [p.name for p in tmp_path.iterdir()] == ["ball.nrrd"]


def test_stages_hold_all_rounds_in_their_order_and_reach_no_farther_than_the_halo():
    down, stay, up = 0, 1, 2
    rounds = [(1, 1, down), (2, 1, down), (4, 1, down), (8, 1, down), (16, 2, stay), (8, 4, up), (4, 6, up), (2, 24, up), (1, 40, up)]
    stages = _stages(rounds)
    pieces = [piece for stage in stages for piece in stage]
    assert [step for step, count, way in pieces for _ in range(count)] == [step for step, count, way in rounds for _ in range(count)]
    assert [step for step, count, way in pieces if way == up] == [8, 4, 2, 1]
    assert all(count == 0 for step, count, way in pieces if way == up)
    assert [step for step, count, way in pieces if way == down] == [1, 2, 4, 8]
    assert all(sum(_palpate._reach_of(piece) for piece in stage) <= HALO for stage in stages)
    assert len(stages) <= 13


def test_the_program_says_in_a_line_what_is_wrong_and_goes_on_after_a_stop(tmp_path):
    source, out = ball(tmp_path), tmp_path / "out.zarr"
    command = [PROGRAM, "distribute", source, out, "--chunk", "16", "--block", "16",
               "--dequantize", "4", "--workers", "1"]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    records = pathlib.Path(f"{out}.partial", "work", "records", "state-0")
    while running.poll() is None and not (records.exists() and any(records.iterdir())):
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate()
    assert running.returncode == 130 and "the same command continues" in said
    again = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert int(re.search(r"\((\d+) kept", again.stdout)[1]) > 60
    assert files(out) == on_one_machine(source, tmp_path / "one.zarr", "--chunk", "16", "--dequantize=4")
    command[2] = tmp_path / "nowhere.zarr"
    missing = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True)  # before a cluster is started
    assert missing.returncode == 3 and missing.stderr.startswith("palpate: ") and missing.stderr.count("\n") == 1
    command[2] = source
    refused = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True)
    assert refused.returncode == 5 and "is there already" in refused.stderr
    assert "Traceback" not in refused.stderr
