#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""That readme_test.py passes what is right and, more to the point, fails what is wrong."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("readme_test.py")


def verdict(markdown):
    """Exit status and output of the harness on a file with this text; `greet` is the program."""
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder, "greet")
        program.write_text('#!/bin/sh\necho "hello $1"; echo "took 17 ms"; exit ${2:-0}\n')
        program.chmod(0o755)
        file = pathlib.Path(folder, "README.md")
        file.write_text(markdown)
        done = subprocess.run([sys.executable, SCRIPT, "--path", folder, file], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        return done.returncode, done.stdout


def console(*lines):
    return "Text.\n\n```console\n" + "\n".join(lines) + "\n```\n\nMore text.\n"


class ReadmeTest(unittest.TestCase):
    def passes(self, markdown, count=1):
        status, output = verdict(markdown)
        self.assertEqual(status, 0, output)
        self.assertIn(f" {count} examples, 0 failed", output)

    def fails(self, markdown, *wanted):
        status, output = verdict(markdown)
        self.assertEqual(status, 1, output)
        for text in wanted:
            self.assertIn(text, output)

    def test_right_output_passes(self):
        self.passes(console("$ greet world", "hello world", "took 17 ms"))

    def test_wrong_output_fails_with_place_and_both_texts(self):
        self.fails(console("$ greet world", "hello moon", "took 17 ms"),
                   "README.md:4:", "hello moon", "hello world")

    def test_missing_line_fails(self):
        self.fails(console("$ greet world", "hello world"), "output differs")

    def test_extra_line_fails(self):
        self.fails(console("$ greet world", "hello world", "took 17 ms", "bye"), "output differs")

    def test_dots_within_a_line(self):
        self.passes(console("$ greet world", "hello ...", "took ... ms"))
        self.fails(console("$ greet world", "hello ...", "took ... s!"), "output differs")

    def test_dots_alone_are_any_lines(self):
        self.passes(console("$ greet world", "..."))
        self.passes(console("$ greet world", "hello world", "..."))
        self.passes(console("$ greet world", "...", "took 17 ms"))
        self.fails(console("$ greet world", "...", "hello world"), "output differs")

    def test_characters_of_regular_expressions_are_plain_text(self):
        self.passes(console("$ greet '(.*) [x]+'", "hello (.*) [x]+", "took 17 ms"))
        self.fails(console("$ greet abc", "hello a.c", "took 17 ms"), "output differs")

    def test_no_output_shown_compares_only_the_status(self):
        self.passes(console("$ greet world"))
        self.fails(console("$ greet world 1"), "exit status 1, expected 0")

    def test_exit_status_can_be_shown(self):
        self.passes(console("$ greet world 3  # exits 3"))
        self.fails(console("$ greet world 2  # exits 3"), "exit status 2, expected 3")
        self.fails(console("$ greet world  # exits 3"), "exit status 0, expected 3")

    def test_unknown_program_fails(self):
        self.fails(console("$ no-such-program"), "exit status 127")

    def test_several_commands_share_a_folder(self):
        self.passes(console("$ greet you > note", "$ cat note", "hello you", "took 17 ms") +
                    console("$ test -s note"), count=3)

    def test_the_folder_is_not_the_callers(self):
        self.passes(console("$ ls"))
        self.fails(console("$ test -e README.md"), "exit status 1")

    def test_continued_command(self):
        self.passes(console("$ greet \\", "    world", "hello world", "took 17 ms"))
        self.passes(console("$ greet \\", "> world", "hello world", "took 17 ms"))

    def test_script_block_must_succeed_in_every_line(self):
        self.passes("```sh\ngreet a\ngreet b\n```\n")
        self.fails("```sh\ngreet a 1\ngreet b\n```\n", "exit status 1")

    def test_marked_block_is_not_run(self):
        marked = "<!-- not run: changes the machine -->\n\n"
        self.passes(marked + console("$ false").removeprefix("Text.\n\n"), count=0)
        self.passes(marked + "```sh\nfalse\n```\n", count=0)
        self.fails(marked + "```sh\nfalse\n```\n\n```sh\nfalse\n```\n", "1 examples, 1 failed")

    def test_output_that_nobody_checks_is_called_an_example(self):
        marked = "<!-- not run: needs a camera -->\n" + console("$ false", "true").removeprefix("Text.\n\n")
        self.fails("It measures.\n\n" + marked, "line 4", "example")
        self.passes("It measures. For\nexample:\n\n" + marked, count=0)
        self.fails("An example.\n\nIt measures.\n\n" + marked, "line 6", "example")

    def test_other_languages_are_not_run(self):
        self.passes("```cpp\nint x = 0;\n```\n\n```\nfalse\n```\n", count=0)

    def test_console_block_without_a_command_is_malformed(self):
        self.fails(console("hello"), "line 4", "starts with a line")

    def test_unclosed_block_is_malformed(self):
        self.fails("```sh\nfalse\n", "line 1", "never closed")


if __name__ == "__main__":
    unittest.main()
