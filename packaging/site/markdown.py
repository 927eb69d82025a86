# SPDX-License-Identifier: Apache-2.0
"""Markdown to HTML as GitHub shows it: cmark-gfm, and names for headings that links go to."""
import html
import re
import subprocess

HEADING = re.compile(r"<h([1-6])>(.*?)</h\1>", re.DOTALL)
ADDRESS = re.compile(r'(<(?:a href|img src)=")([^"]*)"')


def text_of(markup):
    return html.unescape(re.sub(r"<[^>]*>", "", markup))


def title(path):
    """The first heading's text."""
    found = re.search(r"^# (.*)$", path.read_text(), re.MULTILINE)
    return found[1] if found else path.stem


def slug(text, taken):
    """The name of a heading as GitHub gives it."""
    name = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
    count = taken.get(name, 0)
    taken[name] = count + 1
    return f"{name}-{count}" if count else name


def render(path, target):
    """(HTML, [(level, name, text)] of its headings); every link goes through target."""
    done = subprocess.run(["cmark-gfm", "--unsafe", "-e", "table", "-e", "strikethrough", "-e", "autolink", path],
                          capture_output=True, text=True, check=True)
    taken, sections = {}, []

    def heading(found):
        level, markup = int(found[1]), found[2]
        name = slug(text_of(markup), taken)
        sections.append((level, name, text_of(markup)))
        return f'<h{level} id="{name}">{markup}</h{level}>'

    body = re.sub(r"<!--.*?-->\n?", "", done.stdout, flags=re.DOTALL)
    body = HEADING.sub(heading, body)
    body = ADDRESS.sub(lambda found: f'{found[1]}{html.escape(target(html.unescape(found[2])))}"', body)
    # What is wider than a telephone moves by itself, not the page.
    body = body.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")
    return body, sections


def with_contents(body, sections):
    """The page with links to its headings below the first, where there are several."""
    second = [(name, text) for level, name, text in sections if level == 2]
    if len(second) < 3:
        return body
    links = "".join(f'<li><a href="#{name}">{html.escape(text)}</a></li>' for name, text in second)
    return body.replace("</h1>", f'</h1>\n<details class="contents"><summary>On this page</summary><ul>{links}</ul></details>', 1)
