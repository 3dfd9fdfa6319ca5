"""Customer reports: facts as dictionaries or files."""

from __future__ import annotations

import datetime
import os
from collections.abc import Mapping, Sequence
from typing import Any, Union

import tomli_w

from . import _core
from ._core import CustomerReport, Errors, Evaluation, StudyResult

PathLike = Union[str, "os.PathLike[str]"]
Facts = Union[Mapping[str, Any], PathLike]


def _plain(value: Any) -> Any:
    """What tomli_w writes as a file of facts has it: days as texts."""
    if isinstance(value, datetime.date):
        return value.isoformat()
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    return value


def _facts(facts: Facts) -> _core._ReportFacts:
    if isinstance(facts, Mapping):
        return _core._ReportFacts.parse(tomli_w.dumps(_plain(facts)))
    return _core._ReportFacts.read(facts)


def customer_report(result: Evaluation | StudyResult, facts: Facts | None = None, *,
                    before: Evaluation | Errors | StudyResult | PathLike | None = None,
                    files: Sequence[str] = ()) -> CustomerReport:
    """A customer report on an evaluation or on an identification.

    ``facts``: a dictionary with the keys of ``[report]`` (docs/customer-report.md), or a file with that table; they take
    the place of those in the document of a study. Days are texts or :class:`datetime.date`. ``tolerances`` among them are
    added to those of the evaluation. What is not stated is shown as not stated. ``before``: the state before a correction,
    an evaluation; of a study, errors, a result or its folder. ``files``: names of the files with the readings, which the
    report lists at its end; a study knows its own.

    Raises :class:`abbe.InputError` with the fact that is wrong, and for tolerances of figures that there are not.

    >>> import abbe
    >>> rows = {'direction': ['+', '-'] * 10, 'target_mm': [0, 0, 100, 100] * 5,
    ...         'deviation_um': [1, 1.5, 2, 2.5, 1.2, 1.4, 2.1, 2.6] * 2 + [1, 1.5, 2, 2.5]}
    >>> test = abbe.evaluate_positioning(rows, uncertainty={'instrument_um_per_m': 0.6})
    >>> report = abbe.customer_report(test, {'customer': {'name': 'Example Ltd'}, 'date': '2026-11-28',
    ...                                      'tolerances': {'A_um': 6}})
    >>> report.figures[0].symbol, report.figures[0].verdicts, report.exceeded
    ('A', ['pass'], '')
    >>> report.write('report.html')
    """
    if isinstance(files, str):
        raise TypeError("files is a str; expected a list of names")
    if isinstance(result, Evaluation):
        if before is not None and not isinstance(before, Evaluation):
            raise TypeError(f"before is a {type(before).__name__}; expected an Evaluation")
        return _core._customer_report_of_evaluation(result, _facts({} if facts is None else facts), before, list(files))
    if isinstance(before, Evaluation):
        raise TypeError("before is an Evaluation; expected Errors, a StudyResult or a path")
    if files:
        raise TypeError("files: a study knows the names of its own")
    return _core._customer_report_of_study(result, None if facts is None else _facts(facts), before)
