"""Rows: one scored answer each, and what tables take of them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass, field

from irc.evaluation.figure import Count, Rate
from irc.evaluation.graph_rules import Scores
from irc.methods import AnswerState

MODELS = ("gemini", "gpt", "deepseek", "qwen")


@dataclass(frozen=True)
class Row:
    """One scored answer: whose it is, to which instance, and its measures by name.

    `group` is the size or the family of the instance. `error` is what ended the run, where
    something did.
    """

    model: str
    group: str
    instance: Hashable
    scores: Scores
    state: AnswerState = AnswerState.OK
    service_failure: bool = False
    overflow: bool = False
    error: str | None = None


@dataclass(frozen=True)
class Rows:
    """The scored answers of one method."""

    rows: tuple[Row, ...] = ()
    _groups: dict[tuple[str, str], tuple[Row, ...]] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        found: dict[tuple[str, str], list[Row]] = {}
        for row in self.rows:
            found.setdefault((row.model, row.group), []).append(row)
        self._groups.update((key, tuple(rows)) for key, rows in found.items())

    @property
    def models(self) -> tuple[str, ...]:
        """The models that have answers, in the paper's order, others behind."""
        found = dict.fromkeys(row.model for row in self.rows)
        return (*(m for m in MODELS if m in found), *(m for m in found if m not in MODELS))

    @property
    def groups(self) -> tuple[str, ...]:
        """The sizes or families that have answers, sizes by number."""
        found = dict.fromkeys(row.group for row in self.rows)
        return tuple(sorted(found, key=lambda g: (int(g) if g.isdigit() else 0, g)))

    def cell(self, model: str, group: str) -> tuple[Row, ...]:
        """The answers of one model to the instances of one group."""
        return self._groups.get((model, group), ())

    def of_model(self, model: str) -> tuple[Row, ...]:
        """The answers of one model."""
        return tuple(row for row in self.rows if row.model == model)

    def of_group(self, group: str) -> tuple[Row, ...]:
        """The answers to the instances of one group."""
        return tuple(row for row in self.rows if row.group == group)


def rate(rows: Iterable[Row], measure: str, scale: int = 1) -> Rate:
    """The mean of a measure."""
    found = tuple(rows)
    values = tuple(float(row.scores[measure]) for row in found)
    return Rate(values, tuple(row.instance for row in found), scale)


def percents(rows: Sequence[Row], measures: Iterable[str]) -> dict[str, Rate]:
    """The means of several measures, in percent."""
    return {measure: rate(rows, measure, 100) for measure in measures}


def count(rows: Iterable[Row], holds: Callable[[Row], object]) -> Count:
    """How many answers something holds of."""
    return Count(sum(1 for row in rows if holds(row)))
