"""`pip install` makes a package that is whole by itself, without a network, from an sdist too."""

import os
import pathlib
import subprocess
import sys
import tarfile

import pytest

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
FEEL = """
import pathlib, sys, palpate
assert pathlib.Path(palpate.__file__).is_relative_to(sys.argv[1]), palpate.__file__
loaded = palpate.load(palpate.sample_volume())
assert pathlib.Path(palpate.sample_volume()).is_relative_to(sys.argv[1])
palpate.write(loaded.volume, "again.mha")
assert (palpate.load("again.mha").volume.array == loaded.volume.array).all()
assert "ct-needle" in palpate.layers_presets()
"""


@pytest.fixture(scope="module")
def sdist(tmp_path_factory):
    """The archive that pip can install from, made without writing into the sources."""
    folder = tmp_path_factory.mktemp("sdist")
    subprocess.run([sys.executable, "setup.py", "-q", "egg_info", "--egg-base", folder, "sdist",
                    "--formats=gztar", "--dist-dir", folder], check=True, cwd=SOURCE)
    return next(folder.glob("*.tar.gz"))


@pytest.fixture(scope="module")
def installed(sdist, tmp_path_factory):
    """The folder of packages of a virtual environment, made and used as docs/python.md says, with the
    archive of the sources; CMake has built it already."""
    venv = tmp_path_factory.mktemp("package") / "palpate-venv"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", venv], check=True)
    environment = {**os.environ, "PALPATE_BUILD_DIR": os.environ["PALPATE_BUILD"]}
    environment.pop("PYTHONPATH")
    subprocess.run([venv / "bin" / "pip", "install", "--quiet", "--no-build-isolation", "--no-deps",
                    "--no-index", sdist], check=True, env=environment)
    return next(venv.glob("lib/*/site-packages"))


def test_the_archive_of_sources_has_all_that_cmake_needs(sdist, tmp_path):
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path)
    root = next(tmp_path.glob("palpate-*"))
    for folder in ("apps", "bindings", "data", "devices", "include", "io", "run", "src", "stream"):
        there = {path.relative_to(SOURCE) for path in (SOURCE / folder).rglob("*")
                 if path.is_file() and "__pycache__" not in path.parts and ".egg-info" not in str(path)}
        packed = {path.relative_to(root) for path in (root / folder).rglob("*") if path.is_file()}
        assert there and there == packed, there ^ packed
    subprocess.run(["cmake", "-S", root, "-B", tmp_path / "build", "-DPALPATE_TESTS=OFF",
                    "-DPALPATE_VIEWER=OFF", "-DPALPATE_PYTHON=ON",
                    f"-DPYTHON_EXECUTABLE={sys.executable}"], check=True, stdout=subprocess.DEVNULL)


def run_with(installed, folder, prefix=None):
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith("PALPATE")}
    environment["PYTHONPATH"] = str(installed)
    return subprocess.run([sys.executable, "-c", FEEL, prefix or installed], cwd=folder, env=environment,
                          stderr=subprocess.PIPE, text=True, check=False)


def test_the_installed_package_reads_writes_and_has_its_data(installed, tmp_path):
    ran = run_with(installed, tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert list(installed.glob("palpate-*.dist-info"))
    assert {"py.typed", "__init__.pyi"} <= {path.name for path in (installed / "palpate").iterdir()}


def test_the_installed_component_works_wherever_its_prefix_was_moved_to(tmp_path):
    for component in ("palpate-python", "palpate-io-helper"):
        subprocess.run(["cmake", "--install", os.environ["PALPATE_BUILD"], "--component", component,
                        "--prefix", tmp_path / "first"], check=True, stdout=subprocess.DEVNULL)
    moved = (tmp_path / "first").rename(tmp_path / "moved")
    packages = list(moved.glob("**/dist-packages"))
    assert len(packages) == 1
    ran = run_with(packages[0], tmp_path, moved)
    assert ran.returncode == 0, ran.stderr


def test_it_uses_the_helper_program_inside_the_package(installed, tmp_path):
    helper = installed / "palpate" / "libexec" / "palpate" / "palpate-io-helper"
    hidden = helper.with_name("hidden")
    helper.rename(hidden)
    try:
        ran = run_with(installed, tmp_path)
    finally:
        hidden.rename(helper)
    assert ran.returncode != 0 and "palpate-io-helper" in ran.stderr
