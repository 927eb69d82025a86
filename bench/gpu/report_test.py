#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bench/gpu/report on made-up results: its tables, which bars it says hold, and what it will not say."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

REPORT = pathlib.Path(__file__).resolve().parent / "report"
NONE = "not measured on a GPU"
CARD = "NVIDIA H100 80GB HBM3"


def line(what, metric, us, batch=100000, depth=8, windows=None):
    return {"what": what, "metric": metric, "depth": depth, "batch": batch, "windows": windows or batch,
            "us_per_window": us, "windows_per_s": 1e6 / us}


def results(kind="gpu"):
    """Lines with which every bar holds."""
    lines = [{"what": "device", "label": "vulkan:0", "name": CARD, "kind": kind, "details": "driver 580.1"},
             {"what": "cuda", "name": CARD, "driver": 13000, "runtime": 13000, "cufft": 12000},
             {"what": "ceilings", "copy_bytes_per_s": 2.8e12, "read_bytes_per_s": 3e12,
              "upload_bytes_per_s": 50e9, "flops": 60e12}]
    for metric, us in (("fft:64:hann", 0.008), ("walsh-sequency:64", 0.004)):
        lines += [line("resident", metric, us), line("streamed", metric, 0.105), line("upload", metric, 0.1),
                  line("link", metric, 0.09), line("peer-resident", metric, 4 * us),
                  line("peer-streamed", metric, 0.12), line("opencl-resident", metric, 1.25 * us)]
    return lines


