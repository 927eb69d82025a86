#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the examples of a Markdown file and compares what they print with what the file shows.

    readme_test.py --path DIRECTORY_OF_THE_PROGRAM FILE.md

In a ```console block a line `$ COMMAND` is run and must print the lines below it; with none below, it
may print anything. `...` stands for any text within a line, and alone on a line for any lines. A command must
end with status 0, or with N where `# exits N` follows it. A backslash at the end of a line continues it.
A ```sh block is run as one script that must succeed.

The examples of a file run in one empty folder, in order, so that a later one finds the files of an
earlier one. A block after the comment <!-- not run: REASON --> is only for readers. Where it shows output, the
paragraph above says "example", because nobody has checked that this is what comes out.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field

TIMEOUT_S = 120


@dataclass
class Example:
    """One command, where it stands and what it should do."""

    line: int
    command: str
    expected: list[str] = field(default_factory=list)
    status: int = 0


class Malformed(Exception):
    """A block that is neither runnable nor marked as not to be run."""


def blocks(text):
    """Yields (line of the fence, language, lines, whether to run it, the text above) for every fenced block."""
    fence = language = start = None
    body, run, above, is_new = [], True, "", True
    for number, line in enumerate(text.splitlines(), start=1):
        opening = re.match(r"\s*(```+|~~~+)\s*(\S*)", line)
        if fence is None:
            if opening:
                fence, language = opening.groups()
                start, body = number, []
            elif not line.strip():
                is_new = True
            elif re.match(r"\s*<!--\s*not run\b", line):
                run = False
            else:
                above = line if is_new else f"{above} {line}"
                run, is_new = True, False
        elif opening and line.strip().startswith(fence) and not opening.group(2):
            yield start, language, body, run, above
            fence, run, is_new = None, True, True
        else:
            body.append(line)
    if fence is not None:
        raise Malformed(f"line {start}: this block is never closed")


def console_examples(start, body):
    """The commands of a console block with the output shown below each."""
    examples, continued = [], False
    for number, line in enumerate(body, start=start + 1):
        if continued:
            examples[-1].command += "\n" + line.removeprefix("> ")
        elif line.startswith("$ "):
            examples.append(Example(number, line[2:]))
        elif examples:
            examples[-1].expected.append(line)
        else:
            raise Malformed(f"line {number}: a console block starts with a line `$ COMMAND`")
        continued = (continued or line.startswith("$ ")) and line.endswith("\\")
    for example in examples:
        if wanted := re.search(r"#\s*exits\s+(\d+)\s*$", example.command):
            example.status = int(wanted.group(1))
    return examples


def require_modesty(start, language, body, above):
    """A session that is not run must not look as if it had been."""
    shows_output = language == "console" and any(e.expected for e in console_examples(start, body))
    if shows_output and "example" not in above.lower():
        raise Malformed(f'line {start}: this session is not run, and the paragraph above does not say "example"')


def examples_of(text):
    """Every example of a Markdown file, in order."""
    found = []
    for start, language, body, run, above in blocks(text):
        if not run:
            require_modesty(start, language, body, above)
            continue
        if language == "console":
            found += console_examples(start, body)
        elif language in ("sh", "bash"):
            found.append(Example(start, "set -e\n" + "\n".join(body)))
    return found


def pattern_of(expected):
    """A regular expression for the output that a block shows."""
    while expected and not expected[-1].strip():
        expected = expected[:-1]
    lines = []
    for line in expected:
        if line.strip() == "...":
            lines.append(r"(?:.*\n)*?")
        else:
            words = (re.escape(part) for part in line.rstrip().split("..."))
            lines.append(".*".join(words) + r"[ \t]*\n")
    return re.compile("".join(lines))


def complaint(example, status, output):
    """What is wrong with a run, or nothing."""
    if status != example.status:
        return f"exit status {status}, expected {example.status}"
    shown = "\n".join(example.expected).strip()
    if shown and not pattern_of(example.expected).fullmatch(output.rstrip("\n") + "\n"):
        return f"output differs; the file shows:\n{shown}"
    return None


def without_waits(output):
    """The output without what the program says while drivers keep it waiting: a slow machine's."""
    return re.sub(r"^fathom: (asking the drivers of|opening|timing) .*\n", "", output,
                  flags=re.MULTILINE)


def run(example, folder, environment):
    """Exit status and output (both streams, as a terminal shows them) of an example."""
    try:
        done = subprocess.run(["bash", "-c", example.command], cwd=folder, env=environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired as late:
        return 124, (late.stdout or b"").decode(errors="replace")
    return done.returncode, without_waits(done.stdout.decode(errors="replace"))


def check(file, path, folder):
    """Runs every example of a file; returns how many ran and how many failed."""
    # What the caller has set for the program must not leak into the examples.
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("FATHOM_", "XDG_"))}
    environment |= {"PATH": f"{path}:{environment['PATH']}", "HOME": str(folder), "LC_ALL": "C.UTF-8"}
    examples, failed = examples_of(file.read_text(encoding="utf-8")), 0
    for example in examples:
        status, output = run(example, folder, environment)
        if reason := complaint(example, status, output):
            failed += 1
            print(f"{file}:{example.line}: {reason}\n$ {example.command}\n{output.rstrip()}\n")
    return len(examples), failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--path", type=pathlib.Path, required=True, help="folder of the program")
    parser.add_argument("file", type=pathlib.Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fathom-readme-") as folder:
        try:
            count, failed = check(options.file, options.path.resolve(), folder)
        except Malformed as reason:
            sys.exit(f"{options.file}: {reason}")
    print(f"{options.file}: {count} examples, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
