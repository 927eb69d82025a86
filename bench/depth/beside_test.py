#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bench/depth/beside with programs that only note how they were called."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

BESIDE = pathlib.Path(__file__).resolve().parent / "beside"
NOTE = """#!/bin/sh
echo "$(basename "$0") $*" >> {log}
exit {status}
"""


class Beside(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.log = self.root / "log"
        (self.root / "stack").mkdir()
        for name in ("b.pgm", "a.PGM", "notes.txt"):
            (self.root / "stack" / name).write_text("")

    def program(self, name, status=0):
        path = self.root / name
        path.write_text(NOTE.format(log=self.log, status=status))
        path.chmod(0o755)
        return str(path)

    def run_it(self, *program):
        return subprocess.run(
            [sys.executable, BESIDE, "--fathom", self.program("ours"), "--runs", "2",
             self.root / "stack", "--", *program], capture_output=True, text=True)

    def test_runs_both_in_turns_on_the_same_pictures(self):
        done = self.run_it(self.program("theirs"), "--to={out}/x.png", "{pictures}")
        self.assertEqual(done.returncode, 0, done.stderr)
        calls = self.log.read_text().splitlines()
        self.assertEqual([call.split()[0] for call in calls], ["ours", "theirs"] * 2)
        self.assertIn(f"depth --rig replay:{self.root}/stack -o /", calls[0])
        words = calls[1].split()
        self.assertRegex(words[1], r"^--to=/.+/x\.png$")
        self.assertEqual(words[2:], [f"{self.root}/stack/a.PGM", f"{self.root}/stack/b.pgm"])
        self.assertIn("2 pictures, 2 runs each", done.stdout)
        self.assertRegex(done.stdout, r"[0-9.]+ times as fast")

    def test_says_what_failed(self):
        for program, words in ((self.program("broken", 3), "failed (3)"),
                               (str(self.root / "nothing"), "cannot start")):
            done = self.run_it(program)
            self.assertEqual(done.returncode, 1)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
