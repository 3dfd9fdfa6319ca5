"""The examples in the documentation of every class, method, property and function of the package."""
import doctest
import inspect

import pytest

import abbe


def documented():
    """(name, documentation) of all that the package offers, and of the members of its classes."""
    for name in abbe.__all__:
        value = getattr(abbe, name)
        yield f"abbe.{name}", inspect.getdoc(value) or ""
        if isinstance(value, type):
            for member, attribute in vars(value).items():
                if not member.startswith("_") and isinstance(attribute.__doc__, str):
                    yield f"abbe.{name}.{member}", inspect.getdoc(attribute) or ""


EXAMPLES = {name: text for name, text in documented() if ">>>" in text}


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_gives_what_it_says(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = doctest.DocTestParser().get_doctest(EXAMPLES[name], {}, name, None, None)
    said = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=said.append)
    assert not said, "".join(said)


def test_there_are_examples():
    assert "abbe.Study" in EXAMPLES and "abbe.PoseModel" in EXAMPLES


def test_every_class_and_function_says_what_it_is():
    assert [name for name in abbe.__all__ if callable(getattr(abbe, name)) and not getattr(abbe, name).__doc__] == []
