"""Results of the benchmarks as text and as JSON."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from timing import Time


@dataclass
class Row:
    """One line: what was timed and how long it took by the clock and of the processor, and both as ratios."""

    what: str
    clock: float
    processor: float
    ratio: float | None = None
    ratio_of_processor: float | None = None
    target: float | None = None  #: of the ratio by the clock, or of the time if there is no ratio
    met: bool | None = None


@dataclass
class Table:
    title: str
    unit: str  #: of the times
    ratio: str = ""  #: what the ratio is
    rows: list[Row] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def add(self, what: str, time: Time, ratio_to: Time | None = None, *, at_most: float | None = None,
            at_least: float | None = None) -> None:
        """A row; time in the unit of the table. ratio_to: what it is divided by."""
        row = Row(what, *time)
        if ratio_to is not None:
            row.ratio, row.ratio_of_processor = time.clock / ratio_to.clock, time.processor / max(ratio_to.processor, 1e-12)
        judged = row.clock if row.ratio is None else row.ratio
        if at_most is not None:
            row.target, row.met = at_most, judged <= at_most
        elif at_least is not None:
            row.target, row.met = at_least, judged >= at_least
        self.rows.append(row)

    def text(self) -> str:
        width = max((len(row.what) for row in self.rows), default=0)
        head = f"{'':{width}}  {'by the clock':>14}  {'processor':>14}"
        lines = [self.title, "-" * len(self.title), head + (f"   {self.ratio}: clock, processor" if self.ratio else "")]
        for row in self.rows:
            line = f"{row.what:{width}}  {row.clock:>11.4g} {self.unit}  {row.processor:>11.4g} {self.unit}"
            if row.ratio is not None and row.ratio_of_processor is not None:
                line += f"   {row.ratio:>7.4g} {row.ratio_of_processor:>7.4g}"
            if row.met is not None:
                line += f"   target {row.target:g}   {'met' if row.met else 'MISSED'}"
            lines.append(line)
        return "\n".join(lines + self.notes)


def to_json(tables: list[Table], conditions: dict[str, Any]) -> dict[str, Any]:
    return {"format": "abbe-python-benchmarks/1", "conditions": conditions, "tables": [asdict(table) for table in tables]}
