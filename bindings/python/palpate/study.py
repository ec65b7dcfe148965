"""Studies on Dask: one motion of the hand under many settings, a trace for each, on all workers
(docs/beyond_one_machine.md)."""

import functools
import hashlib
import io
import json
import os
import pickle
import re
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Optional, Union

import numpy
from distributed import Client

from . import Field, RenderSetup, Trace, __version__, _palpate, load, replay
from .distributed import Name, Progress, check_workers, each_piece
from .errors import OutputError
from .trace import COLUMNS
from .whole_files import make_folder


@functools.lru_cache(maxsize=1)
def _field(source, options, files):
    """A worker feels the same volume again and again, until its files change (`files` tells them)."""
    loading, feeling = pickle.loads(options)
    return Field(load(source, **loading).volume, **feeling)


def _files_of(source):
    """A source's files: those of a numbered series, and those that a header without samples names."""
    folder, name = os.path.split(source)
    number = re.search(r"%(0\d+)?d", name)
    if number and os.path.isdir(folder):
        fits = re.compile(re.escape(name[:number.start()]) + r"\d+" + re.escape(name[number.end():]))
        return [os.path.join(folder, one) for one in sorted(os.listdir(folder)) if fits.fullmatch(one)]
    if not name.lower().endswith((".nhdr", ".mhd")) or not os.path.isfile(source):
        return [source]
    with open(source, encoding="utf-8", errors="replace") as file:
        lines = file.read(1 << 20).splitlines()
    named = (os.path.join(folder, re.split("[:=]", line)[-1].strip()) for line in lines)
    return [source, *filter(os.path.isfile, named)]


def _named_files(value):
    """(name, SHA-256) of each file that settings name, such as that of a tool, however deep they are nested."""
    if isinstance(value, (str, bytes, os.PathLike)):
        try:
            return [(os.fsdecode(value), hashlib.sha256(Path(os.fsdecode(value)).read_bytes()).hexdigest())]
        except (OSError, ValueError):  # another text than the name of a file
            return []
    if isinstance(value, Mapping):
        parts = value.values()
    elif isinstance(value, (list, tuple)):
        parts = value
    else:
        parts = [getattr(value, name) for name in getattr(type(value), "_fields", ())]
    return [file for part in parts for file in _named_files(part)]


def _write(path, key, trace):
    """Whole or not at all; `key` says of what."""
    rest = json.dumps({"key": key, "summary": trace.summary, "layer_names": list(trace.layer_names),
                       "nested_layers": trace.nested_layers, "has_tool": trace.has_tool})
    arrays = {name: getattr(trace, name) for name in COLUMNS}
    numpy.savez_compressed(packed := io.BytesIO(), rest=rest, **arrays)
    _palpate._write_file(path, packed.getvalue())


def _read(path):
    """(key, Trace); None for a file that is not there or not whole: its parts have checksums."""
    try:
        with numpy.load(path) as file:
            rest = json.loads(str(file["rest"]))
            arrays = {name: file[name] for name in COLUMNS}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error):
        return None
    return rest["key"], Trace(**arrays, summary=rest["summary"], has_tool=rest["has_tool"],
                              layer_names=tuple(rest["layer_names"]),
                              nested_layers=rest["nested_layers"])


def _replay(source, options, files, isovalue, motion, folder, work):
    name, key, setup = work
    path = Path(folder) / f"{name}.npz"
    before = _read(path)
    if before and before[0] == key:
        return True
    time, position, orientation = motion
    trace = replay(_field(source, options, files), isovalue, time, position, orientation_xyzw=orientation,
                   setup=setup)
    _write(path, key, trace)
    return False


def study(client: Client, source: Name, isovalue: Union[float, str], time: Any, position: Any,
          setups: Mapping[str, Union[RenderSetup, Mapping[str, Any]]], out: Name, *,
          orientation_xyzw: Any = None, field: Optional[dict] = None, loading: Optional[dict] = None,
          progress: Progress = None) -> dict[str, Trace]:
    """replay() of one motion under each of the setups, on the workers of a Dask client: a Trace for
    each name, with the bits of one machine (but for update_ns and the times in the summary).

    source: what load() reads, with `loading` for it (smooth=1, dequantize=40, ...); field: of Field
    (solid, background, interpolation). isovalue, time, position, orientation_xyzw: as for replay().
    setups: a RenderSetup or its fields by name. out: a folder that gets NAME.npz for each; traces that
    are there already, whole and of the same work with the same files, are kept. progress('study', done, all) may raise to
    stop. Raises ValueError, InputError, OutputError.
    """
    source, out = os.fsdecode(source), os.fsdecode(out)
    for name in setups:
        if not re.fullmatch(r"\w[\w.+=,-]*", name):
            raise ValueError(f"{name!r}: names of setups become names of files: letters, digits and _.+=,-")
    files = []
    if "://" not in source and not source.startswith(("synthetic:", "live:")):
        source = os.path.abspath(source)
        files = [(file, _palpate._files_at(file)) for file in _files_of(source)]
    made = {name: setup if isinstance(setup, RenderSetup) else RenderSetup(**setup)
            for name, setup in setups.items()}
    motion = [numpy.ascontiguousarray(a, dtype=float) if a is not None else None
              for a in (time, position, orientation_xyzw)]
    options = pickle.dumps((loading or {}, field or {}))
    same = hashlib.sha256(pickle.dumps(("xyzw", __version__, source, files, isovalue, options, _named_files([loading, field]))))
    files = same.hexdigest()
    for array in motion:
        same.update(b"none" if array is None else array.tobytes())
    work = []
    for name, setup in made.items():
        key = same.copy()
        key.update(pickle.dumps((setup, _named_files(setup))))
        work.append((name, key.hexdigest(), setup))
    check_workers(client)
    folder = os.path.abspath(out)
    try:
        make_folder(Path(folder))
    except OSError as error:
        raise OutputError(f"{out}: is no folder, and cannot be made one: {error.strerror}") from error
    one = functools.partial(_replay, source, options, files, isovalue, motion, folder)
    each_piece(client, "study", one, work, progress)
    return {name: _read(Path(folder) / f"{name}.npz")[1] for name in setups}
