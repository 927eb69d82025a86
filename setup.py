# SPDX-License-Identifier: Apache-2.0
"""Builds the extension with CMake, for the Python that runs this. All else is in pyproject.toml."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
# Another folder keeps the objects between installations: FATHOM_PYTHON_BUILD. One that has the module for this
# Python already is used as it is.
BUILD = pathlib.Path(os.environ.get("FATHOM_PYTHON_BUILD", HERE / "build" / "pip"))


def is_configured():
    """Whether the folder builds the module, and for the Python that runs this."""
    try:
        cache = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
    except OSError:
        return False
    python = re.search(r"^FATHOM_PYTHON_EXECUTABLE:\w+=(.*)$", cache, re.M)
    return "\nFATHOM_PYTHON:BOOL=ON\n" in cache and python is not None and abi_of(python[1]) == abi_of(sys.executable)


def abi_of(python):
    """What the module's file ends in for a Python: cpython-311-x86_64-linux-gnu.so."""
    told = "import sysconfig; print(sysconfig.get_config_var('EXT_SUFFIX'))"
    return subprocess.run([python, "-c", told], capture_output=True, text=True, check=False).stdout


class CMakeBuild(build_ext):
    """One extension, whose sources CMake knows."""

    def build_extension(self, ext):
        if not is_configured():
            self.configure()
        jobs = os.environ.get("FATHOM_JOBS", str(os.cpu_count() or 1))
        subprocess.run(["cmake", "--build", BUILD, "--target", "fathom_python", "--parallel", jobs], check=True)
        target = pathlib.Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(BUILD / "python" / "fathom" / target.name, target)

    def configure(self):
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        configure = ["cmake", "-S", HERE, "-B", BUILD, *generator, "-DCMAKE_BUILD_TYPE=Release",
                     "-DFATHOM_PYTHON=ON", "-DFATHOM_BUILD_TESTS=OFF", "-DFATHOM_BUILD_BENCH=OFF",
                     f"-DFATHOM_PYTHON_EXECUTABLE={sys.executable}", "--log-level=WARNING"]
        subprocess.run(configure, check=True)


setup(ext_modules=[Extension("fathom._fathom", sources=[])], cmdclass={"build_ext": CMakeBuild})
