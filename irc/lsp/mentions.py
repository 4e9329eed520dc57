"""Finds every place of a document where an element is declared or named, by pointer.

Works on the plain document of any language. Parts that do not have the IR's shape are skipped; the
checks report them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from irc.diagnostics.source import Pointer


class Kind(StrEnum):
    """The kind of the element that a name names."""

    ACTION = "action"
    RESOURCE = "resource"
    VARIABLE = "state variable"
    VALUE = "value"
    GROUP = "group"


@dataclass(frozen=True, slots=True)
class Mention:
    """A name in a document. For a value, `owner` is its state variable."""

    kind: Kind
    name: str
    pointer: Pointer
    declares: bool = False
    owner: str | None = None


def mentions(document: Mapping[str, Any]) -> Iterator[Mention]:
    """All mentions of a document."""
    yield from _parts(document, ())
    for at, event in _objects(document, "events", ()):
        for pointer, change in _objects(event, "changes", at):
            yield from _parts(change, pointer)
            yield from _change(change, pointer)


def _parts(holder: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    """The mentions in the arrays that both a task and the changes of an event may have."""
    for pointer, resource in _objects(holder, "resources", at):
        yield from _name(resource, "id", pointer, Kind.RESOURCE, declares=True)
    for pointer, variable in _objects(holder, "state", at):
        yield from _variable(variable, pointer)
    for pointer, action in _objects(holder, "actions", at):
        yield from _action(action, pointer)
    for key in ("precedence", "dependencies"):
        for pointer, arc in _items(holder, key, at):
            yield from _arc(arc, pointer)
    for pointer, group in _objects(holder, "groups", at):
        yield from _name(group, "id", pointer, Kind.GROUP, declares=True)
        yield from _names(group, "actions", pointer, Kind.ACTION)
    yield from _rules(holder, at)
    for pointer, goal in _items(holder, "goals", at):
        if isinstance(goal, str):
            yield Mention(Kind.ACTION, goal, pointer)
        elif isinstance(goal, Mapping):
            yield from _fact(goal, pointer)


def _rules(holder: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    """The names in couplings, selections and orders of uses."""
    groups = {group.get("id") for _, group in _objects(holder, "groups", at)}
    for pointer, coupling in _objects(holder, "couplings", at):
        yield from _names(coupling, "actions", pointer, Kind.ACTION)
        members = [place for place, _ in _objects(coupling, "actions", pointer)]
        made = [(*pointer, key) for key in ("if", "then")]
        chosen = [one for _, one in _objects(coupling, "actions", pointer)]
        chosen += [coupling.get(key) or {} for key in ("if", "then")]
        for place, one in zip((*members, *made), chosen, strict=True):
            if isinstance(one, Mapping):
                yield from _name(one, "action", place, Kind.ACTION)
                yield from _name(one, "resource", place, Kind.RESOURCE)
    for pointer, selection in _objects(holder, "select", at):
        for mention in (
            *_names(selection, "actions", pointer, Kind.ACTION),
            *_name(selection, "if", pointer, Kind.ACTION),
        ):
            of_group = mention.name in groups
            yield Mention(Kind.GROUP, mention.name, mention.pointer) if of_group else mention
    for pointer, order in _objects(holder, "sequences", at):
        yield from _names(order, "consecutive", pointer, Kind.ACTION)
        yield from _name(order, "resource", pointer, Kind.RESOURCE)
        yield from _names(order, "same_order", pointer, Kind.RESOURCE)
        for place, job in _items(order, "jobs", pointer):
            for k, name in enumerate(job if isinstance(job, (list, tuple)) else ()):
                if isinstance(name, str):
                    yield Mention(Kind.ACTION, name, (*place, k))


def _action(action: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    yield from _name(action, "id", at, Kind.ACTION, declares=True)
    yield from _uses(action, at)
    yield from _stock_and_state(action, at)
    for pointer, mode in _objects(action, "modes", at):
        yield from _uses(mode, pointer)
        yield from _stock_and_state(mode, pointer)


def _stock_and_state(holder: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    """The names that an action, or a mode, consumes, produces, needs and sets."""
    for key in ("consumes", "produces"):
        for pointer, stock in _objects(holder, key, at):
            yield from _name(stock, "resource", pointer, Kind.RESOURCE)
    for key in ("conditions", "effects"):
        for pointer, fact in _objects(holder, key, at):
            yield from _fact(fact, pointer)


def _uses(holder: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    for pointer, use in _objects(holder, "uses", at):
        yield from _name(use, "resource", pointer, Kind.RESOURCE)
        yield from _names(use, "one_of", pointer, Kind.RESOURCE)


def _variable(variable: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    yield from _name(variable, "id", at, Kind.VARIABLE, declares=True)
    owner = variable.get("id")
    if not isinstance(owner, str):
        return
    for pointer, value in _items(variable, "values", at):
        if isinstance(value, str):
            yield Mention(Kind.VALUE, value, pointer, True, owner)
    initial = variable.get("initial")
    if isinstance(initial, str):
        yield Mention(Kind.VALUE, initial, (*at, "initial"), owner=owner)


def _fact(fact: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    yield from _name(fact, "var", at, Kind.VARIABLE)
    owner, value = fact.get("var"), fact.get("value")
    if isinstance(owner, str) and isinstance(value, str):
        yield Mention(Kind.VALUE, value, (*at, "value"), owner=owner)


_ENDS = ("before", "after", "predecessor", "successor")


def _arc(arc: Any, at: Pointer) -> Iterator[Mention]:
    if isinstance(arc, Mapping):
        for key in _ENDS:
            yield from _name(arc, key, at, Kind.ACTION)
    elif isinstance(arc, (list, tuple)):
        for i, end in enumerate(arc[:2]):
            if isinstance(end, str):
                yield Mention(Kind.ACTION, end, (*at, i))


def _change(change: Mapping[str, Any], at: Pointer) -> Iterator[Mention]:
    """The mentions in a change of an event, except in the elements that it adds."""
    if change.get("op") == "cancel_actions":
        yield from _names(change, "actions", at, Kind.ACTION)
    if change.get("op") == "cancel_groups":
        yield from _names(change, "groups", at, Kind.GROUP)
    yield from _name(change, "action", at, Kind.ACTION)
    yield from _name(change, "group", at, Kind.GROUP)
    yield from _name(change, "resource", at, Kind.RESOURCE)
    yield from _fact(change, at)


def _items(holder: Mapping[str, Any], key: str, at: Pointer) -> Iterator[tuple[Pointer, Any]]:
    listed = holder.get(key)
    if isinstance(listed, (list, tuple)):
        for i, item in enumerate(listed):
            yield (*at, key, i), item


def _objects(
    holder: Mapping[str, Any], key: str, at: Pointer
) -> Iterator[tuple[Pointer, Mapping[str, Any]]]:
    for pointer, item in _items(holder, key, at):
        if isinstance(item, Mapping):
            yield pointer, item


def _name(
    holder: Mapping[str, Any], key: str, at: Pointer, kind: Kind, *, declares: bool = False
) -> Iterator[Mention]:
    name = holder.get(key)
    if isinstance(name, str):
        yield Mention(kind, name, (*at, key), declares)


def _names(holder: Mapping[str, Any], key: str, at: Pointer, kind: Kind) -> Iterator[Mention]:
    for pointer, item in _items(holder, key, at):
        if isinstance(item, str):
            yield Mention(kind, item, pointer)
