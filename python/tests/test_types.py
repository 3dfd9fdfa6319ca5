"""Types: mypy in strict mode accepts the package and a program that uses it, and finds a mistake in one."""
import os
import subprocess
import sys
from pathlib import Path

import abbe

PACKAGE = Path(abbe.__file__).parent
EXAMPLE = Path(__file__).parent / "typed_example.py"


def mypy(tmp_path, *paths):
    cache = os.environ.get("ABBE_MYPY_CACHE", str(tmp_path / "mypy"))
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={cache}", *map(str, paths)],
                          env={**os.environ, "MYPYPATH": str(PACKAGE.parent)}, cwd=tmp_path, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def test_package_and_example_are_typed(tmp_path):
    code, said = mypy(tmp_path, PACKAGE, EXAMPLE)
    assert code == 0, said


def test_a_wrong_type_is_found(tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import abbe\nabbe.Machine.read(3)\nabbe.Machine.from_chain('w b Z t').axes.nothing\n", encoding="utf-8")
    code, said = mypy(tmp_path, wrong)
    assert code == 1 and said.count("error:") == 2, said


def test_the_example_runs(tmp_path):
    done = subprocess.run([sys.executable, str(EXAMPLE)], env={**os.environ, "PYTHONPATH": str(PACKAGE.parent)}, cwd=tmp_path,
                          capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "-0.0040 mm\n"), done.stderr


def test_the_package_says_that_it_is_typed():
    assert (PACKAGE / "py.typed").is_file()
