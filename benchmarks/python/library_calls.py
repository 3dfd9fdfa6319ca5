"""The same calls of the library without Python: the program of library_calls.cpp, which is told what to do line by line."""

from __future__ import annotations

import os
import pathlib
import subprocess
import tempfile

import numpy
from timing import Time

ROOT = pathlib.Path(__file__).resolve().parents[2]


class LibraryCalls:
    """The running program. Times are those that it measures itself."""

    def __init__(self) -> None:
        program = os.environ.get("ABBE_LIBRARY_CALLS") or str(ROOT / "build/release/bin/library_calls")
        self._folder = tempfile.TemporaryDirectory()
        self._program = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self) -> LibraryCalls:
        return self

    def __exit__(self, *_: object) -> None:
        self._program.communicate()
        self._folder.cleanup()

    def ask(self, *words: object) -> Time:
        assert self._program.stdin and self._program.stdout
        self._program.stdin.write("\t".join(str(word) for word in words) + "\n")
        self._program.stdin.flush()
        answer = self._program.stdout.readline().strip()
        if not answer or answer.startswith("failed"):
            raise RuntimeError(f"{words[0]}: {answer or 'the program has ended'}")
        return Time(*map(float, answer.split()))

    def take_commands(self, commands: numpy.ndarray, order: str) -> None:
        path = pathlib.Path(self._folder.name) / "commands"
        (commands.T if order == "columns" else commands).astype(float, order="C").tofile(path)
        self.ask("commands", path, commands.shape[1], order)

    def numbers(self, what: str) -> numpy.ndarray:
        """What it writes for 'results' or 'estimates'."""
        path = pathlib.Path(self._folder.name) / "numbers"
        self.ask(what, path)
        return numpy.fromfile(path)
