#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `fathom reproduce --quick` twice and reads what it wrote, as a reviewer and a browser would.

    reproduce_test.py PATH_OF_THE_PROGRAM
"""

import html.parser
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM = sys.argv.pop()
VOID = {"meta", "br", "img", "hr", "link", "input"}
DRAWINGS = {f"figure-{n}" for n in (1, 2, 6, 7, 9)}  # which need no gnuplot
CLAIMS = [
    "peak-at-best-focus", "one-peak", "nearly-identical", "walsh-steadier", "walsh-better-defocused",
    "repeats-within-2-percent", "ten-frames-1.5-percent", "repeats-alike-at-all-distances",
    "calibration-1", "calibration-2", "calibration-3", "test-1-all-but-one", "test-1-average",
    "test-2-all-but-one", "test-2-average", "test-1-straight-line", "test-2-straight-line",
    "worst-error", "half-depth-of-field", "seedling-near", "test-1-grows", "test-2-does-not-grow",
    "orange-fails", "depth-of-field", "evaluations", "no-a-priori-knowledge", "brent-saves-a-third",
    "window-64"]


class Page(html.parser.HTMLParser):
    """Checks that elements nest, and collects ids, links, tables and whatever reaches outside."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.outside, self.problems = [], [], [], [], []
        self.rows = {}  # of each table that has an id
        self.table = None

    def look(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "src", "xlink:href", "action", "srcset"):
                if value.startswith("data:image/png;base64,"):
                    continue  # the pixels of a picture, in the page itself
                (self.links if value.startswith("#") else self.outside).append(value)
        if tag == "script":
            self.problems.append("a script")

    def handle_starttag(self, tag, attrs):
        self.look(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.table = dict(attrs).get("id")
            self.rows[self.table] = 0
        if tag == "tr":
            self.rows[self.table] += 1

    def handle_startendtag(self, tag, attrs):
        self.look(tag, attrs)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.problems.append(f"</{tag}> at {self.getpos()}")


def run(folder, *options, path=None):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("FATHOM_")}
    if path is not None:
        environment["PATH"] = path
    return subprocess.run([PROGRAM, "reproduce", *options, str(folder)], env=environment,
                          capture_output=True, text=True, timeout=500, check=False)


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="fathom-reproduce-")
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.done = run(cls.folder / "a", "--quick")
        assert cls.done.returncode == 0, cls.done.stderr
        cls.html = (cls.folder / "a/report.html").read_text(encoding="utf-8")
        cls.markdown = (cls.folder / "a/report.md").read_text(encoding="utf-8")
        cls.json = json.loads((cls.folder / "a/results.json").read_text(encoding="utf-8"))
        cls.page = Page()
        cls.page.feed(cls.html)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_html_is_well_formed_and_needs_nothing_else(self):
        self.assertEqual(self.page.problems, [])
        self.assertEqual(self.page.open, [])
        self.assertEqual(self.page.outside, [])
        self.assertNotRegex(self.html, r"url\((?!#)|@import")
        self.assertEqual(len(self.page.ids), len(set(self.page.ids)), "an id is given twice")
        self.assertEqual({link[1:] for link in self.page.links} - set(self.page.ids), set())

    def test_no_number_is_missing(self):
        for name, text in (("html", re.sub(r"<svg.*?</svg>", "", self.html, flags=re.S)),
                           ("md", self.markdown)):
            self.assertNotRegex(text, r"\b(nan|inf|-nan)\b", name)

    def test_every_claim_has_its_line(self):
        claims = self.json["claims"]
        self.assertEqual([claim["id"] for claim in claims], CLAIMS)
        self.assertEqual(self.page.rows["claims-table"], len(CLAIMS) + 1)
        for claim in claims:
            self.assertIn(claim["outcome"], ("holds", "partly", "does not hold"))
            self.assertRegex(claim["where"], r"pp?\. \d+")
            self.assertIn(claim["claim"].replace("|", "\\|"), self.markdown)
            self.assertIn(claim["claim"], self.done.stdout)

    def test_what_cannot_depend_on_luck_holds(self):
        outcome = {claim["id"]: claim["outcome"] for claim in self.json["claims"]}
        for claim in ("peak-at-best-focus", "one-peak", "calibration-1", "half-depth-of-field",
                      "depth-of-field", "repeats-within-2-percent"):
            self.assertEqual(outcome[claim], "holds", claim)

    def test_tables_have_the_thesis_rows(self):
        self.assertEqual(self.page.rows["table-1"], 6 + 1)
        self.assertEqual(self.page.rows["table-2"], 9 + 1)
        self.assertEqual([len(table["rows"]) for table in self.json["tables"]], [4, 2, 3, 3, 3])

    def test_figures_are_svg_and_all_are_shown(self):
        files = sorted((self.folder / "a/figures").glob("*.svg"))
        wanted = DRAWINGS | {f"figure-{n}" for n in (11, 12, *range(15, 31))}
        wanted |= {f"{what}-{how}" for how in ("sharp", "blurred")
                   for what in ("window", "spectrum-fft", "spectrum-walsh", "target-usaf", "target-seedling", "target-orange")}
        self.assertEqual(wanted - {file.stem for file in files}, set())
        for file in files:
            xml.etree.ElementTree.parse(file)
            self.assertIn(f"(figures/{file.name})", self.markdown)
        self.assertEqual(self.html.count("<svg"), len(files))

    def test_the_sums_make_the_scores_and_blur_takes_them_from_the_outside(self):
        looks = self.json["looks"]
        self.assertEqual(self.page.rows["sums"], len(looks) + 1)
        self.assertEqual(len(looks), 4)
        for look in looks:
            self.assertAlmostEqual(sum(look["bands"]) / look["score"], 1, delta=1e-5)  # the FFT's score is in float
        for sharp in (look for look in looks if look["in_focus"]):
            blurred = next(look for look in looks if not look["in_focus"] and look["metric"] == sharp["metric"])
            self.assertLess(blurred["score"], sharp["score"] / 2)

            def inner(look):
                return sum(look["bands"][:4]) / look["score"]

            self.assertGreater(inner(blurred), inner(sharp))

    def test_two_runs_differ_in_the_times_only(self):
        self.assertEqual(run(self.folder / "b", "--quick").returncode, 0)
        other = self.folder / "b"

        def without_times(text, pattern):
            kept, count = re.subn(pattern, "", text, flags=re.S)
            self.assertEqual(count, 1)
            return kept

        for name, pattern in (("report.html", r'<section id="speed">.*?</section>'),
                              ("report.md", r'<a id="speed"></a>.*')):
            first = without_times((self.folder / "a" / name).read_text("utf-8"), pattern)
            second = without_times((other / name).read_text("utf-8"), pattern)
            self.assertEqual(first, second, name)
        again = json.loads((other / "results.json").read_text("utf-8"))
        for numbers in (self.json, again):
            numbers.pop("speed", None)
        self.assertEqual(self.json, again)
        for file in (self.folder / "a/figures").iterdir():
            self.assertEqual(file.read_bytes(), (other / "figures" / file.name).read_bytes())

    def test_without_gnuplot_it_says_so_loudly_and_still_reports(self):
        done = run(self.folder / "c", "--quick", path="/nowhere")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("apt-get install gnuplot-nox", done.stderr)
        page = (self.folder / "c/report.html").read_text("utf-8")
        self.assertIn("All plots are missing", page)
        self.assertIn("apt-get install gnuplot-nox", page)
        self.assertEqual(page.count("<svg"), len(DRAWINGS))
        self.assertEqual({file.stem for file in (self.folder / "c/figures").glob("*.svg")}, DRAWINGS)
        self.assertIn("claims-table", page)

    def test_a_file_is_no_folder(self):
        (self.folder / "file").write_text("mine")
        done = run(self.folder / "file", "--quick")
        self.assertEqual(done.returncode, 2)
        self.assertIn("is a file", done.stderr)
        self.assertEqual((self.folder / "file").read_text(), "mine")


if __name__ == "__main__":
    unittest.main()
