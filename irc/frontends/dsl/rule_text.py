"""Writes couplings, selections and orders of uses as statements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from irc.frontends.dsl import written
from irc.frontends.dsl.lexer import RULE_WORDS, quoted

if TYPE_CHECKING:
    from irc.model import Task
    from irc.model.details import ChoiceMade, CoupledAction, Coupling, Selection, UseOrder

_WIDEST = 98


def rules(task: Task) -> list[str]:
    """The statements, in the order of the document."""
    return [
        *map(_coupling, task.couplings),
        *map(_selection, task.select),
        *(line for order in task.sequences for line in _order(order)),
    ]


def _coupling(coupling: Coupling) -> str:
    if coupling.if_ is not None and coupling.then is not None:
        return f"if {_made(coupling.if_)} then {_made(coupling.then)}"
    word, what = ("same", coupling.same) if coupling.same else ("different", coupling.different)
    return f"{word} {what} {', '.join(map(_tied, coupling.actions))}"


def _tied(member: CoupledAction) -> str:
    return _name(member.action) + ("" if member.use is None else f" use {member.use}")


def _made(made: ChoiceMade) -> str:
    use = "" if made.use is None else f" use {made.use}"
    if made.resource is not None:
        return f"{_name(made.action)} on {_name(made.resource)}{use}"
    return f"{_name(made.action)} mode {' or '.join(map(_name, made.in_modes))}{use}"


def _selection(selection: Selection) -> str:
    least, most = selection.min, selection.max
    said = selection.model_fields_set
    if selection.all_or_none:
        count = "all or none"
    elif "min" in said and least == most:
        count = str(least)
    else:
        low = str(least) if "min" in said else ""
        high = "" if most is None else str(most)
        count = " ".join(f"{low} .. {high}".split())
    condition = "" if selection.if_ is None else f" if {_name(selection.if_)}"
    return f"select {count} of {_names(selection.actions)}{condition}"


def _order(order: UseOrder) -> Iterator[str]:
    if order.consecutive is not None:
        on = "" if order.resource is None else f" on {_name(order.resource)}"
        yield f"consecutive {_names(order.consecutive)}{on}"
        return
    head = f"same order on {_names(order.same_order or ())}"
    if not order.jobs:
        yield head
        return
    rows = [f"[{_names(row)}]" for row in order.jobs]
    line = f"{head} jobs {', '.join(rows)}"
    if len(line) <= _WIDEST:
        yield line
        return
    yield f"{head} jobs"
    for k, row in enumerate(rows, 1):
        yield f"    {row}{',' if k < len(rows) else ''}"


def _name(text: str) -> str:
    """A name, in quotes where a word of it has a meaning in these statements."""
    return written.name(text) if RULE_WORDS.isdisjoint(text.split()) else quoted(text)


def _names(texts: Iterable[str]) -> str:
    return ", ".join(map(_name, texts)) or "[]"
