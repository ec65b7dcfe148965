"""Builds the Python module for pip: CMake makes the package palpate in its build tree, with the helper
programs and data that it needs, and this copies it. See pyproject.toml and docs/python.md."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
VERSION = re.search(r"project\(palpate VERSION ([\d.]+)",
                    (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)


class BuildWithCMake(build_ext):
    """PALPATE_BUILD_DIR names a build folder to use again; by default it is a temporary one."""

    def run(self):
        build = Path(os.environ.get("PALPATE_BUILD_DIR", Path(self.build_temp) / "cmake")).resolve()
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON", "-DPALPATE_TESTS=OFF",
                   "-DPALPATE_VIEWER=OFF", "-DPALPATE_PYTHON=ON",
                   f"-DPYTHON_EXECUTABLE={sys.executable}"]
        if not (build / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", ROOT, "-B", build, *generator, *options], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "palpate_python_types", "--parallel",
                        str(os.cpu_count() or 1)], check=True)
        made = build / "bindings" / "python" / "palpate"
        # Links to the helpers and data are followed: the package is whole by itself.
        shutil.copytree(made, Path(self.build_lib) / "palpate", dirs_exist_ok=True,
                        ignore=shutil.ignore_patterns("__pycache__"))

    def get_outputs(self):
        package = Path(self.build_lib) / "palpate"
        return [str(path) for path in package.rglob("*") if path.is_file()]


setup(version=VERSION, ext_modules=[Extension("palpate._palpate", sources=[])],
      cmdclass={"build_ext": BuildWithCMake})
