#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bench/ratios on made-up times: which bars it says are missed."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

RATIOS = pathlib.Path(__file__).resolve().parent / "ratios"
SIDES = (8, 16, 32, 64, 128, 256, 512)


def run(*arguments):
    return subprocess.run([sys.executable, RATIOS, *arguments], capture_output=True, text=True)


def ours(n):
    """us a window, without a cliff."""
    return n * n * math.log2(n) / 1e4


def rings(metric, n):
    return f"fft:{n}:hann:power:rings={n // 4 if n < 32 else 16}" if metric == "fft" else f"{metric}:{n}:rings=8"


def times():
    """{benchmark: us a window of each repetition}, with which every bar holds."""
    made = {}
    for metric, suffix in (("fft", ":hann"), ("walsh-sequency", "")):
        for n in SIDES:
            def name(who, windows=min(4096, 4096 * 64 * 64 // (n * n))):
                return f"score/{who}/{metric}:{n}{suffix}/batch:{windows}"

            made[name("cpu")] = [ours(n)] * 3
            peers = {"fft": ("fftw",), "walsh-sequency": ("fftw-walsh", "radix2-walsh", "radix2-int-walsh")}
            for peer in peers[metric]:
                made[name(f"peer-{peer}")] = [20 * ours(n)] * 3
            made[name("cpu").replace(metric + f":{n}" + suffix, rings(metric, n))] = [1.2 * ours(n)] * 3
            if metric == "fft":
                made[name("cpu").replace(suffix, suffix + ":power")] = [ours(n)] * 3
            if n == 64:
                made[name("cpu", 1)] = [4.9] * 3
                made[name("cpu") + "/threads:all/real_time"] = [ours(n) / 1.95] * 3
    return made


class Ratios(unittest.TestCase):
    def verdicts(self, made, processors=2):
        """Exit status, and the lines that say MISSED."""
        runs = []
        for name, repetitions in made.items():
            windows = int(name.split("batch:")[1].split("/")[0])
            runs += [{"name": name, "run_type": "iteration", "time_unit": "us", "cpu_time": us * windows,
                      "real_time": us * windows} for us in repetitions]
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump({"context": {"num_cpus": processors}, "benchmarks": runs}, file)
            file.flush()
            done = run("--from-json", file.name)
        lines = done.stdout.splitlines()
        self.assertIn("bars", lines, done.stderr)
        return done.returncode, [line for line in lines if line.startswith("  MISSED")]

    def expect_missed(self, made, *words):
        status, missed = self.verdicts(made)
        self.assertEqual(status, 1)
        self.assertEqual(len(missed), 1, missed)
        for word in words:
            self.assertIn(word, missed[0])

    def test_every_bar_may_hold(self):
        self.assertEqual(self.verdicts(times()), (0, []))

    def test_two_threads_are_judged_by_their_fastest_repetitions(self):
        made = times()
        name = "score/cpu/fft:64:hann/batch:4096/threads:all/real_time"
        made[name] = [ours(64) / 1.85] * 3
        self.expect_missed(made, "2 threads", "fft:64", "1.85", "bar 1.9")
        self.assertEqual(self.verdicts(made, processors=1), (0, []))
        made[name] = [ours(64) / 1.95, ours(64), ours(64)]
        self.assertEqual(self.verdicts(made), (0, []))

    def test_cliffs_are_judged_by_medians(self):
        for n in (256, 512):
            made = times()
            name = f"score/cpu/walsh-sequency:{n}/batch:{4096 * 64 * 64 // (n * n)}"
            made[name] = [ours(n), 1.35 * ours(n), 2 * ours(n)]
            self.expect_missed(made, f"walsh-sequency:{n}", "1.35", "bar 1.3")
            made[name] = [ours(n), 1.25 * ours(n), 2 * ours(n)]
            self.assertEqual(self.verdicts(made), (0, []))

    def test_rings_are_judged_beside_the_moment_of_the_same_masses(self):
        for n in (16, 32, 64, 128):
            made = times()
            name = f"score/cpu/{rings('fft', n)}/batch:{min(4096, 4096 * 64 * 64 // (n * n))}"
            made[name] = [ours(n), 1.3 * ours(n), 2 * ours(n)]
            self.expect_missed(made, rings("fft", n), "1.30", "bar 1.25")
            made[name] = [ours(n), 1.24 * ours(n), 2 * ours(n)]
            self.assertEqual(self.verdicts(made), (0, []))

    def test_a_slow_single_window_is_missed(self):
        made = times()
        made["score/cpu/fft:64:hann/batch:1"] = [5.1] * 3
        self.expect_missed(made, "one window", "5.1", "bar 5")

    def test_without_a_program_it_says_in_one_line_what_to_build(self):
        done = run("--program", "nowhere/fathom_bench")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for words in ("nowhere/fathom_bench", "target fathom_bench", "--program"):
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
