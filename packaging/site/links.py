#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""That every link of every page in a folder leads to a file of it, and to a name in that file.

    links.py FOLDER

Links to elsewhere are not followed. Exit status 1: some lead nowhere; they are named.
"""
import html.parser
import pathlib
import re
import sys
import urllib.parse

NAMES = ("id", "name")
LINKS = ("href", "src")


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.names, self.links = set(), []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key in NAMES and value:
                self.names.add(value)
            elif key in LINKS and value:
                self.links.append(value)


def wrong(folder):
    """'PAGE: LINK' of every link that leads nowhere, and how many there are in all."""
    pages = {path: Page(path) for path in sorted(folder.rglob("*.html"))}
    broken, count = [], 0
    for path, page in pages.items():
        for link in page.links:
            if re.match(r"(?:[a-z]+:|//)", link):
                continue
            count += 1
            where = urllib.parse.urlsplit(link)
            to = (path.parent / urllib.parse.unquote(where.path)).resolve() if where.path else path
            anchor = urllib.parse.unquote(where.fragment)
            if not to.is_file() or (anchor and to in pages and anchor not in pages[to].names):
                broken.append(f"{path.relative_to(folder)}: {link}")
    return broken, count


def main():
    broken, count = wrong(pathlib.Path(sys.argv[1]).resolve())
    for line in broken:
        print(f"leads nowhere: {line}")
    if count == 0:
        print("no page has a link")
    print(f"{count - len(broken)} of {count} links resolve")
    return 1 if broken or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
