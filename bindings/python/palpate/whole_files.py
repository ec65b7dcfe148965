"""Files that appear whole or not at all, also after a power cut. Every output of the Python commands comes from here, unless the
module in C++ writes it."""

import contextlib
import errno
import os
import socket
import threading
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

_NO_SYNC = (errno.EINVAL, errno.ENOTSUP, errno.ENOSYS)  # of file systems without it


def writer() -> str:
    """Who writes: a worker that was taken for dead may write the same as another one."""
    return f"{socket.gethostname()}-{os.getpid()}-{threading.get_ident()}"


def sync(path: Path) -> None:
    """A file, or the names in a folder."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in _NO_SYNC:
            raise
    finally:
        os.close(descriptor)


def make_folder(path: Path) -> None:
    """With the folders above it that are not there yet."""
    if path.is_dir():
        return
    make_folder(path.parent)
    path.mkdir(exist_ok=True)
    sync(path.parent)


def put_in_place(before: Path, path: Path) -> None:
    """Renames a file that is complete, in place of what was there. It is synced first, so that the name never belongs to a part of
    it, and then its folder, so that the name stays."""
    sync(before)
    before.replace(path)
    sync(path.parent)


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """A file that write(file) fills, under another name at first. If that fails, nothing of it stays."""
    before = path.with_name(f"{path.name}.{writer()}")
    try:
        with before.open("wb") as file:
            write(file)
        put_in_place(before, path)
    except BaseException:
        with contextlib.suppress(OSError):
            before.unlink()
        raise
