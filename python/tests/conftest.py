"""What several tests need."""

import pathlib

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
