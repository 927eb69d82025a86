#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bench/report on made-up results: its tables, its plots, and what it calls a change."""
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import intervals  # noqa: E402

REPORT = pathlib.Path(__file__).resolve().parent / "report"


def one(median, noise=0.05):
    return {"min": median * (1 - noise), "median": median, "max": median * (1 + noise), "repetitions": 3}


def nine(median, spread=0.01):
    """As a run of nine repetitions leaves it."""
    values = [median * (1 + spread * (i - 4) / 4) for i in range(9)]
    return {"min": values[0], "median": median, "max": values[-1], "repetitions": 9, "values": values}


def results():
    """Every N takes N^2 ns, the peer three times as long, OpenCV twice and four times; four processors do
    three times as much as one, and could do four times."""
    benchmarks = {"ceiling/copy": one(40e9), "ceiling/read": one(200e9), "ceiling/flops": one(100e9),
                  "ceiling/copy/threads:all": one(160e9), "ceiling/flops/threads:all": one(400e9)}
    for n in (16, 64, 128):
        batch = min(4096, 4096 * 64 * 64 // (n * n))
        for metric, peer in ((f"fft:{n}:hann", "peer-fftw"), (f"walsh-sequency:{n}", "peer-radix2-walsh")):
            benchmarks[f"score/cpu/{metric}/batch:{batch}"] = one(n * n * 1e-9)
            benchmarks[f"score/{peer}/{metric}/batch:{batch}"] = one(3e-9 * n * n)
        benchmarks[f"score/peer-opencv-laplacian/laplacian-variance:{n}/batch:{batch}"] = one(2e-9 * n * n)
        benchmarks[f"score/peer-opencv-tenengrad/tenengrad:{n}/batch:{batch}"] = one(4e-9 * n * n)
    for metric in ("fft:64:hann", "walsh-sequency:64"):
        benchmarks[f"score/cpu/{metric}/batch:4096/threads:all"] = one(64 * 64 * 1e-9 / 3)
        benchmarks[f"search/cpu/{metric}"] = one(8e-5)
        for windows in (1, 16, 256):
            benchmarks[f"growth/cpu/{metric}/windows:{windows}"] = one(2e-6)
        for threads in (1, 2, 4):
            benchmarks[f"growth/cpu/{metric}/threads:{threads}"] = one(2e-6 / threads)
    return {"machine": {"processor": "a processor", "processors": 4, "kernel": "6", "devices": ["cpu:0  cpu"],
                        "compiler": "c++ 12", "commit": "abc", "date": "2026-01-01"},
            "benchmarks": benchmarks, "failed": False, "notes": ["vulkan: no GPU here"],
            "thesis": [{"thesis": "one score", "thesis_least_s": 55, "thesis_most_s": 55, "here_s": 2e-6}]}


class Report(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def write(self, name, found):
        path = self.folder / name
        path.write_text(json.dumps(found))
        return path

    def run_report(self, *arguments):
        done = subprocess.run([sys.executable, REPORT, *map(str, arguments)], capture_output=True, text=True)
        self.assertNotIn("Traceback", done.stderr)
        self.assertNotIn("empty x range", done.stderr)  # gnuplot, of days
        return done.returncode, done.stdout

    def test_tables_and_plots_follow_from_the_results(self):
        out = self.folder / "out"
        status, printed = self.run_report("--from-json", self.write("in.json", results()), out)
        self.assertEqual(status, 0, printed)
        self.assertIn("| 64 | 4.10 us | 3.89 .. 4.30 us | 12.3 us (peer-fftw) | 3.00 (2.71 .. 3.32) | 34 % (arithmetic)", printed)
        self.assertIn("| windows a call | 1 | 256 | 1.00 | 1.00 |", printed)
        self.assertIn("| threads | 1 | 4 | -1.00 | -1.00 |", printed)
        self.assertIn("| N, a full batch | 16 | 128 | 2.00 | 2.00 |", printed)
        self.assertIn("| one score | 55 s | 2.00 us | 2.75e+07 |", printed)
        self.assertIn("80.0 us", printed)
        self.assertIn("NOT TIMED: vulkan", printed)
        self.assertIn("NOT TIMED: peer-vkfft-opencl", printed)
        self.assertIn("| 64 | 4.10 us | 4.10 us | 8.19 us | 2.00 | 2.00 | 16.4 us | 4.00 | 4.00 |", printed)
        self.assertIn("All 4 processors, N = 64, fastest repetitions: FFT 1.30 us a window, 26 % of their roof (arithmetic); Walsh", printed)
        self.assertIn("Of all processors at once, at best: 168 GB/s copying, 420 GFLOP/s, which is 4.20 times one thread's", printed)
        self.assertNotIn("NOT TIMED: peer-opencv", printed)
        self.assertNotIn("NOT TIMED: peer-fftw:", printed)
        self.assertEqual((out / "report.md").read_text().strip(), printed.strip())
        for name in ("throughput-fft", "throughput-walsh", "speedup", "roofline", "growth-windows", "growth-threads"):
            self.assertIn("<svg", (out / f"{name}.svg").read_text())
            self.assertIn(f"({name}.svg)", printed)

    def test_what_is_missing_is_a_dash(self):
        found = results()
        for name in list(found["benchmarks"]):
            if name.startswith(("score/peer", "ceiling", "search")) or name.endswith("/threads:all"):
                del found["benchmarks"][name]
        status, printed = self.run_report("--from-json", self.write("in.json", found), self.folder / "out")
        self.assertEqual(status, 0)
        self.assertIn("| 64 | 4.10 us | 3.89 .. 4.30 us | - | - | - |", printed)
        self.assertIn("| 64 | 4.10 us | 4.10 us | - | - | - | - | - | - |", printed)
        self.assertNotIn("processors, N = 64", printed)
        self.assertIn("NOT TIMED: peer-opencv-tenengrad: not in this build", printed)

    def test_why_a_peer_was_left_out_is_said_once(self):
        found = results()
        found["notes"].append("peer-vkfft-vulkan: no GPU here")
        _, printed = self.run_report("--from-json", self.write("in.json", found), self.folder / "out")
        self.assertEqual(printed.count("NOT TIMED: peer-vkfft-vulkan"), 1)

    def test_a_failure_is_said_and_is_the_status(self):
        found = results()
        found["failed"] = True
        found["notes"].append("score/cpu/fft:8:hann: it does other work")
        status, printed = self.run_report("--from-json", self.write("in.json", found), self.folder / "out")
        self.assertEqual(status, 1)
        self.assertIn("NOT TIMED: score/cpu/fft:8:hann: it does other work", printed)

    def test_changes_within_the_noise_are_none(self):
        new = results()
        new["benchmarks"]["score/cpu/fft:64:hann/batch:4096"] = one(4.4e-6)
        status, printed = self.run_report("--compare", self.write("a.json", results()), self.write("b.json", new))
        self.assertEqual(status, 0, printed)
        self.assertTrue(printed.startswith("0 of "), printed)

    def test_changes_beyond_the_noise_are_named(self):
        new = results()
        new["benchmarks"]["score/cpu/fft:64:hann/batch:4096"] = one(6e-6)
        new["benchmarks"]["search/cpu/fft:64:hann"] = one(4e-5)
        new["benchmarks"]["ceiling/flops"] = one(50e9)
        status, printed = self.run_report("--compare", self.write("a.json", results()), self.write("b.json", new))
        self.assertEqual(status, 1)
        self.assertIn("  1.46 times  SLOWER        score/cpu/fft:64:hann/batch:4096", printed)
        self.assertIn("  0.50 times  faster        search/cpu/fft:64:hann", printed)
        self.assertIn("the machine's", printed)
        self.assertIn("3 of ", printed)

    def test_nine_repetitions_are_tested_and_overlap_a_little(self):
        old, new = results(), results()
        for found, factor in ((old, 1), (new, 1.012)):
            found["benchmarks"]["search/cpu/fft:64:hann"] = nine(8e-5 * factor)
        new["benchmarks"]["score/cpu/fft:64:hann/batch:4096"] = nine(4.1e-6)  # the old one has three
        status, printed = self.run_report("--compare", self.write("a.json", old), self.write("b.json", new))
        self.assertEqual(status, 1, printed)
        self.assertRegex(printed, r"  1\.01 times  SLOWER +search/cpu/fft:64:hann  1\.00 \.\. 1\.02, p = 0\.00")
        self.assertIn("1 of ", printed)
        self.assertIn("1 by a Mann-Whitney test", printed)

    def test_a_history_grows_by_what_is_new_and_is_plotted(self):
        file, first, later = self.folder / "history.jsonl", results(), results()
        later["machine"]["date"] = "2026-02-01"
        later["benchmarks"]["score/cpu/fft:64:hann/batch:4096"] = nine(3e-6)
        status, _ = self.run_report("--history", file, self.write("a.json", first))
        self.assertEqual(status, 0)
        status, printed = self.run_report("--history", file, self.folder / "a.json", self.write("b.json", later))
        self.assertEqual(status, 0)
        lines = [json.loads(line) for line in file.read_text().splitlines()]
        self.assertEqual([line["date"] for line in lines], ["2026-01-01", "2026-02-01"])
        median, low, high = lines[1]["median_low_high_s"]["FFT, N = 64"]
        self.assertEqual(median, 3e-6)
        self.assertTrue(2.97e-6 <= low < median < high <= 3.03e-6)
        self.assertIn("2026-02-01  abc           FFT, N = 64 3.00 us", printed)
        self.assertIn("<svg", (self.folder / "history.svg").read_text())

    def test_it_says_how_to_build_what_is_missing(self):
        build = self.folder / "build"
        build.mkdir()
        for tests, said in (("OFF", "-DFATHOM_BUILD_BENCH=ON -DFATHOM_BUILD_TESTS=OFF &&"), ("ON", "-DFATHOM_BUILD_BENCH=ON &&")):
            (build / "CMakeCache.txt").write_text(f"FATHOM_BUILD_TESTS:BOOL={tests}\n")
            done = subprocess.run([sys.executable, REPORT, "--build", build, self.folder / "out"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn(said, done.stderr)


class Intervals(unittest.TestCase):
    def test_p_values_are_those_of_the_tables(self):
        # All orders of 3 and 3 are 20, of 4 and 5 are 126.
        self.assertAlmostEqual(intervals.p_value([1, 2, 3], [4, 5, 6]), 2 / 20)
        self.assertAlmostEqual(intervals.p_value([1, 2, 4], [3, 5, 6]), 4 / 20)
        self.assertAlmostEqual(intervals.p_value([9, 8, 7, 6], [1, 2, 3, 4, 5]), 2 / 126)
        # U = 17 is the critical value of 9 and 9 at 5 %, two-sided (tables of Mann and Whitney's statistic).
        counts = intervals._orders(9, 9)
        self.assertLess(2 * sum(counts[:18]) / 48620, 0.05)
        self.assertGreater(2 * sum(counts[:19]) / 48620, 0.05)
        self.assertEqual(sum(counts), 48620)

    def test_equal_values_are_no_difference(self):
        self.assertEqual(intervals.p_value([1] * 9, [1] * 9), 1)

    def test_intervals_cover_as_they_say(self):
        dice, covered, rounds = random.Random(4), 0, 150
        for _ in range(rounds):
            low, high = intervals.median_interval([dice.gauss(5, 1) for _ in range(15)])
            covered += low <= 5 <= high
        self.assertGreater(covered, 0.88 * rounds)
        self.assertLess(covered, rounds)

    def test_of_many_differences_by_chance_few_are_believed(self):
        dice = random.Random(5)
        p_values = {i: intervals.p_value(*([dice.gauss(0, 1) for _ in range(9)] for _ in range(2))) for i in range(200)}
        self.assertGreater(sum(p < 0.05 for p in p_values.values()), 2)  # what a test of each would believe
        self.assertLessEqual(len(intervals.discoveries(p_values)), 1)
        p_values["true"] = intervals.p_value(range(9), range(10, 19))
        self.assertIn("true", intervals.discoveries(p_values))


if __name__ == "__main__":
    unittest.main()