class Report(unittest.TestCase):
    def report(self, lines, raw=""):
        """Exit status, and what is printed."""
        with tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
            file.write("".join(json.dumps(each) + "\n" for each in lines) + raw)
            file.flush()
            done = subprocess.run([sys.executable, REPORT, file.name], capture_output=True, text=True)
        self.assertNotIn("Traceback", done.stderr)
        return done.returncode, done.stdout

    def row(self, printed, *starts):
        """The cells of the one row whose first cells are these."""
        rows = [[cell.strip() for cell in each.strip("|").split("|")]
                for each in printed.splitlines() if each.startswith("|")]
        found = [row for row in rows if row[:len(starts)] == list(starts)]
        self.assertEqual(len(found), 1, (starts, printed))
        return found[0][len(starts):]

    def bar(self, printed, start):
        """(figure, verdict) of the one bar that starts so."""
        rows = [each.strip("| ").split(" | ") for each in printed.splitlines() if each.startswith("| " + start)]
        rows = [row for row in rows if len(row) == 4]
        self.assertEqual(len(rows), 1, (start, printed))
        return rows[0][2:]

    def test_every_bar_may_hold(self):
        status, printed = self.report(results())
        self.assertEqual(status, 0, printed)
        self.assertIn(CARD, printed)
        self.assertIn("driver 580.1", printed)
        self.assertNotIn("NO ", printed)
        self.assertEqual(self.bar(printed, "`fft:64:hann`, 100 000 windows resident"), ["125 million", "yes"])
        self.assertEqual(self.bar(printed, "`walsh-sequency:64` over the peer"), ["4.00 times", "yes"])
        self.assertEqual(self.bar(printed, "`fft:64:hann`, upload and compute")[1], "yes")
        self.assertEqual(self.bar(printed, "`walsh-sequency:64`, OpenCL over Vulkan"), ["1.25 times: 0.00500 us", "yes"])

    def test_a_row_has_every_figure(self):
        _, printed = self.report(results())
        # 2.5 * 4096 * 12 + 4096 + 6 * 64 * 33 operations at 60e12 a second: 2.33 ns of 8.
        self.assertEqual(self.row(printed, "`fft:64:hann`", "100 000"),
                         ["0.00800 us, 125 M/s", "0.105 us, 9.52 M/s", "0.0320 us, 31.2 M/s", "0.120 us, 8.33 M/s",
                          "4.00", "29 %"])
        # 4096 * 13 additions at 30e12 a second: 1.77 ns of 4.
        self.assertEqual(self.row(printed, "`walsh-sequency:64`", "100 000")[-1], "44 %")

    def test_bytes_bound_small_windows(self):
        _, printed = self.report(results() + [line("resident", "walsh-sequency:8", 48e-6)])
        # 64 pixels and 8 bytes at 3e12 a second: 24 ps; 448 additions at 30e12: 15 ps.
        self.assertEqual(self.row(printed, "`walsh-sequency:8`", "100 000")[-1], "50 %")

    def test_missed_bars_are_named(self):
        for what, metric, us, start in (("resident", "fft:64:hann", 0.0101, "`fft:64:hann`, 100 000 windows"),
                                        ("resident", "walsh-sequency:64", 0.0051, "`walsh-sequency:64`, 100 000 windows"),
                                        ("peer-resident", "fft:64:hann", 0.0239, "`fft:64:hann` over the peer"),
                                        ("opencl-resident", "fft:64:hann", 0.0105, "`fft:64:hann`, OpenCL"),
                                        ("streamed", "walsh-sequency:64", 0.111, "`walsh-sequency:64`, upload and")):
            status, printed = self.report(results() + [line(what, metric, us)])
            self.assertEqual(status, 1)
            self.assertEqual(self.bar(printed, start)[1], "NO", start)
            self.assertEqual(printed.count("| NO |"), 1, printed)

    def test_what_was_not_measured_says_just_that(self):
        status, printed = self.report([line("resident", "fft:16:hann", 0.5)])
        self.assertEqual(status, 1)
        self.assertEqual(self.row(printed, "`fft:16:hann`", "100 000"), ["0.500 us, 2.00 M/s"] + [NONE] * 5)
        self.assertNotIn("| `fft:8:hann` |", printed)
        self.assertNotIn(f"| {NONE} | {NONE} | {NONE} | {NONE} | {NONE} | {NONE} |", printed)
        left_out = [each for each in printed.splitlines() if each.startswith("Not measured on a GPU: ")]
        self.assertEqual(len(left_out), 1, printed)
        self.assertIn("`fft:8:hann` (1, 64, 4 096, 100 000)", left_out[0])
        self.assertIn("`fft:16:hann` (1, 64, 4 096);", left_out[0])
        self.assertIn("`walsh-sequency:64`, 16 bits (1, 64, 4 096, 100 000)", left_out[0])
        self.assertEqual(self.bar(printed, "`fft:64:hann`, 100 000 windows resident"), [NONE, NONE])

    def test_where_nothing_was_measured_one_paragraph_says_so(self):
        status, printed = self.report([])
        self.assertEqual(status, 1)
        self.assertEqual(printed.count("\n"), 1, printed)
        self.assertTrue(printed.startswith("Not measured on a GPU: "), printed)
        self.assertIn("`walsh-sequency:64`, 100 000 windows resident: 200 million windows/s", printed)

    def test_what_failed_is_no_empty_table(self):
        status, printed = self.report([{"what": "failed", "doing": "resident", "metric": "fft:64:hann", "depth": 8,
                                        "batch": 64, "why": "no"}])
        self.assertEqual(status, 1)
        self.assertEqual(self.row(printed, "`fft:64:hann`", "64")[0], "FAILED")

    def test_without_nvcc_the_peer_s_cells_say_so(self):
        ours = [each for each in results() if not each["what"].startswith(("peer", "cuda", "ceilings"))]
        status, printed = self.report(ours + [{"what": "note", "text": "no nvcc"}])
        self.assertEqual(status, 1)
        self.assertEqual(self.row(printed, "`fft:64:hann`", "100 000")[2:], ["no nvcc"] * 4)
        self.assertEqual(self.bar(printed, "`fft:64:hann` over the peer"), ["no nvcc", "no nvcc"])
        self.assertEqual(self.bar(printed, "`fft:64:hann`, 100 000 windows resident")[1], "yes")

    def test_without_opencl_its_bars_say_so(self):
        lines = [each for each in results() if not each["what"].startswith("opencl")]
        status, printed = self.report(lines + [{"what": "note", "text": "no OpenCL device"}])
        self.assertEqual(status, 1)
        self.assertEqual(self.bar(printed, "`fft:64:hann`, OpenCL"), ["no OpenCL device", "no OpenCL device"])

    def test_a_software_device_is_no_gpu(self):
        status, printed = self.report(results(kind="software"))
        self.assertEqual(status, 1)
        self.assertTrue(printed.startswith("NOT A GPU: "), printed)
        self.assertEqual(self.bar(printed, "`fft:64:hann`, 100 000 windows resident")[1], "not a GPU")
        self.assertNotIn("| yes |", printed)

    def test_two_cards_are_not_compared_in_silence(self):
        lines = results()
        lines[1]["name"] = "another card"
        self.assertIn("NOT THE SAME CARD", self.report(lines)[1])

    def test_a_run_that_was_cut_off_loses_only_its_last_line(self):
        status, printed = self.report(results(), raw='{"what":"resident","metric":"fft:8:ha')
        self.assertEqual(status, 0, printed)

    def test_smaller_batches_are_named(self):
        _, printed = self.report(results() + [line("resident", "fft:512:hann", 3.5, windows=4096)])
        self.assertEqual(self.row(printed, "`fft:512:hann`", "4 096 for 100 000")[0], "3.50 us, 0.286 M/s")

    def test_wrong_scores_are_no_figures(self):
        lines = [each for each in results() if (each["what"], each.get("metric")) != ("streamed", "fft:64:hann")]
        lines.append({"what": "failed", "doing": "streamed", "metric": "fft:64:hann", "depth": 8, "batch": 100000,
                      "why": "window 7 scores 1, not 2"})
        status, printed = self.report(lines)
        self.assertEqual(status, 1)
        self.assertEqual(self.row(printed, "`fft:64:hann`", "100 000")[1], "FAILED")
        self.assertIn("window 7 scores 1, not 2", printed)

    def test_cufft_with_callbacks_has_its_own_rows(self):
        _, printed = self.report(results() + [line("peer-callbacks-resident", "fft:64:hann", 0.016),
                                              line("peer-callbacks-streamed", "fft:64:hann", 0.11)])
        self.assertEqual(self.row(printed, "cuFFT with callbacks", "`fft:64:hann`"),
                         ["100 000", "0.0160 us, 62.5 M/s", "0.110 us, 9.09 M/s", "2.00"])

    def test_a_bar_counts_the_fastest_peer(self):
        status, printed = self.report(results() + [line("peer-callbacks-resident", "fft:64:hann", 0.016)])
        self.assertEqual(status, 1)
        self.assertEqual(self.bar(printed, "`fft:64:hann` over the peer"), ["2.00 times cuFFT with callbacks", "NO"])
        status, printed = self.report(results() + [line("peer-callbacks-resident", "fft:64:hann", 0.05)])
        self.assertEqual(status, 0, printed)
        self.assertEqual(self.bar(printed, "`fft:64:hann` over the peer"), ["4.00 times", "yes"])

    def test_a_refused_callback_says_why_in_its_row(self):
        why = "cuFFT refused a plan with callbacks: cufftResult 17, CUFFT_MISSING_DEPENDENCY"
        status, printed = self.report(results() + [{"what": "failed", "doing": "peer-callbacks-resident",
                                                    "metric": "fft:64:hann", "depth": 8, "batch": 100000, "why": why}])
        self.assertEqual(status, 0, printed)
        self.assertEqual(self.row(printed, "cuFFT with callbacks", "`fft:64:hann`")[:2], ["100 000", f"FAILED: {why}"])

    def test_without_callbacks_one_line_says_so(self):
        self.assertIn(f"cuFFT with callbacks: {NONE}.\n", self.report(results())[1])
        note = {"what": "note", "text": "nvcc did not build the callbacks"}
        self.assertIn("cuFFT with callbacks: nvcc did not build the callbacks.\n", self.report(results() + [note])[1])

    def test_the_documentation_has_these_tables_or_this_paragraph(self):
        page = (REPORT.parents[2] / "docs" / "performance.md").read_text(encoding="utf-8")
        section = page.split("\n## On a GPU\n")[1].split("\n## ")[0]
        heads = [each for each in self.report(results())[1].splitlines() if each.startswith(("| metric", "| bar"))]
        self.assertEqual(len(heads), 2)
        paragraph = " ".join(self.report([])[1].split())
        if paragraph in " ".join(section.split()):
            self.assertNotIn(heads[0], section)
            return
        for head in heads:
            self.assertIn(head, section)


if __name__ == "__main__":
    unittest.main()
