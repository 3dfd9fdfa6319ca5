"""What several tests need."""

import pathlib
import re

import pytest

import abbe

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def examples() -> pathlib.Path:
    return ROOT / "examples"


@pytest.fixture
def trunnion(examples: pathlib.Path) -> abbe.Errors:
    """A five-axis mill with 30 error motions and 11 location errors."""
    machine = abbe.Machine.read(examples / "machines/trunnion-mill.machine.toml")
    return abbe.Errors.read(examples / "compensate/trunnion.errors.toml", machine)


@pytest.fixture
def names_argument(tmp_path, monkeypatch):
    """names_argument(name, call): the call is refused with a message that names this argument, and no option."""
    monkeypatch.chdir(tmp_path)

    def check(name, call):
        with pytest.raises(abbe.InputError) as error:
            call()
        assert name in str(error.value) and not re.search("--[a-z]", str(error.value))

    return check
