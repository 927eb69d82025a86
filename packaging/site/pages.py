#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders the Markdown of this repository as one folder of static pages that can be searched offline.

    pages.py OUT [TAGFILE]    TAGFILE: Doxygen's, so that names of the reference are found, too

Needs cmark-gfm. Links between pages, to pictures and to files of the repository go to their copies in OUT.
"""
import html
import json
import os
import pathlib
import re
import shutil
import sys

import markdown
import search

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Every page but those of docs/ that are named nowhere here: they stand under "More".
GROUPS = (
    ("Begin", ("README.md", "docs/install.md", "docs/teach.md", "docs/glossary.md")),
    ("Measure", ("docs/ranging.md", "docs/depth.md", "docs/spectral.md", "docs/metrics.md", "docs/optics.md", "docs/output.md",
                 "docs/live-page.md")),
    ("Hardware", ("docs/rigs.md", "docs/machine-vision.md", "docs/alpaca.md", "docs/serial.md")),
    ("From programs", ("docs/use-it-from-your-program.md", "docs/python.md", "docs/http.md", "docs/scaling.md")),
    ("Speed", ("docs/performance.md", "bench/README.md")),
    ("Take part", ("CONTRIBUTING.md", "docs/architecture.md", "docs/adding-*.md", "tests/hardware/README.md", "CHANGELOG.md")),
)
PICTURES = (".png", ".svg", ".jpg")


def groups():
    """[(heading, [source below ROOT])], every page once."""
    found = [(name, [path for pattern in patterns for path in sorted(ROOT.glob(pattern))]) for name, patterns in GROUPS]
    named = {path for _, paths in found for path in paths}
    more = [path for path in sorted((ROOT / "docs").glob("*.md")) if path not in named]
    return found + ([("More", more)] if more else [])


def address(source):
    """Where in OUT the page of a Markdown file stands."""
    name = source.relative_to(ROOT)
    if name == pathlib.Path("README.md"):
        return "index.html"
    if name.name == "README.md":
        return "-".join(name.parent.parts) + ".html"
    return name.stem.lower() + ".html"


class Site:
    def __init__(self, out, has_reference):
        self.out = out
        self.has_reference = has_reference
        self.template = (HERE / "page.html").read_text()
        self.groups = [(name, [(path, markdown.title(path)) for path in paths]) for name, paths in groups()]
        self.addresses = {path: address(path) for _, pages in self.groups for path, _ in pages}
        self.files = set()  # of the repository, shown in pages of their own

    def target(self, source, link):
        """What a link of a page becomes: to the copy of what it names."""
        if re.match(r"[a-z]+:|#", link):
            return link
        path, _, anchor = link.partition("#")
        path = pathlib.Path(os.path.normpath(source.parent / path))
        anchor = f"#{anchor}" if anchor else ""
        if path in self.addresses:
            return self.addresses[path] + anchor
        if not path.exists():
            sys.exit(f"site: {source.relative_to(ROOT)} links to {link}, which is not there")
        name = path.relative_to(ROOT)
        if path.suffix in PICTURES:
            copy = self.out / "files" / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, copy)
            return f"files/{name}"
        self.files.add(path)
        return file_address(path)

    def navigation(self, here, base):
        for name, pages in self.groups:
            yield f"<h2>{name}</h2>\n<ul>"
            for path, title in pages:
                mark = ' aria-current="page"' if path == here else ""
                yield f'<li><a href="{base}{self.addresses[path]}"{mark}>{html.escape(title)}</a></li>'
            if name == "From programs" and self.has_reference:
                yield f'<li><a href="{base}reference/index.html">Reference of C++ and C</a></li>'
            yield "</ul>"

    def write(self, name, title, body, here=None):
        base = "../" * name.count("/")
        values = {"title": html.escape(title), "body": body, "base": base,
                  "navigation": "\n".join(self.navigation(here, base))}
        path = self.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(re.sub(r"@(\w+)@", lambda found: values[found[1]] if found[1] in values else found[0], self.template))

    def write_files(self):
        """Pages of files and folders that pages link to, and of what is in those folders."""
        done = set()
        while waiting := self.files - done:
            for path in waiting:
                done.add(path)
                name = str(path.relative_to(ROOT))
                self.write(file_address(path), name, f"<h1>{html.escape(name)}</h1>\n{self.content(path)}")

    def content(self, path):
        if not path.is_dir():
            return f"<pre><code>{html.escape(path.read_text())}</code></pre>"
        inside = [each for each in sorted(path.iterdir()) if is_shown(each)]
        self.files.update(inside)
        base = "../" * file_address(path).count("/")
        return "<ul>" + "".join(f'<li><a href="{base}{file_address(each)}">{html.escape(each.name)}</a></li>'
                                for each in inside) + "</ul>"


def is_shown(path):
    if path.is_dir():
        return path.name != "__pycache__" and not path.name.startswith(".")
    return b"\0" not in path.read_bytes()


def file_address(path):
    name = path.relative_to(ROOT)
    return f"files/{name}/index.html" if path.is_dir() else f"files/{name}.html"


def main():
    out = pathlib.Path(sys.argv[1])
    tags = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    site = Site(out, tags is not None)
    entries = []
    for _, pages in site.groups:
        for source, title in pages:
            body, sections = markdown.render(source, lambda link, source=source: site.target(source, link))
            site.write(site.addresses[source], title, markdown.with_contents(body, sections), source)
            entries += search.entries(site.addresses[source], title, body)
    site.write("search.html", "Search", '<h1>Search</h1>\n<div id="found"></div>')
    site.write_files()
    entries += search.names(tags) if tags else []
    (out / "search-index.js").write_text(f"const searchIndex = {json.dumps(entries, ensure_ascii=False)};\n")
    for asset in ("style.css", "search.js"):
        shutil.copy(HERE / asset, out / asset)


if __name__ == "__main__":
    main()
