"""The reference of the Python package has every public name, and its signatures are those that a reader writes."""

import html.parser
import inspect
import os
import pathlib
import re

import pytest

import abbe

PAGES = sorted((pathlib.Path(os.environ["ABBE_SITE"]) / "reference/python").glob("*.html"))
if not PAGES:
    pytest.skip("the site was not built", allow_module_level=True)


class Definitions(html.parser.HTMLParser):
    """The `dt` elements that have an id: id -> text."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: dict[str, str] = {}
        self.name: str | None = None

    def handle_starttag(self, tag, attributes):
        if tag == "dt":
            self.name = dict(attributes).get("id")

    def handle_endtag(self, tag):
        if tag == "dt":
            self.name = None

    def handle_data(self, data):
        if self.name:
            self.texts[self.name] = self.texts.get(self.name, "") + data


def definitions():
    parser = Definitions()
    for page in PAGES:
        parser.feed(page.read_text(encoding="utf-8"))
    return parser.texts


DEFINITIONS = definitions()
CLASSES = [name for name in abbe.__all__ if isinstance(getattr(abbe, name), type)]


def members(kind):
    """Public names of a class and of those it is derived from, but not of Python's own."""
    return sorted(
        {
            name
            for base in kind.__mro__
            if base.__module__ != "builtins"
            for name in vars(base)
            if not name.startswith("_")
        }
    )


def test_every_public_name_is_there():
    wanted = {f"abbe.{name}" for name in abbe.__all__}
    wanted |= {f"abbe.{name}.{member}" for name in CLASSES for member in members(getattr(abbe, name))}
    assert sorted(wanted - set(DEFINITIONS)) == []
    assert len(wanted) > 300


def test_nothing_is_there_that_the_package_does_not_have():
    def exists(name):
        value = abbe
        for part in name.split(".")[1:]:
            # Fields of data classes and exceptions are annotated only.
            if not hasattr(value, part):
                return part in getattr(value, "__annotations__", {})
            value = getattr(value, part)
        return True

    import abbe.plot  # noqa: F401

    assert [name for name in DEFINITIONS if not exists(name)] == []


def test_every_function_of_the_plots_is_there():
    import abbe.plot

    functions = [
        name
        for name, value in vars(abbe.plot).items()
        if inspect.isfunction(value) and value.__module__ == "abbe.plot" and not name.startswith("_")
    ]
    assert [name for name in functions if f"abbe.plot.{name}" not in DEFINITIONS] == []
    assert len(functions) > 5


@pytest.mark.parametrize(
    "trace",
    [
        r"_core",
        r"nanobind",
        r"\bAnnotated\b",
        r"\barg\d?\b",
        r"\bself\b",
        r"collections\.abc",
        r"builtins",
        r"\btyping\.",
        r"<",
    ],
)
def test_signatures_have_no_trace_of_how_they_are_made(trace):
    assert [text for text in DEFINITIONS.values() if re.search(trace, text)] == []


def test_signatures_are_those_of_the_package():
    study = inspect.signature(abbe.Study.run)
    shown = DEFINITIONS["abbe.Study.run"]
    assert all(name in shown for name in study.parameters if name != "self"), shown
    assert "StudyResult" in shown
