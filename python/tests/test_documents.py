"""The examples of docs/python.md run as they stand, from the root of the repository."""

import contextlib
import io
import re

import pytest
from use_examples import EXAMPLES, ROOT

PROGRAMS = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs/python.md").read_text(encoding="utf-8"), re.M | re.S)


def heading(program):
    """What the example is about: the first function of the package that it calls."""
    return re.search(r"abbe\.(\w+)\(", program.split("from_chain", 1)[-1])[1]


@pytest.mark.parametrize("program", PROGRAMS, ids=heading)
def test_example_runs(program, tmp_path, monkeypatch):
    (tmp_path / "examples").symlink_to(EXAMPLES)
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(program, "docs/python.md", "exec"), {"__name__": "example"})
    assert printed.getvalue().strip()


def test_there_are_examples():
    assert len(PROGRAMS) >= 5
