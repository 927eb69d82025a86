# SPDX-License-Identifier: Apache-2.0
"""The module as docs/python.md installs it, in fresh folders: imported there, and equal to the program.

FATHOM_BUILD_FOLDER: a build folder that has the module already, so that nothing is compiled twice.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest
from pictures import noise, write_pgm

SOURCE = pathlib.Path(os.environ["FATHOM_SOURCE"])
BUILD = os.environ.get("FATHOM_BUILD_FOLDER")

pytestmark = pytest.mark.skipif(not BUILD, reason="FATHOM_BUILD_FOLDER names no build folder")

TRIED = """
import json, pathlib, sys, warnings
warnings.simplefilter('error')
import fathom, numpy as np
picture = np.load(sys.argv[1])
values = fathom.score(picture, 'fft:32:hann', stride=24, backend='cpu').ravel().tolist()
folder = pathlib.Path(fathom.__file__).parent
print(json.dumps([str(folder), sorted(p.name for p in folder.iterdir()), values]))
"""


def environment(**more):
    """Without what makes other tests find the module."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | more


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def scored(tmp_path_factory):
    """A picture as .npy, and what the program scores it."""
    folder = tmp_path_factory.mktemp("picture")
    picture = noise((120, 160), seed=5)
    np.save(folder / "picture.npy", picture)
    write_pgm(folder / "picture.pgm", picture)
    said = run([os.environ["FATHOM_PROGRAM"], "score", folder / "picture.pgm", "--metric", "fft:32:hann", "--grid", "24",
                "--backend", "cpu", "--json"])
    return folder / "picture.npy", [json.loads(line)["score"] for line in said.splitlines()]


def check(python, scored, inside, **paths):
    picture, expected = scored
    where, names, values = json.loads(run([python, "-c", TRIED, picture], cwd=inside, env=environment(**paths)))
    assert pathlib.Path(where).is_relative_to(inside)
    assert {"__init__.py", "_fathom.pyi", "py.typed", "dask.py"} <= set(names)
    assert values == expected


def test_into_a_folder(scored, tmp_path):
    folder = tmp_path / "a folder"
    said = run([SOURCE / "tools" / "python-install", folder], env=environment(FATHOM_BUILD=BUILD))
    assert said == f"installed: PYTHONPATH={folder}\n"
    check(sys.executable, scored, tmp_path, PYTHONPATH=str(folder))


def test_by_pip_without_a_network(scored, tmp_path):
    package = tmp_path / "source"  # pip leaves its own folders beside what it builds
    shutil.copytree(SOURCE / "python", package / "python")
    for name in ("pyproject.toml", "setup.py"):
        shutil.copy(SOURCE / name, package)
    run([sys.executable, "-m", "venv", "--system-site-packages", tmp_path / "env"])
    run([tmp_path / "env" / "bin" / "pip", "install", "--no-build-isolation", "--no-index", "."], cwd=package,
        env=environment(FATHOM_PYTHON_BUILD=BUILD))
    shutil.rmtree(package)
    check(tmp_path / "env" / "bin" / "python", scored, tmp_path)
