"""Work that outgrows one machine, on Dask: pyramids of volumes, dequantizing, smoothing, and studies of
settings (docs/beyond_one_machine.md).

    palpate distribute SOURCE OUT.zarr --dequantize 40 --workers 4

Workers and the program that starts them see the same files under the same names. The results have the
bits of one machine. What an earlier run has finished, and is found whole, is kept.
"""

import contextlib
import dataclasses
import functools
import json
import os
import pickle
import shutil
import socket
import sys
import threading
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

import numpy

from . import InputError, Volume, __version__, _palpate, open_store, sharpened, smoothed
from .command_line import Kind, Parser, one_of, remark, run, say, tell, whole

if TYPE_CHECKING:  # help needs no Dask
    from distributed import Client

# What a block reads round itself while it is dequantized: more means fewer stages, each with more to
# do twice [samples].
HALO = 40
SITE_STEPS = (16, 8, 4, 2)
Progress = Optional[Callable[[str, int, int], Any]]
Name = Union[str, bytes, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class Converted:
    """What convert() has done. blocks: pieces of work; kept: of these, from an earlier run; range: of
    the finest level [data units]."""
    levels: int
    blocks: int
    kept: int
    range: tuple[float, float]


@functools.lru_cache(maxsize=4)
def _opened(source, options, seen_files):
    return open_store(source, **pickle.loads(options))


@dataclasses.dataclass(frozen=True)
class _Job:
    """All that a worker has to know."""
    source: str
    options: bytes  # of open_store(), pickled
    seen: str  # of the source's files and content
    level: int
    folder: str  # of the image, while it grows
    work: str  # of what is thrown away at the end, in the same folder
    type: str
    smooth: int
    prefilter: bool
    chunk: int
    compression: str
    ome_version: str

    def store(self):
        return _opened(self.source, self.options, self.seen)

    def image(self, stage):
        """The finished image, or one between two stages of dequantizing, which has one level."""
        # A worker that was taken for dead may write the same as another one.
        mark = f".part-{socket.gethostname()}-{os.getpid()}-{threading.get_ident()}"
        grid = self.store().levels[self.level]
        if stage.startswith("level"):
            return _palpate._GrowingImage(self.folder, self.type, grid, self.ome_version, self.chunk,
                                          self.compression, mark)
        return _palpate._GrowingImage(self.state(stage), "int16", grid, "0.5", self.chunk, "none", mark)

    def state(self, stage):
        return str(Path(self.work) / f"{stage}.zarr")

    def folder_of(self, stage):
        return self.folder if stage.startswith("level") else self.state(stage)

    def record(self, stage, block):
        return self.records(stage) / "-".join(str(corner) for corner in block[0])

    def records(self, stage):
        return Path(self.work) / "records" / stage


def _grown(block, halo, size):
    low, high = block
    return (tuple(max(a - halo, 0) for a in low), tuple(min(b + halo, s) for b, s in zip(high, size)))


def _cut(volume, around, block):
    """The samples of `block` out of a volume that has those of `around`."""
    x, y, z = (slice(low - start, high - start)
               for low, high, start in zip(block[0], block[1], around[0]))
    return Volume(numpy.ascontiguousarray(volume.array[z, y, x]))


def _put(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    _palpate._write_file(path, text)


def _get(path):
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None


def _sum_of(volume):
    return f"{zlib.crc32(numpy.ascontiguousarray(volume.array)):08x}"


# ---- What workers do -----------------------------------------------------------------------------------

def _survey(job, block):
    """The values and the sites of a block, for the plan of dequantizing."""
    record = job.record("survey", block)
    found = _get(record)
    if found and found[8:9] == " " and f"{zlib.crc32(found[9:].encode()):08x}" == found[:8]:
        return True, json.loads(found[9:])
    size = tuple(int(n) for n in job.store().levels[job.level].size)
    around = _grown(block, 2 * max(SITE_STEPS), size)
    part = job.store().read(*around, level=job.level)
    own = _cut(part, around, block)
    said = {"values": _palpate._values_of(own).tolist(), "sites": {}}
    for step in SITE_STEPS:
        columns = _palpate._sites_of(part, around[0], size, *block, step)
        said["sites"][str(step)] = [column.tolist() for column in columns]
    text = json.dumps(said)
    _put(record, f"{zlib.crc32(text.encode()):08x} {text}")
    return False, said


def _dequantize(number, plan, rounds, job, block):
    """A stage of dequantizing: `rounds` of a block, from the stage before."""
    store = job.store()
    reach = sum(map(_palpate._reach_of, rounds)) + _palpate._TERRACE_REACH
    around = _grown(block, reach, store.levels[job.level].size)
    samples = store.read(*around, level=job.level)
    state = open_store(job.state(f"state-{number - 1}")).read(*around) if number > 0 else None
    state = _palpate._rounds_of(samples, state, around[0], store.levels[job.level].size, plan, rounds)
    return _cut(state, around, block)


def _finest(state, job, block):
    """A block of the finest level: of the last stage or of the source, smoothed and sharpened."""
    store = job.store()
    around = _grown(block, job.smooth + job.prefilter, store.levels[job.level].size)
    volume = store.read(*around, level=job.level)
    if state:
        stage, plan = state
        volume = _palpate._moved_samples(volume, open_store(job.state(stage)).read(*around), plan)
    volume = smoothed(volume, job.smooth)
    if job.prefilter:
        volume = sharpened(volume)
    own = _cut(volume, around, block)
    return own if own.type == job.type else Volume(own.array.astype(job.type))


def _make(job, stage, level, compute, only_verify, block):
    """Makes a block of an image, unless it is there and whole. (kept, range), or None for one that is
    not whole and was only to be verified."""
    record = job.record(stage, block)
    before = _get(record)
    if before:
        with contextlib.suppress(InputError):
            there = open_store(job.folder_of(stage)).read(*block, level=level)
            if _sum_of(there) == before:
                return True, (there.minimum, there.maximum)
    if only_verify:
        return None
    image = job.image(stage)
    if compute:
        made = compute(job, block)
        image.write(block[0], made)
    else:
        image.make_coarser(level, *block)
        made = open_store(job.folder_of(stage)).read(*block, level=level)
    _put(record, _sum_of(made))
    return False, (made.minimum, made.maximum)


# ---- What the program that starts them does ------------------------------------------------------------

def _version():
    return __version__


def check_workers(client):
    """Workers of another version would compute other bits."""
    others = {name: found for name, found in client.run(_version).items() if found != __version__}
    if others:
        name, found = next(iter(others.items()))
        raise ValueError(f"{len(others)} workers have another version of Palpate than {__version__} "
                         f"({name}: {found}): install the same one everywhere")


def each_piece(client, stage, function, blocks, progress):
    """function(work) for all pieces of work on the workers; their results, in no order."""
    from distributed import as_completed
    futures = client.map(function, blocks, pure=False)
    results = []
    try:
        for _, result in as_completed(futures, with_results=True):
            results.append(result)
            if progress:
                progress(stage, len(results), len(blocks))
    except BaseException:
        client.cancel(futures)
        raise
    return results


def _blocks(size, edge):
    """(low, high) of boxes that cover a grid; the high corner is not in it."""
    starts = [range(0, int(n), edge) for n in size]
    return [((x, y, z), tuple(min(a + edge, int(n)) for a, n in zip((x, y, z), size)))
            for z in starts[2] for y in starts[1] for x in starts[0]]


def _stages(rounds):
    """Rounds (step, count, way) one by one, in lists of which each reaches no farther than HALO."""
    stages, reach = [], HALO + 1
    for step, count, way in rounds:
        pieces = [(step, 1, way)] if way == _palpate._DOWN else [(step, 0, way)] + count * [(step, 1, _palpate._STAY)]
        for piece in pieces:
            if reach + _palpate._reach_of(piece) > HALO:
                stages.append([])
                reach = 0
            reach += _palpate._reach_of(piece)
            stages[-1].append(piece)
    return stages


def _plan(surveys, rounds, whole_numbers):
    """What dequantizing has to know of the whole volume; None where its samples lie on no levels."""
    values = [numpy.asarray(s["values"]) for s in surveys]
    if not all(len(v) for v in values):
        return None  # a part has more values than levels can have
    values = functools.reduce(numpy.union1d, values)
    level = _palpate._level_of(values, whole_numbers) if len(values) <= 65536 else None
    if level is None:
        return None

    def sites(step):
        parts = [[numpy.asarray(c, dtype=float) for c in s["sites"][str(step)]] for s in surveys]
        at = numpy.concatenate([part[0].reshape(-1, 3) for part in parts])
        order = numpy.lexsort((at[:, 0], at[:, 1], at[:, 2]))  # x is fastest
        return tuple(numpy.concatenate([part[c] for part in parts])[order] for c in (1, 2))

    return _palpate._DequantizePlan(level, values[0], values[-1], rounds, sites)


class _Conversion:
    def __init__(self, client, job, edge, progress):
        self.client, self.job, self.progress = client, job, progress
        self.edge = edge
        self.grid = job.store().levels[job.level]
        self.done = self.kept = 0

    def count(self, results):
        self.done += len(results)
        self.kept += sum(kept for kept, _ in results)

    def each(self, stage, level, compute=None, only_verify=False, size=None):
        function = functools.partial(_make, self.job, stage, level, compute, only_verify)
        blocks = _blocks(self.grid.size if size is None else size, self.edge)
        name = f"{stage}, verifying" if only_verify else stage
        results = each_piece(self.client, name, function, blocks, self.progress)
        if not only_verify:
            self.count(results)
        return results

    def dequantize(self, rounds):
        """Brings the volume through all stages; the name of the last one and the plan, None if there is
        none."""
        surveys = each_piece(self.client, "survey", functools.partial(_survey, self.job),
                             _blocks(self.grid.size, self.edge), self.progress)
        self.count(surveys)
        plan = _plan([said for _, said in surveys], rounds, self.job.store().type != "float32")
        if plan is None:
            return None
        stages = _stages(plan.rounds)
        for number in range(self.first_stage(len(stages)), len(stages)):
            stage = f"state-{number}"
            self.job.image(stage).write_metadata()
            compute = functools.partial(_dequantize, number, plan, stages[number])
            self.each(stage, 0, compute)
            if number > 0:
                self.forget(f"state-{number - 1}")
        return f"state-{len(stages) - 1}", plan

    def first_stage(self, count):
        """The first stage that is not whole but whose forerunner is."""
        for number in range(count - 1, -1, -1):
            if not Path(self.job.state(f"state-{number}")).exists():
                continue
            there = self.each(f"state-{number}", 0, only_verify=True)
            if all(there):
                self.count(there)
                return number + 1
        return 0

    def forget(self, stage):
        shutil.rmtree(self.job.records(stage), ignore_errors=True)
        shutil.rmtree(self.job.state(stage), ignore_errors=True)

    def run(self, rounds):
        job = self.job
        state = self.dequantize(rounds) if rounds else None
        image = job.image("level-0")
        image.write_metadata()
        finest = self.each("level-0", 0, functools.partial(_finest, state))
        for level in range(1, len(image.levels)):
            self.each(f"level-{level}", level, size=image.levels[level].size)
        ranges = numpy.array([found for _, found in finest])
        found = (float(ranges[:, 0].min()), float(ranges[:, 1].max()))
        image.write_metadata(found)
        return Converted(len(image.levels), self.done, self.kept, found)


@contextlib.contextmanager
def _growing(out, job):
    """OUT.partial, locked; afterwards its result is OUT. New, unless an earlier run had the same job."""
    folder = _palpate._GrowingFolder(out, job)
    try:
        if folder.note:
            tell(f"note: {folder.note}")
        yield
        for left in Path(_result(out)).rglob("*.part-*"):  # of workers that were killed
            left.unlink()
        folder.put_in_place()
    finally:
        folder.close()


def _result(out):
    return f"{out}.partial/result"


def _work(out):
    return f"{out}.partial/work"


def convert(client: Union["Client", Callable[[], "Client"]], source: Name, out: Name, *, level: int = 0, dequantize: int = 0,
            smooth: int = 0, prefilter: bool = False, chunk: int = 64, compression: str = "zstd",
            ome_version: str = "0.5", block: int = 256, options: Optional[dict] = None,
            progress: Progress = None) -> Converted:
    """Writes a level of a store as multiscale OME-Zarr, on the workers of a Dask client: the files of
    `palpate convert` with the same options, byte for byte.

    client: may be a function that starts one, which is called when source, settings and output were
    found good. source: what open_store() opens, with `options` for it (raw, spacing, channel, time).
    dequantize: rounds (40; 0: none), smooth: passes, prefilter: sharpened(); in this order. block:
    samples of a piece of work along each axis, a multiple of chunk; a task takes about 12 bytes for
    each of (block + 64)^3 samples. progress(stage, done, all) may raise to stop; the next call with the same
    arguments goes on. Raises InputError, OutputError, ValueError.
    """
    source, out = os.fsdecode(source), os.path.abspath(os.fsdecode(out))
    if not source.startswith(("http://", "https://", "s3://")):
        source = os.path.abspath(source)
    if block < 1 or chunk < 1 or block % chunk:
        raise ValueError(f"block is a multiple of chunk ({chunk}), not {block}")
    if not 0 <= smooth <= 64 or not 0 <= dequantize <= 1000:
        raise ValueError("smooth is 0 to 64 passes, dequantize 0 to 1000 rounds")
    store = open_store(source, **(options or {}))
    kind = "float32" if dequantize or smooth or prefilter else store.type
    content = _palpate._content_of(store, level)
    seen = f"{_palpate._files_at(source)} {content}"
    job = _Job(source, pickle.dumps(options or {}), seen, level, _result(out), _work(out), kind,
               smooth, prefilter, chunk, compression, ome_version)
    job.image("level-0")  # refuses a wrong format before anything is made
    work = json.dumps([__version__, repr(job), dequantize, block])
    _palpate._check_resumable(out, work)
    client = client() if callable(client) else client
    check_workers(client)
    with _growing(out, work):
        return _Conversion(client, job, block, progress).run(dequantize)


PARSER = Parser("distribute", "Write a store as multiscale OME-Zarr on the workers of a Dask cluster, as palpate convert writes it", (
    "source.zarr head.zarr --dequantize 40 --workers 4", "source.zarr head.zarr --smooth 1 --scheduler tcp://HOST:8786"))
PARSER.add("source", kind=Kind("FOLDER"), help="Store that every worker sees under this name or web address")
PARSER.add("out", kind=Kind("FOLDER"), help="OME-Zarr to write. The same command continues an interrupted run")
PARSER.add("--level", kind=whole(), default=0, help="Level of detail of the source, 0 for the finest")
PARSER.add("--dequantize", kind=whole(), default=0, help="Rounds that remove the terraces of rounded data, such as 40")
PARSER.add("--smooth", kind=whole(), default=0, help="Smooth the samples this many times, up to 64")
PARSER.add_argument("--prefilter", action="store_true", help="Sharpen the samples for the smooth field")
PARSER.add("--chunk", kind=whole(1), default=64, help="Samples of a chunk along each axis")
PARSER.add("--block", kind=whole(), default=256, help="Samples of a piece of work along each axis, a multiple of the chunk")
PARSER.add("--compression", kind=one_of(_palpate._COMPRESSIONS), default="zstd", help="Compression of the chunks")
PARSER.add("--ome-version", kind=one_of(("0.4", "0.5")), default="0.5", help="Version of OME-Zarr")
PARSER.add("--scheduler", kind=Kind("ADDRESS"), help="Address of a running Dask, tcp://HOST:8786")
PARSER.add("--workers", kind=whole(1), help="Processes on this machine instead (default: one per core)")


def _convert(scheduler, workers, given):
    from distributed import Client, LocalCluster

    def progress(stage, done, count):
        if sys.stderr.isatty() or done == count:
            remark(f"\r{stage}: {done} of {count}", end="\n" if done == count else "")

    def started():
        cluster = scheduler or stack.enter_context(LocalCluster(
            n_workers=workers or os.cpu_count() or 1, threads_per_worker=1, dashboard_address="127.0.0.1:0"))
        try:
            client = stack.enter_context(Client(cluster))
        except OSError as error:
            raise ValueError(f"--scheduler {scheduler}: does not answer: start one with 'dask scheduler' and give its address, or give "
                             "--workers instead") from error
        remark(f"dashboard: {client.dashboard_link}")
        return client

    with contextlib.ExitStack() as stack:
        done = convert(started, progress=progress, **given)
    say(f"{given['out']}: OME-Zarr {given['ome_version']}, {done.levels} levels, {done.blocks} blocks ({done.kept} kept from before)",
        last=True)


def main(words):
    given = vars(PARSER.arguments(words))
    scheduler, workers, _, _ = (given.pop(name) for name in ("scheduler", "workers", "help", "version"))
    if scheduler and workers:
        PARSER.error("--scheduler and --workers exclude each other")
    return run(lambda: _convert(scheduler, workers, given), "interrupted; the same command continues")
