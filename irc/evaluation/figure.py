"""Figures: a mean over answers that remembers them, so that it can say how sure it is."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

PLACES = 4


@dataclass(frozen=True)
class Rate:
    """A mean over answers, times `scale` (100 for percent).

    `instances` are the instances of the answers: answers to one instance are drawn together.
    """

    values: tuple[float, ...]
    instances: tuple[Hashable, ...]
    scale: int = 1

    @property
    def value(self) -> float:
        """The figure; 0 without answers."""
        mean = sum(self.values) / len(self.values) if self.values else 0
        return round(self.scale * mean, PLACES)


@dataclass(frozen=True)
class Count:
    """A number of answers."""

    value: float


Figure = Rate | Count
Table: TypeAlias = "Mapping[str, Table] | Sequence[Figure] | Figure"
"""Figures by name, to any depth."""

Document: TypeAlias = "dict[str, Document] | list[Document] | float | None"


def document(table: Table, of: Callable[[Figure], Document]) -> Document:
    """A table as JSON, with what `of` makes of each figure."""
    if isinstance(table, Rate | Count):
        return of(table)
    if isinstance(table, Mapping):
        return {name: document(inner, of) for name, inner in table.items()}
    return [of(figure) for figure in table]


def number(figure: Figure) -> float:
    """The value of a figure, a whole number as such."""
    value = figure.value
    return int(value) if isinstance(figure, Count) and value == int(value) else value


def walk(table: Table, path: tuple[str, ...] = ()) -> Iterable[tuple[tuple[str, ...], Figure]]:
    """Each figure with the names that lead to it."""
    if isinstance(table, Rate | Count):
        yield path, table
    elif isinstance(table, Mapping):
        for name, inner in table.items():
            yield from walk(inner, (*path, name))
    else:
        for k, figure in enumerate(table):
            yield (*path, str(k)), figure
