#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs tests of the live page: with Node.js alone, or in Debian's Chromium.

    run.py [--client FOLDER] [--program FATHOM] TEST.mjs

FOLDER, which may be missing, is where the client that drives the browser is kept; npm brings the
version that package-lock.json names. Without it no browser is needed. Exits 77 where something that
is needed is not there.
"""

import argparse
import filecmp
import os
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
HERE = pathlib.Path(__file__).parent
OLDEST_NODE = 20


def missing(needs_browser):
    if shutil.which("node") is None:
        return "no Node.js here (Debian: nodejs)"
    version = subprocess.run(["node", "--version"], check=True, capture_output=True, text=True).stdout
    if int(version.strip().lstrip("v").split(".")[0]) < OLDEST_NODE:
        return f"Node.js {version.strip()} is too old: {OLDEST_NODE} is needed"
    if needs_browser and not any(map(shutil.which, BROWSERS)):
        return "no Chromium here (Debian: chromium)"
    if needs_browser and shutil.which("npm") is None:
        return "no npm here"
    return None


def bring(client):
    """Whether the client is there, in the version that is named."""
    lock = client / "package-lock.json"
    if lock.exists() and filecmp.cmp(lock, HERE / lock.name, shallow=False) and (client / "node_modules").is_dir():
        return True
    client.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", lock.name):
        shutil.copy(HERE / name, client)
    command = ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"]
    brought = subprocess.run(command, cwd=client, capture_output=True, text=True)
    if brought.returncode != 0:
        lock.unlink()
        print(brought.stderr)
    return brought.returncode == 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--client", type=pathlib.Path)
    parser.add_argument("--program", help="the program, for tests of the service itself")
    parser.add_argument("test")
    options = parser.parse_args()
    why = missing(options.client is not None)
    if why is None and options.client and not bring(options.client):
        why = "npm brought no client for the browser"
    if why:
        print(f"skipped: {why}")
        return SKIPPED
    environment = dict(os.environ)
    if options.client:
        environment["FATHOM_PAGE_CLIENT"] = str(options.client.resolve())
    if options.program:
        environment["FATHOM_PROGRAM"] = options.program
    return subprocess.run(["node", "--test", str(HERE / options.test)], env=environment).returncode


if __name__ == "__main__":
    sys.exit(main())
