#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""That the programs shown in a Markdown file are those in examples/, which install_test builds and runs.

    page_code_test.py FILE.md FOLDER_OF_THE_EXAMPLES

A ```cpp or ```c block stands below a comment <!-- examples/NAME --> and is that file without its first
line, the licence. Lines of a ```cmake block stand in the examples' CMakeLists.txt, PROGRAM for any target.
"""

import pathlib
import re
import sys
import tempfile

BLOCK = re.compile(r"(?:^<!-- examples/(?P<name>\S+) -->\n)?^```(?P<language>\w*)\n(?P<body>.*?)^```$",
                   re.MULTILINE | re.DOTALL)


def complaint_of_program(name, body, examples):
    """What is wrong with a block of C or C++, or nothing."""
    if name is None:
        return "a block without the name of its file above it"
    if not (file := examples / name).is_file():
        return f"there is no examples/{name}"
    if f" {name}" not in (examples / "CMakeLists.txt").read_text().replace("(", " "):
        return f"nobody builds examples/{name}"
    if file.read_text().split("\n", 1)[1] != body:
        return f"the block is not what examples/{name} holds"
    return None


def complaint_of_cmake(body, examples):
    """What is wrong with lines of CMake, or nothing."""
    real = (examples / "CMakeLists.txt").read_text()
    for line in body.splitlines():
        pattern = re.escape(line).replace("PROGRAM", r"\S+").replace(r"\)", r"[^)]*\)")
        if not re.search(pattern, real):
            return f"the examples' CMakeLists.txt has no line such as {line}"
    return None


def complaints(text, examples):
    """Everything that is wrong with the blocks of a page."""
    programs, found = 0, []
    for block in BLOCK.finditer(text):
        what = None
        if block["language"] in ("c", "cpp"):
            programs += 1
            what = complaint_of_program(block["name"], block["body"], examples)
        elif block["language"] == "cmake":
            what = complaint_of_cmake(block["body"], examples)
        if what:
            found.append(f"line {text[:block.start()].count(chr(10)) + 1}: {what}")
    return found + (["no program at all"] if programs == 0 else [])


def test_itself():
    """A wrong page must not pass."""
    with tempfile.TemporaryDirectory() as folder:
        examples = pathlib.Path(folder)
        (examples / "a.c").write_text("/* licence */\nint a;\n")
        (examples / "b.c").write_text("/* licence */\nint b;\n")
        (examples / "CMakeLists.txt").write_text("target_link_libraries(x PRIVATE y z)\nadd_example(a.c)\n")
        good = "<!-- examples/a.c -->\n```c\nint a;\n```\n"
        cmake = "```cmake\ntarget_link_libraries(PROGRAM PRIVATE y)\n```\n"
        assert not complaints(good + cmake, examples)
        for bad in (good.replace("int", "long"), good.replace("a.c", "c.c"), good.split("\n", 1)[1],
                    good.replace("a.c", "b.c").replace("int a", "int b"), good + cmake.replace("y", "q"),
                    "no code"):
            assert complaints(bad, examples), bad


def main():
    test_itself()
    file, examples = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    found = complaints(file.read_text(encoding="utf-8"), examples)
    for what in found:
        print(f"{file}: {what}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
