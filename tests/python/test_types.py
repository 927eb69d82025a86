# SPDX-License-Identifier: Apache-2.0
"""What editors and type checkers are told of the module, and what help() says: that it is true and whole."""

import ast
import inspect
import os
import pathlib
import re
import shutil
import subprocess

import fathom
import pytest
from fathom import _fathom

PACKAGE = pathlib.Path(fathom.__file__).parent
SOURCE = pathlib.Path(os.environ["FATHOM_SOURCE"])

FUNCTIONS = {name: getattr(fathom, name) for name in fathom.__all__ if inspect.isfunction(getattr(fathom, name))}
FUNCTIONS |= {f"optics.{name}": getattr(fathom.optics, name) for name in fathom.optics.__all__}
CLASSES = {name: getattr(fathom, name) for name in fathom.__all__ if inspect.isclass(getattr(fathom, name))}


def of_dask():
    dask = pytest.importorskip("fathom.dask", reason="Dask is not installed")
    return {f"dask.{name}": getattr(dask, name) for name in ("score", "focus", "depth")}


def sections(text):
    """What stands under each underlined heading of numpydoc."""
    parts = re.split(r"^(\w+)\n-{3,}\n", inspect.cleandoc(text), flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


def described(parameters):
    """Names before the colons, or alone on a line: 'backend, threads : optional', '**wishes'."""
    heads = re.findall(r"^(\*{0,2}\w[\w, *]*?)(?: :.*)?$", parameters, flags=re.M)
    return {name.strip(" *") for head in heads for name in head.split(",")}


def faults_of(name, function):
    text, signature = inspect.getdoc(function) or "", inspect.signature(function)
    found = sections(text)
    names = set(signature.parameters)
    if missing := names - described(found.get("Parameters", "")):
        yield f"{name}: nothing is said of {', '.join(sorted(missing))}"
    if foreign := described(found.get("Parameters", "")) - names:
        yield f"{name}: there is no {', '.join(sorted(foreign))}"
    if signature.return_annotation not in (None, "None") and "Returns" not in found:
        yield f"{name}: does not say what it returns"
    if names and "Raises" not in found:
        yield f"{name}: does not say what it raises"


def test_functions_say_parameters_results_and_errors():
    faults = [fault for name, function in {**FUNCTIONS, **of_dask()}.items() for fault in faults_of(name, function)]
    assert len(FUNCTIONS) > 20 and not faults, "\n".join(faults)


def members(one):
    return {name: member for name, member in vars(one).items() if not name.startswith("_") and (
        inspect.isfunction(member) or isinstance(member, (property, classmethod)))}


def test_methods_and_properties_say_what_they_are_and_name_their_parameters():
    faults, seen = [], 0
    for name, one in CLASSES.items():
        assert inspect.getdoc(one), name
        for at, member in members(one).items():
            seen += 1
            function = getattr(member, "fget", None) or getattr(member, "__func__", member)
            text = inspect.getdoc(function) or ""
            names = [*inspect.signature(function).parameters][1:]
            missing = [one for one in names if not re.search(rf"\b{one}\b", text)] if len(names) > 1 else []
            if not text or missing:
                faults.append(f"{name}.{at}: {missing or 'no docstring'}")
    assert seen > 40 and not faults, "\n".join(faults)


def stub():
    """Names of _fathom.pyi, and of each function and method how many arguments it takes."""
    found = {}
    for node in ast.parse((PACKAGE / "_fathom.pyi").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            found[node.name] = len(node.args.args)
        elif isinstance(node, ast.ClassDef):
            found[node.name] = None
            for part in node.body:
                name = part.name if isinstance(part, ast.FunctionDef) else part.target.id
                is_call = isinstance(part, ast.FunctionDef) and not any(
                    isinstance(one, ast.Name) and one.id == "property" for one in part.decorator_list)
                found[f"{node.name}.{name}"] = len(part.args.args) if is_call else None
        elif isinstance(node, ast.AnnAssign) and node.simple:
            found[node.target.id] = None
    return {name: count for name, count in found.items() if name != "Tell"}


def arguments_of(function):
    """How many, as pybind11 writes them in the first line of a docstring; None for what is no function."""
    head = re.match(r"\w+\((.*)\) ->", function.__doc__ or "") if callable(function) else None
    if head is None or inspect.isclass(function):
        return None
    return len(re.findall(r"\w+: ", head[1]))


def built():
    """The same of the extension as it was built."""
    found = {}
    for name, one in vars(_fathom).items():
        if name.startswith("__"):
            continue
        found[name] = arguments_of(one)
        if inspect.isclass(one):
            own = [at for at in vars(one) if not at.startswith("_") or at == "__init__"]
            for at in own:
                found[f"{name}.{at}"] = arguments_of(getattr(one, at))
    return found


def test_the_stub_is_that_of_the_extension():
    said, is_there = stub(), built()
    # A class that is only handed out has no __init__ of its own.
    handed_out = {name for name, one in vars(_fathom).items() if inspect.isclass(one)}
    is_there = {name: count for name, count in is_there.items()
                if not (name.endswith(".__init__") and name.split(".")[0] in handed_out and name not in said)}
    assert said == is_there and len(said) > 50


USED = '''
import numpy as np
import fathom
import fathom.dask
picture = np.zeros((64, 64), np.uint8)
stack = np.zeros((9, 64, 64), np.uint8)
far: float = fathom.optics.depth_of_field(50, 4, 0.03, 2000)[1]
one: float = fathom.score(picture)
several = fathom.score(picture, 'fft:64', [(0, 0)]).shape
grid = fathom.score(picture, stride=4).max()
listed = fathom.score(picture, windows=np.zeros((1, 2), int)).sum()
fathom.focus(stack, np.arange(9.0))
fathom.depth(stack, range(9))
result = fathom.focus(stack, list(range(9)))
if result.position is not None and result.sigma is not None:
    print(result.position + result.sigma)
fathom.Calibration.fit([1, 2, 3], np.arange(3)).distance(result).mm + 1
fathom.Calibration.fit([result], [1.0])
with fathom.Plan('fft:64') as plan:
    plan.wait(plan.submit(picture, (0, 0), np.empty(1))).max()
for row in fathom.screen(['a.tif'], windows=[(0, 0)], positions=np.arange(9)):
    print(row.uri.upper())
with fathom.open_rig('sim:') as rig:
    rig.capture([1, 2]).max()
    for event in rig.events():
        print(event.text.upper())
foci = fathom.dask.focus(stack, range(9)).compute
'''

MISUSED = {
    "fathom.score(5, 5)": "call-overload",
    "fathom.optics.hyperfocal_mm('a', 1, 1)": "arg-type",
    "fathom.optics.hyperfocal_mm(1)": "call-arg",
    "fathom.focus([], speed=3)": "call-arg",
    "1 + fathom.focus([]).position": "operator",
    "fathom.dask.score([], stride='3')": "arg-type",
    "fathom.Plan('fft:64').submit([]).real_": "attr-defined",
}


CONFIG = """
[mypy]
strict = True
ignore_missing_imports = True
[mypy-dask.*,distributed.*,matplotlib.*,pandas.*]
follow_imports = skip
[mypy-{examples}]
disallow_untyped_defs = False
disallow_incomplete_defs = False
disallow_untyped_calls = False
disable_error_code = call-overload
"""


@pytest.mark.skipif(shutil.which("mypy") is None, reason="mypy is not installed")
def test_types_hold(tmp_path):
    """The package and what uses it, strictly; the examples as far as they have types. In one run: numpy takes long."""
    used, misused, config = (tmp_path / name for name in ("used.py", "misused.py", "mypy.ini"))
    examples = sorted((SOURCE / "examples" / "python").glob("*.py"))
    used.write_text(USED)
    misused.write_text("import fathom, fathom.dask\n" + "".join(f"{line}\n" for line in MISUSED))
    config.write_text(CONFIG.format(examples=",".join(one.stem for one in examples)))
    command = ["mypy", "--config-file", config, "--no-error-summary", "--cache-dir", tmp_path / "cache",
               *PACKAGE.glob("*.py"), used, misused, *examples]
    said = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path,
                          env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
    lines = [line for line in said.stdout.splitlines() if ": note:" not in line]
    right = [(i, code) for i, code in enumerate(MISUSED.values(), 2)]
    errors = [(line, re.search(r"misused.py:(\d+): error: .*\[(.*)\]", line)) for line in lines]
    assert not [line for line, found in errors if not found] and not said.stderr, said.stdout + said.stderr
    assert [(int(found[1]), found[2]) for _, found in errors if found] == right
