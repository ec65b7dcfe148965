"""`pip install .` makes a package that is whole by itself, without a network."""

import os
import pathlib
import shutil
import subprocess
import sys

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
def installed(tmp_path_factory):
    """The folder that pip installed into, from a copy of what pip reads; built already."""
    folder = tmp_path_factory.mktemp("package")
    for name in ("pyproject.toml", "setup.py", "CMakeLists.txt"):
        shutil.copy(SOURCE / name, folder)
    shutil.copytree(SOURCE / "bindings" / "python" / "palpate",
                    folder / "bindings" / "python" / "palpate")
    target = folder / "target"
    environment = {**os.environ, "PALPATE_BUILD_DIR": os.environ["PALPATE_BUILD"]}
    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation",
                    "--no-deps", "--no-index", "--target", target, folder],
                   check=True, env=environment)
    return target


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
