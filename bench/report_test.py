#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bench/report on made-up results: its tables, its plots, and what it calls a change."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

REPORT = pathlib.Path(__file__).resolve().parent / "report"


def one(median, noise=0.05):
    return {"min": median * (1 - noise), "median": median, "max": median * (1 + noise), "repetitions": 3}


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
        return done.returncode, done.stdout

    def test_tables_and_plots_follow_from_the_results(self):
        out = self.folder / "out"
        status, printed = self.run_report("--from-json", self.write("in.json", results()), out)
        self.assertEqual(status, 0, printed)
        self.assertIn("| 64 | 4.10 us | +-5 % | 12.3 us (peer-fftw) | 3.00 | 34 % (arithmetic)", printed)
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
        self.assertIn("| 64 | 4.10 us | +-5 % | - | - | - |", printed)
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


if __name__ == "__main__":
    unittest.main()
