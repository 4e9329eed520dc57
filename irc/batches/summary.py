"""The comparison of a batch's targets and engines: a row for each, and its plot."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from irc.batches.result import BatchResult
from irc.batches.trial import Pairing
from irc.model.quantities import Number
from irc.outcome import FAILED, FAULTY, INFEASIBLE, INTERRUPTED, MISSING, REFUSED, UNKNOWN

_NO_ANSWER = (UNKNOWN, INTERRUPTED)
_BROKEN = (FAILED, MISSING)
_DIGITS = 3


class _Short(NamedTuple):
    """The part of a result that the summary keeps."""

    status: str
    answered: bool
    proven: bool
    seconds: float
    gap: float | None
    costs: tuple[Number, ...]
    sha256: str


@dataclass(frozen=True, slots=True)
class SummaryRow:
    """The results of one target and engine.

    `solved` trials have a schedule, `proven` ones the best schedule or a proof that there is none.
    `best` counts schedules as good as the best that any target and engine has of the task. Seconds
    are those of the trials that are solved or proven; `mean_gap` is that of the schedules with a
    bound (0: all are proven the best), and `times` are the seconds in order.
    """

    pair: Pairing
    tasks: int
    solved: int
    proven: int
    infeasible: int
    best: int
    no_answer: int
    refused: int
    faulty: int
    failed: int
    median_seconds: float | None
    most_seconds: float | None
    total_seconds: float
    mean_gap: float | None
    times: tuple[float, ...] = field(repr=False)

    def to_dict(self) -> dict[str, object]:
        """The row as a JSON object, without the times."""
        return {
            "target": self.pair.target,
            "engine": self.pair.engine,
            **{name: getattr(self, name) for name in _NUMBERS},
        }


_NUMBERS = (
    *("tasks", "solved", "proven", "infeasible", "best", "no_answer", "refused", "faulty"),
    *("failed", "median_seconds", "most_seconds", "total_seconds", "mean_gap"),
)


class Summary:
    """Results added one after the other; of one task, target and engine the last one counts."""

    def __init__(self, results: Iterable[BatchResult] = ()) -> None:
        self._found: dict[Pairing, dict[str, _Short]] = {}
        for result in results:
            self.add(result)

    def add(self, result: BatchResult) -> None:
        """Counts a result; nothing of it is kept but a few numbers."""
        pair = Pairing(result.target, result.engine)
        self._found.setdefault(pair, {})[result.task] = _Short(
            result.status,
            result.outcome.answered,
            result.proven,
            result.seconds,
            result.gap,
            _costs(result),
            result.sha256,
        )

    @property
    def rows(self) -> list[SummaryRow]:
        """A row for each target and engine, in order of their names."""
        best = self._best()
        return [_row(pair, found, best) for pair, found in sorted(self._found.items())]

    def _best(self) -> Mapping[tuple[str, str], tuple[Number, ...]]:
        """The costs of the best schedule of each task, by its name and digest."""
        best: dict[tuple[str, str], tuple[Number, ...]] = {}
        for found in self._found.values():
            for task, short in found.items():
                if short.answered:
                    key = (task, short.sha256)
                    best[key] = min(best.get(key, short.costs), short.costs)
        return best

    def to_dict(self) -> dict[str, object]:
        """The summary as a JSON object."""
        return {"irc_summary": "1", "rows": [row.to_dict() for row in self.rows]}

    def __str__(self) -> str:
        """The table in text; columns without any entry are left out."""
        rows = self.rows
        if not rows:
            return "there are no results"
        columns = [
            (title, [_cell(row, name) for row in rows])
            for title, name in _COLUMNS
            if name in _ALWAYS or any(_shows(row, name, len(rows)) for row in rows)
        ]
        return "\n".join(_aligned(columns))


_COLUMNS = (
    ("target", "target"),
    ("engine", "engine"),
    *((name.replace("_", " "), name) for name in _NUMBERS[:9]),
    ("median s", "median_seconds"),
    ("most s", "most_seconds"),
    ("total s", "total_seconds"),
    ("gap %", "mean_gap"),
)
_ALWAYS = ("target", "engine", "tasks", "solved", "proven", "median_seconds", "total_seconds")


def _shows(row: SummaryRow, name: str, rows: int) -> bool:
    if name == "best":
        return rows > 1
    return getattr(row, name) not in (0, None) or name == "mean_gap"


def _cell(row: SummaryRow, name: str) -> str:
    if name in ("target", "engine"):
        return str(getattr(row.pair, name))
    value = getattr(row, name)
    if value is None:
        return "–"
    if name == "mean_gap":
        return f"{100 * value:.2f}"
    return f"{value:,.3f}" if isinstance(value, float) else f"{value:,}"


def _aligned(columns: Sequence[tuple[str, list[str]]]) -> list[str]:
    """Lines of a table: names to the left, numbers to the right."""
    widths = [max(len(title), *map(len, cells)) for title, cells in columns]

    def line(cells: Iterable[str]) -> str:
        shown = (
            f"{cell:{'<' if k < 2 else '>'}{width}}"
            for k, (cell, width) in enumerate(zip(cells, widths, strict=True))
        )
        return "  ".join(shown).rstrip()

    head = line(title for title, _ in columns)
    body = [line(cells) for cells in zip(*(cells for _, cells in columns), strict=True)]
    return [head, "  ".join("─" * width for width in widths), *body]


def _costs(result: BatchResult) -> tuple[Number, ...]:
    """The objective values in their order; less is better, so rewards are negative."""
    return tuple(-o.value if o.name == "reward" else o.value for o in result.objective)


def _row(
    pair: Pairing,
    found: Mapping[str, _Short],
    best: Mapping[tuple[str, str], tuple[Number, ...]],
) -> SummaryRow:
    shorts = list(found.values())
    count = Counter(short.status for short in shorts)
    times = sorted(short.seconds for short in shorts if short.answered or short.proven)
    gaps = [short.gap for short in shorts if short.gap is not None]
    return SummaryRow(
        pair,
        tasks=len(shorts),
        solved=sum(short.answered for short in shorts),
        proven=sum(short.proven for short in shorts),
        infeasible=count[INFEASIBLE],
        best=sum(s.answered and s.costs == best[task, s.sha256] for task, s in found.items()),
        no_answer=sum(not s.answered and s.status in _NO_ANSWER for s in shorts),
        refused=count[REFUSED],
        faulty=count[FAULTY],
        failed=sum(count[status] for status in _BROKEN),
        median_seconds=round(statistics.median(times), _DIGITS) if times else None,
        most_seconds=times[-1] if times else None,
        total_seconds=round(sum(short.seconds for short in shorts), _DIGITS),
        mean_gap=round(statistics.fmean(gaps), 6) if gaps else None,
        times=tuple(times),
    )
