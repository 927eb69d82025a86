# SPDX-License-Identifier: Apache-2.0
"""The Python of docs/python.md, block after block, and the examples, as they are."""

import os
import pathlib
import re
import runpy
import sys

import pytest

SOURCE = pathlib.Path(os.environ["FATHOM_SOURCE"])


def test_the_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = SOURCE / "docs" / "python.md"
    names = {}
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    assert len(blocks) >= 5
    for block in blocks:
        exec(compile(block, str(page), "exec"), names)


@pytest.mark.parametrize("example", sorted((SOURCE / "examples" / "python").glob("*.py")), ids=lambda p: p.stem)
def test_the_example_runs(example, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(example)])
    runpy.run_path(str(example), run_name="__main__")
    assert capsys.readouterr().out
