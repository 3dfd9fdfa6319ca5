"""Published studies: the package writes the same bytes as the command."""

import pytest
from use_examples import BUILD, command

import abbe


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def same_bytes(paper, folder):
    if not (BUILD / "bin/abbe-papers").exists():
        pytest.skip("abbe-papers is not built")
    made = abbe.reproduce(paper, folder / "package")
    command(["reproduce", paper, "--output", "command"], folder, exit_code=0, timeout=600)
    assert made.agrees in (True, None) and made.summary["paper"] == paper and not made.summary["failures"]
    theirs = contents(folder / "command")
    assert contents(folder / "package") == theirs
    assert made.files == sorted(path.as_posix() for path in theirs if not path.name.startswith("."))


# Package and command start the same program: two studies show that what is asked of it is the same. The command's tests
# recompute all five.
@pytest.mark.parametrize("paper", ["ma", "wang"])
def test_a_published_study_is_that_of_the_command(paper, tmp_path):
    same_bytes(paper, tmp_path)
