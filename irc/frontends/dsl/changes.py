"""Builds the typed changes of the IR from the statements in the body of an event."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from irc.diagnostics import Code
from irc.diagnostics.source import Pointer
from irc.frontends.dsl import nodes
from irc.frontends.dsl.build import Builder
from irc.frontends.dsl.document_parts import Element, Sink
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.nodes import Placed, kind, name, names, part, parts, span
from irc.model.quantities import level_of

ADDED = {
    "actions": "add_actions",
    "precedence": "add_precedence",
    "resources": "add_resources",
    "groups": "add_groups",
    "state": "add_state",
}
"""The operation for each array to which an added statement belongs."""

_NOTHING = {f"NO_{part.upper()}": part for part in ADDED}

_STATEMENTS: dict[str, Callable[[Builder, Any, Sink], None]] = {
    "action": Builder.action,
    "order": Builder.order,
    "resource": Builder.resource,
    "state": Builder.state,
    "group": Builder.group,
}


def change(builder: Builder, tree: Any, at: Pointer) -> Element:
    """The change of one statement; `at` is its pointer."""
    builder.mark_node(at, tree)
    builder.mark_node((*at, "op"), tree.children[0])
    return _CHANGES[str(tree.data)](builder, tree, at)


def added(builder: Builder, tree: Any, sink: Sink) -> None:
    """Reads a statement in the block of `add:`."""
    read = _STATEMENTS.get(str(tree.data))
    if read is None:
        raise Fault(
            Code.DSL_SYNTAX,
            "this cannot be added by an event",
            *span(tree),
            "an event can add actions, orders, resources, state variables and groups",
        )
    read(builder, tree, sink)


def addition(sink: Sink, start: int, end: int) -> Element:
    """The change of all statements of one `add`."""
    filled = [part for part, elements in sink.arrays.items() if elements]
    if len(filled) != 1:
        message = "nothing is added" if not filled else "one `add:` adds parts of one kind only"
        raise Fault(
            Code.DSL_SYNTAX, message, start, end, "write a separate `add:` for each kind of part"
        )
    return {"op": ADDED[filled[0]], filled[0]: sink.arrays[filled[0]]}


def removal(sink: Sink) -> Element:
    """The change of all orders of one `remove`."""
    return {"op": "remove_precedence", "precedence": sink.arrays.get("precedence", [])}


def _add(builder: Builder, tree: Any, at: Pointer) -> Element:
    what = tree.children[1]
    if kind(what) in _NOTHING:
        part_ = _NOTHING[kind(what)]
        return {"op": ADDED[part_], part_: []}
    sink = Sink({}, at)
    added(builder, what, sink)
    return addition(sink, *span(tree))


def _remove(builder: Builder, tree: Any, at: Pointer) -> Element:
    sink = Sink({}, at)
    if kind(tree.children[1]) == "order":
        builder.order(tree.children[1], sink, plain=True)
    return removal(sink)


def _cancel(builder: Builder, tree: Any, at: Pointer) -> Element:
    op = str(tree.data)
    field, node = op.removeprefix("cancel_"), part(tree, "names")
    listed = names(node)
    builder.mark_node((*at, field), node)
    for i, found in enumerate(listed):
        builder.mark((*at, field, i), found.start, found.end)
    return {"op": op, field: [found.value for found in listed]}


def _field(
    builder: Builder, element: Element, field: str, found: Placed, at: Pointer, key: Any = None
) -> None:
    builder.put_field(element, field, found, at, key)


def _duration(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "set_duration"}
    _field(builder, element, "action", name(part(tree, "name")), at)
    times = parts(part(tree, "length"), "INT", "TIME", "STRING")
    if len(times) == 1:
        found = nodes.time(times[0])
    else:
        found = builder.length_range(times[0], times[1], (*at, "duration"))
    _field(builder, element, "duration", found, at)
    return element


def _capacity(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "set_capacity"}
    _field(builder, element, "resource", name(part(tree, "name")), at)
    _field(builder, element, "capacity", nodes.integer(part(tree, "INT")), at)
    if (window := part(tree, "window")) is not None:
        builder.window(element, window, at)
    return element


def _release(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "set_release"}
    _field(builder, element, "action", name(part(tree, "name")), at)
    _field(builder, element, "release", nodes.time(part(tree, "INT", "TIME", "STRING")), at)
    return element


def _deadline(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "set_deadline"}
    said = part(tree, "time_or_none").children[0]
    if kind(said) == "WORD":
        if str(said) != "none":
            raise Fault(Code.DSL_SYNTAX, f"found `{said}`, expected a time or `none`", *span(said))
        found = Placed(None, *span(said))
    else:
        found = nodes.time(said)
    _field(builder, element, "deadline", found, at)
    owners = parts(tree, "name")
    fields = ["group"] if tree.data == "set_group_deadline" else ["action", "group"]
    for field, owner in zip(fields, owners, strict=False):
        _field(builder, element, field, name(owner), at)
    return element


def _goals(builder: Builder, tree: Any, at: Pointer) -> Element:
    return {"op": "set_goals", "goals": builder.goals(part(tree, "goals"), (*at, "goals"))}


def _state(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "set_state"}
    fact = part(tree, "fact")
    if (moment := part(fact, "AT_START", "AT_END", "THROUGHOUT")) is not None:
        raise Fault(
            Code.DSL_SYNTAX,
            f"found `{moment}`: the change is at the time of its event",
            *span(moment),
            "remove it",
        )
    if (test := part(fact, "test")) is not None:
        raise Fault(
            Code.DSL_SYNTAX,
            "a change of a number says its level",
            *span(test),
            "write it with `:=`, as in `set state fuel := 10`",
        )
    builder.fact(element, fact, at)
    if "add" in element:
        raise Fault(
            Code.DSL_SYNTAX,
            "an event sets a number; it does not add to it",
            *span(fact),
            "write the new level with `:=`, as in `set state fuel := 10`",
        )
    if "set" in element:
        element["value"] = _level(element.pop("set"), fact)
        builder.mark_node((*at, "value"), fact)
    return element


def _level(said: Any, fact: Any) -> Any:
    """The number that a level of a number variable is."""
    try:
        return level_of(said)
    except ValueError as error:
        raise Fault(Code.DSL_SYNTAX, str(error), *span(fact)) from None


def _objective(builder: Builder, tree: Any, at: Pointer) -> Element:
    return {"op": "set_objective", "objective": builder.aims(tree, (*at, "objective"))}


def _observe(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "observe"}
    _field(builder, element, "action", name(part(tree, "name")), at)
    for clause in tree.children[2:]:
        key, node = clause.children
        field, read = _OBSERVED[str(clause.data)]
        found = read(node)
        _field(builder, element, field, found, at, key)
        for i, taken in enumerate(names(node) if field == "resources" else ()):
            builder.mark((*at, field, i), taken.start, taken.end)
    return element


def _retry(builder: Builder, tree: Any, at: Pointer) -> Element:
    element: Element = {"op": "retry_action"}
    said = [child for child in tree.children[1:] if child is not None]
    _field(builder, element, "action", name(said[0]), at)
    for key, node in zip(said[1::2], said[2::2], strict=True):
        field = {"ARROW": "id", "ALREADY_DONE": "done", "MODE": "mode"}[kind(key)]
        found = nodes.time(node) if field == "done" else name(node)
        _field(builder, element, field, found, at, key)
    return element


def _status(tree: Any) -> Placed:
    """A status in words, `not begun`, as it is in the document."""
    found = name(tree)
    return Placed(found.value.replace(" ", "_"), found.start, found.end)


def _all_names(tree: Any) -> Placed:
    return Placed([found.value for found in names(tree)], *span(tree))


_OBSERVED: dict[str, tuple[str, Callable[[Any], Placed]]] = {
    "occurrence": ("occurrence", nodes.integer),
    "status": ("status", _status),
    "started": ("started", nodes.time),
    "finished": ("finished", nodes.time),
    "expected_end": ("expected_end", nodes.time),
    "mode_taken": ("mode", name),
    "resources_taken": ("resources", _all_names),
}
"""For each clause of an observation its field, and how that is read."""


_CHANGES: dict[str, Callable[[Builder, Any, Pointer], Element]] = {
    "add": _add,
    "remove": _remove,
    "cancel_actions": _cancel,
    "cancel_groups": _cancel,
    "set_duration": _duration,
    "set_capacity": _capacity,
    "set_release": _release,
    "set_deadline": _deadline,
    "set_group_deadline": _deadline,
    "set_goals": _goals,
    "set_state": _state,
    "set_objective": _objective,
    "retry": _retry,
    "observe": _observe,
}
