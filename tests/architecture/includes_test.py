#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads every #include and fails where one runs against the direction of the folders.

    includes_test.py SOURCE_TREE [--self-test]

--self-test plants wrong includes into a copy of the tree and demands that each is found.
"""

import pathlib
import re
import shutil
import sys
import tempfile

# What each folder may include, beside itself: docs/architecture.md, "Dependencies".
ALLOWED = {
    "engine": set(),
    "kernels": set(),
    "backends": {"engine", "kernels"},
    "pictures": {"engine"},
    "hal": {"engine", "pictures"},
    "focus": {"engine"},
    "calibration": {"engine", "focus"},
    "depth": {"engine", "focus"},
    "session": {"engine", "backends", "pictures", "hal", "focus", "calibration"},
    "capi": {"engine", "backends"},
    "mapping": {"engine", "pictures", "hal", "focus", "calibration", "depth", "session"},
    "words": {"engine", "hal", "focus", "calibration", "session"},
    "serve": {"engine", "backends", "pictures", "hal", "focus", "calibration", "depth", "session", "mapping", "words"},
    "python": {"engine", "backends", "pictures", "hal", "focus", "calibration", "depth", "session", "mapping", "words"},
    "tools": {"engine", "backends", "pictures", "hal", "focus", "calibration", "depth", "session", "mapping", "words", "serve"},
}
# These stand outside of the product and may look at all of it.
FREE = {"tests", "bench", "examples"}
SOURCES = {".c", ".cpp", ".h", ".hpp", ".comp", ".cl", ".glsl", ".clh"}

INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)


def sources(tree):
    """Every source file of the product, as paths within the tree."""
    for folder in ALLOWED:
        for path in sorted((tree / folder).rglob("*")):
            if path.suffix in SOURCES and path.is_file():
                yield path.relative_to(tree)


def target_of(tree, source, text):
    """The included file within the tree, or None where it is not one of its files."""
    for base in (source.parent, pathlib.PurePosixPath(".")):
        whole = (tree / base / text).resolve()
        if whole.is_file() and whole.is_relative_to(tree.resolve()):
            return whole.relative_to(tree.resolve())
    return None


def wrong_includes(tree):
    """One line for each include that runs the wrong way, and how many includes were looked at."""
    wrong, seen = [], 0
    for source in sources(tree):
        for text in INCLUDE.findall((tree / source).read_text(encoding="utf-8")):
            target = target_of(tree, source, text)
            if target is None:
                continue
            seen += 1
            ours, theirs = source.parts[0], target.parts[0]
            if theirs != ours and theirs not in ALLOWED[ours]:
                allowed = ", ".join(sorted(ALLOWED[ours])) or "nothing"
                wrong.append(f"{source}: includes {text}; {ours}/ may include {allowed}")
    return wrong, seen


def unknown_folders(tree):
    """Folders with C++ in them that the table does not know: they would never be looked at."""
    known = set(ALLOWED) | FREE
    return sorted(
        folder.name
        for folder in tree.iterdir()
        if folder.is_dir() and folder.name not in known | {"build"} and not folder.name.startswith(".")
        and any(path.suffix in {".cpp", ".hpp"} for path in folder.rglob("*"))
    )


def plant(tree, file, include):
    path = tree / file
    before = path.read_text(encoding="utf-8")
    quoted = include if include.startswith("<") else f'"{include}"'
    path.write_text(before + f"\n#include {quoted}\n", encoding="utf-8")
    found, _ = wrong_includes(tree)
    path.write_text(before, encoding="utf-8")
    return found


def self_test(tree):
    """Returns what was not noticed."""
    planted = [
        ("engine/frame.hpp", "hal/camera.hpp"),
        ("engine/frame.cpp", "<hal/camera.hpp>"),
        ("tools/fathom/plot.cpp", "kernels/args.h"),
        ("focus/focus.cpp", "session/rig.hpp"),
        ("focus/focus.hpp", "../hal/lens.hpp"),
        ("calibration/calibration.cpp", "backends/backends.hpp"),
        ("depth/mapper.cpp", "backends/backends.hpp"),
        ("hal/camera.hpp", "../focus/search.hpp"),
        ("session/rig.cpp", "tools/fathom/console.hpp"),
        ("capi/fathom.h", "../session/session.hpp"),
        ("tools/fathom/main.cpp", "tests/support/frames.hpp"),
        ("python/scoring.cpp", "capi/fathom.h"),
        ("serve/operator.cpp", "tools/fathom/console.hpp"),
        ("mapping/report.cpp", "serve/state.hpp"),
    ]
    missed = []
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / "tree"
        for name in [*ALLOWED, "tests"]:
            shutil.copytree(tree / name, copy / name)
        if wrong_includes(copy)[0]:
            missed.append("the copy is wrong before anything was planted")
        for file, include in planted:
            found = plant(copy, file, include)
            if len(found) != 1 or not found[0].startswith(f"{file}: includes {include.strip('<>')};"):
                missed.append(f"{include} in {file}: {found}")
        (copy / "cellar").mkdir()
        (copy / "cellar" / "new.cpp").write_text("")
        if unknown_folders(copy) != ["cellar"]:
            missed.append("a folder that the table does not know")
    return missed


def main():
    tree = pathlib.Path(sys.argv[1])
    if "--self-test" in sys.argv[2:]:
        problems = [f"not noticed: {what}" for what in self_test(tree)]
        seen = 1
    else:
        problems, seen = wrong_includes(tree)
        problems += [f"{name}/ is not in the table of {__file__}" for name in unknown_folders(tree)]
    for problem in problems:
        print(problem)
    if seen < 1:
        print("no include was found at all")
    return 1 if problems or seen < 1 else 0


if __name__ == "__main__":
    sys.exit(main())
