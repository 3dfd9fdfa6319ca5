"""Published studies, recomputed by the program abbe-papers that comes with the command."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from typing import Any

from ._core import __version__
from ._errors import InputError

#: Names of the studies, and what they are about.
PAPERS = {
    "aguado": "laser tracker on a machine w C' X' b Z t, strategies of identification (2014)",
    "liu": "cradle-type five-axis scanner: points, error terms, calibrations, virtual measurement (2021)",
    "ma": "six motions of a rotary table by a polygon prism (2021)",
    "wang": "36 measured errors of a grinder w C b X Z A Y B t, integrated error (2020)",
    "yin": "laser engraver measures its linkage and the place of its workpiece (2021)",
}

_PROGRAM = "abbe-papers"
_VARIABLE = "ABBE_PAPERS_PROGRAM"
_VERSION_SECONDS = 10


@dataclass(frozen=True)
class Reproduction:
    """A published study, recomputed: its figures beside ours. Made by :func:`reproduce`."""

    paper: str
    output: pathlib.Path | None  #: folder of results; None: none was wanted
    files: list[str]  #: names in it, sorted
    summary: dict[str, Any]  #: contents of its summary.json

    @property
    def agrees(self) -> bool | None:
        """Whether our figures are those of the reference; None: there is none."""
        agrees: bool | None = self.summary["agrees_with_reference"]
        return agrees

    def to_dict(self) -> dict[str, Any]:
        """The same as `abbe reproduce --json`."""
        return self.summary

    def __repr__(self) -> str:
        return f"<abbe.Reproduction of {self.paper}: {len(self.files)} files>"


def _error(problem: str, expected: str, field: str | None = None, file: str | None = None) -> InputError:
    place = ": ".join(part for part in (file, field) if part)
    return InputError(f"{place + ': ' if place else ''}{problem}; expected {expected}", file=file, field=field,
                      problem=problem, expected=expected)


def _candidates() -> list[pathlib.Path]:
    """Where the program may be: with the scripts of this package, beside an `abbe` on the path."""
    folders = [sysconfig.get_path("scripts"), os.path.dirname(sys.executable or "")]
    for scheme in sysconfig.get_scheme_names():
        if scheme.endswith("_user"):
            folders.append(sysconfig.get_path("scripts", scheme))
    command = shutil.which("abbe")
    if command:
        folders.append(os.path.dirname(command))
    # A build folder: build/release/python/abbe beside build/release/bin.
    folders.append(str(pathlib.Path(__file__).parent.parent.parent / "bin"))
    return [pathlib.Path(folder) / _PROGRAM for folder in folders if folder]


def _find_program() -> str:
    named = os.environ.get(_VARIABLE)
    if named:
        found = shutil.which(named)
        if found is None:
            raise _error("is no program that can be run", f"the program {_PROGRAM}", _VARIABLE, named)
        return found
    for candidate in _candidates():
        if candidate.is_file() and os.access(candidate, os.X_OK):
            return str(candidate)
    found = shutil.which(_PROGRAM)
    if found is None:
        raise _error("this program, which recomputes the published studies, is missing",
                     f"it beside the command abbe, or its name in the environment variable {_VARIABLE}", file=_PROGRAM)
    return found


def _check_version(program: str) -> None:
    """Programs of two versions would take each other's options and results for their own."""
    try:
        asked = subprocess.run([program, "--version"], capture_output=True, text=True, errors="replace",
                               timeout=_VERSION_SECONDS, stdin=subprocess.DEVNULL, check=False)
        words = asked.stdout.split()
    except (OSError, subprocess.TimeoutExpired) as error:
        raise _error(f"cannot be started: {error}", f"{_PROGRAM} {__version__}", file=program) from error
    if asked.returncode == 0 and words == [_PROGRAM, __version__]:
        return
    stated = words[1] if len(words) == 2 and words[0] == _PROGRAM else None
    problem = f"is version {stated}" if stated else "does not state its version"
    raise _error(f"{problem}, and abbe is {__version__}", f"{_PROGRAM} {__version__}", file=program)


def _run(command: list[str], quiet: bool) -> str:
    """What the program prints. An interruption ends it too, and is passed on when it has ended."""
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True, encoding="utf-8",
                          errors="replace", stderr=subprocess.PIPE if quiet else None) as program:
        try:
            printed, told = program.communicate()
        except BaseException:
            program.terminate()
            try:
                program.wait(timeout=10)
            except subprocess.TimeoutExpired:
                program.kill()
            raise
    # 1: figures do not agree with the reference; the summary says which.
    if program.returncode in (0, 1) and printed:
        return printed
    reason = (told or "").strip().removeprefix("abbe: ") or f"{_PROGRAM} ended with exit code {program.returncode}"
    raise InputError(reason, problem=reason)


def reproduce(paper: str, output: str | os.PathLike[str] | None = None, *, grids: str | os.PathLike[str] | None = None,
              threads: int = 0, quiet: bool = True) -> Reproduction:
    """Recomputes a published study: its figures beside ours, and where its equations are wrong.

    paper: a name of :data:`PAPERS`. output: folder to write, with tables, figures, a report and the study; without one
    only the summary is made. grids, for 'wang': decouple the indications of this folder (X.csv, A.csv, ...) instead.
    threads: 0 for all. quiet: do not show progress on standard error. Ctrl-C ends the program.

    The program abbe-papers does this. It is looked for beside the command of this package, then on the path; the
    environment variable ABBE_PAPERS_PROGRAM names another one. Raises InputError if it is not there or of another
    version, and for what it refuses.

    >>> import abbe
    >>> abbe.reproduce('nobody')
    Traceback (most recent call last):
    abbe._errors.InputError: paper: 'nobody' is no study; expected aguado, liu, ma, wang or yin
    """
    if paper not in PAPERS:
        raise _error(f"'{paper}' is no study", "aguado, liu, ma, wang or yin", "paper")
    if grids is not None and paper != "wang":
        raise _error(f"does not belong to {paper}", "'wang'", "grids")
    if not isinstance(threads, int) or not 0 <= threads <= 64:
        raise _error(f"is {threads}", "0 to 64", "threads")
    program = _find_program()
    _check_version(program)
    # Values stand behind "=", so that one that begins with a dash stays a value.
    command = [program, paper, "--json"]
    if output is not None:
        command.append(f"--output={os.fspath(output)}")
    if grids is not None:
        command.append(f"--grids={os.fspath(grids)}")
    if threads:
        command.append(f"--threads={threads}")
    if quiet:
        command.append("--quiet")
    printed = _run(command, quiet)
    if output is None:
        return Reproduction(paper, None, [], json.loads(printed))
    folder = pathlib.Path(output)
    files = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*")
                   if path.is_file() and not path.name.startswith("."))
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return Reproduction(paper, folder, files, summary)
