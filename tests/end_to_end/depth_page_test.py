#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens the page of a depth map in headless Chromium, and asks whether it came to its end.

    depth_page_test.py PROGRAM

The page says so once its surface has been drawn. Exits 77 where there is no Chromium.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def main():
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        print("skipped: no Chromium here (Debian: chromium)")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            [sys.argv[1], "depth", "--rig", "sim:distance=1500", "--from", "800", "--to", "1100", "--step", "15", "-o", folder],
            check=True,
        )
        page = pathlib.Path(folder, "view.html").resolve().as_uri()
        shown = subprocess.run(
            [browser, "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--ignore-gpu-blocklist", f"--user-data-dir={folder}/browser", "--virtual-time-budget=10000",
             "--dump-dom", page],
            check=True, capture_output=True, text=True, timeout=240,
        ).stdout
    wrong = []
    if 'data-ready="surface"' not in shown:
        wrong.append("the surface was not drawn")
    if "px: " not in shown or " steps" not in shown:
        wrong.append("the middle's depth is not told")
    for what in wrong:
        print(what)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
