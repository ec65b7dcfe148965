#!/usr/bin/env python3
"""The source archive is reproducible and whole."""

import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

root = Path(sys.argv[1])

git = ["git", "-C", root]
if subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, check=False).returncode != 0:
    print("skipped: not a git checkout")
    sys.exit(0)


def archive(folder, **environment):
    subprocess.run([root / "scripts/source_archive.sh", folder], check=True, capture_output=True,
                   env={**os.environ, **environment})
    path = next(Path(folder).glob("palpate-*.tar.gz"))
    return path, path.read_bytes()


with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
    path, first = archive(one)
    # Another person's settings: language, time zone, mask, git's own configuration.
    settings = Path(two) / "gitconfig"
    settings.write_text("[tar]\n\tumask = 0077\n[core]\n\tautocrlf = true\n")
    os.umask(0o077)
    _, second = archive(two, TZ="Asia/Tokyo", LC_ALL="C", GIT_CONFIG_GLOBAL=str(settings))
    assert first == second, "two archives of the same commit differ"
    subprocess.run(["sha256sum", "--check", "--quiet", path.name + ".sha256"], cwd=one, check=True)
    committed = subprocess.run([*git, "ls-tree", "-r", "--name-only", "-z", "HEAD"], check=True,
                               capture_output=True).stdout.decode().split("\0")[:-1]
    with tarfile.open(path) as tar:
        packed = {name.partition("/")[2] for name in tar.getnames()
                  if not tar.getmember(name).isdir()}
    assert set(committed) == packed, set(committed) ^ packed
    refused = subprocess.run([root / "scripts/source_archive.sh", "--commit", "nothing", one],
                             capture_output=True, check=False)
    assert refused.returncode == 1 and b"no commit 'nothing'" in refused.stderr, refused
print(f"source archive: {len(packed)} files, the same bytes twice")
