"""Exceptions of the package."""

from __future__ import annotations


class InputError(ValueError):
    """Bad input: what is wrong, where, and what was expected.

    ``str(error)`` reads ``file:line:column: field: problem; expected ...``; what is unknown is left out there and is
    ``None`` in the attributes.
    """

    file: str | None  #: name of the file as it was given
    line: int | None  #: from 1
    column: int | None  #: character in the line, from 1
    field: str | None  #: key or column as written: ``axis.X.travel_mm``
    problem: str | None  #: what was found
    expected: str | None  #: what would be right, with its unit

    def __init__(self, text: str, file: str | None = None, line: int | None = None, column: int | None = None,
                 field: str | None = None, problem: str | None = None, expected: str | None = None) -> None:
        super().__init__(text)
        self.file = file
        self.line = line
        self.column = column
        self.field = field
        self.problem = problem
        self.expected = expected


class Stopped(Exception):
    """A progress callback asked for an end by raising :class:`StopIteration`; there is no result."""
