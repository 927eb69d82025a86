# SPDX-License-Identifier: Apache-2.0
"""What the search of the site looks through: [address, page, heading, text] of every section."""
import re
import xml.etree.ElementTree

import markdown

SECTION = re.compile(r'<h[1-6] id="([^"]*)">(.*?)</h[1-6]>', re.DOTALL)


def entries(address, title, body):
    parts = SECTION.split(body)
    return [[f"{address}#{name}", title, markdown.text_of(heading), " ".join(markdown.text_of(text).split())]
            for name, heading, text in zip(parts[1::3], parts[2::3], parts[3::3])]


def names(tagfile):
    """Types and functions that Doxygen's tag file lists."""
    for compound in xml.etree.ElementTree.parse(tagfile).getroot():
        if compound.get("kind") not in ("class", "struct", "namespace", "file"):
            continue
        name, page = compound.findtext("name"), compound.findtext("filename")
        if compound.get("kind") in ("class", "struct"):
            yield [f"reference/{with_ending(page)}", "Reference", name, compound.get("kind")]
        for member in compound.iter("member"):
            if member.get("kind") == "function":
                where = f"reference/{with_ending(member.findtext('anchorfile'))}#{member.findtext('anchor')}"
                yield [where, "Reference", f"{name}::{member.findtext('name')}", member.findtext("arglist") or ""]


def with_ending(page):
    return page if page.endswith(".html") else f"{page}.html"
