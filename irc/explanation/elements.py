"""The elements of a task that can be left out, in words, and the task without some of them.

Statements of `irc.problem.statements` are about time and resources. Elements are about everything
that a task can say: calendars, modes, stock, state, selections too. To leave one out is to change
the document, so that the rest is a task of its own, read and lowered like any other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from irc.diagnostics.source import Pointer
from irc.model import Task
from irc.model.canonical import written_task
from irc.model.times import Instant, format_number

_MUCH = 10**6
"""More units than a task that can be explained asks for."""

_GONE = object()


@dataclass(frozen=True)
class Element:
    """One thing that a task says.

    `replacement` takes its place when it is left out (None: nothing does). `of` is the action or
    resource that it belongs to. With `relaxes`, every schedule of the task is one of the task
    without it; what may also help (an effect, a delivery of stock) has no such guarantee.
    """

    kind: str
    pointer: Pointer
    text: str
    replacement: str | float | tuple[tuple[str, int | str], ...] | None = None
    of: str = ""
    relaxes: bool = True


ORDER = (
    *("use", "effect", "condition", "produces", "consumes", "duration", "precedence"),
    *("sequence", "coupling", "setups", "no_idle", "timed_change", "calendar", "window"),
    *("release", "earliest_end", "deadline", "latest_start", "start", "max_pause"),
    *("selection", "stock_min", "stock_max", "number_min", "number_max", "goal"),
    *("group_deadline", "task_deadline", "batch", "capacity"),
)
"""The order of leaving out: what an author sets once for all is kept longest."""


def elements_of(task: Task, document: Mapping[str, Any], longest: str) -> list[Element]:
    """The elements of a task in the order of leaving out.

    `document` is the task as written, and `longest` a time that is long enough for anything.
    """
    found = [*_of_task(task, document, longest)]
    return sorted(found, key=lambda element: (ORDER.index(element.kind), element.pointer))


def document_of(task: Task) -> dict[str, Any]:
    """The task as written, for `elements_of` and `without`."""
    return {**written_task(task), "objective": ["minimize_makespan"], "events": []}


def without(document: Mapping[str, Any], elements: Iterable[Element]) -> dict[str, Any]:
    """The document with elements left out."""
    changed: dict[str, Any] = _copied(document)
    for element in elements:
        *path, last = element.pointer
        owner: Any = changed
        for part in path:
            owner = owner[part]
        if isinstance(owner, dict) or element.replacement is not None:
            owner[last] = _replacement(element)
        else:
            owner[last] = _GONE
    kept: dict[str, Any] = _without_gone(changed)
    return kept


def _replacement(element: Element) -> Any:
    if element.replacement is None:
        return _GONE
    if isinstance(element.replacement, tuple):
        return dict(element.replacement)
    return element.replacement


def _copied(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _copied(inner) for key, inner in value.items()}
    return [_copied(inner) for inner in value] if isinstance(value, list) else value


def _without_gone(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_gone(inner) for key, inner in value.items() if inner is not _GONE}
    if isinstance(value, list):
        return [_without_gone(inner) for inner in value if inner is not _GONE]
    return value


# --- the elements, from the outside in ----------------------------------------------------------


def _of_task(task: Task, document: Mapping[str, Any], longest: str) -> Iterator[Element]:
    if task.deadline is not None:
        yield Element(
            "task_deadline", ("deadline",), f"everything ends by {_at(task, task.deadline)}"
        )
    ordered = _ordered(task)
    for k, resource in enumerate(document.get("resources", ())):
        yield from _of_resource(task, resource, ("resources", k), resource["id"] in ordered)
    for k, variable in enumerate(document.get("state", ())):
        yield from _of_variable(task, variable, ("state", k))
    for k, action in enumerate(document["actions"]):
        yield from _of_action(task, action, ("actions", k), longest)
    for k, edge in enumerate(document.get("precedence", ())):
        text = _precedence(edge)
        yield Element("precedence", ("precedence", k), text, of=_first(edge, "before"))
    for k, group in enumerate(document.get("groups", ())):
        if group.get("deadline") is not None:
            by = _at(task, task.groups[k].deadline)
            text = f"group {group['id']!r} ends by {by}"
            yield Element("group_deadline", ("groups", k, "deadline"), text)
    for k, goal in enumerate(document.get("goals", ())):
        yield Element("goal", ("goals", k), _goal(goal))
    for field, kind in (
        ("select", "selection"),
        ("couplings", "coupling"),
        ("sequences", "sequence"),
    ):
        for k, one in enumerate(document.get(field, ())):
            yield Element(kind, (field, k), _said(kind, one))


def _ordered(task: Task) -> frozenset[str]:
    """The resources with orders of uses, which cannot have another capacity than 1."""
    named: set[str] = set()
    for order in task.sequences:
        named.update(order.same_order or ())
        if order.resource is not None:
            named.add(order.resource)
        elif order.consecutive is not None:
            named.update(
                name
                for action in task.actions
                if action.id in order.consecutive
                for use in (*action.uses, *(u for mode in action.modes for u in mode.uses))
                for name in use.alternatives
            )
    return frozenset(named)


def _of_resource(
    task: Task, resource: Mapping[str, Any], at: Pointer, ordered: bool
) -> Iterator[Element]:
    name = repr(resource["id"])
    of = str(resource["id"])
    if resource.get("kind") == "reservoir":
        least, most = resource.get("min", 0), resource.get("max")
        initial = resource.get("initial", 0)
        text = f"the stock of {name} begins with {initial} and is never below {least}"
        yield Element("stock_min", (*at, "min"), text, -_MUCH, of)
        if most is not None:
            text = f"the stock of {name} is never above {most}"
            yield Element("stock_max", (*at, "max"), text, of=of)
        return
    special = [f for f in ("setups", "no_idle") if resource.get(f)]
    if resource.get("kind") == "batch":
        text = f"what is in {name} at once starts and ends together, and is of one family"
        yield Element("batch", (*at, "kind"), text, "renewable", of)
    if not special and not ordered:
        capacity = resource.get("capacity", 1)
        text = f"{name} has a capacity of {capacity}"
        yield Element("capacity", (*at, "capacity"), text, _MUCH, of)
    for field in special:
        words = {
            "setups": "needs set-ups between families",
            "no_idle": "is never idle between uses",
        }
        yield Element(field, (*at, field), f"{name} {words[field]}", of=of)
    yield from _of_windows(task, resource, at)
    if resource.get("calendar") is not None:
        text = f"{name} is open as in calendar {resource['calendar']!r}"
        yield Element("calendar", (*at, "calendar"), text, of=of)


def _of_windows(task: Task, resource: Mapping[str, Any], at: Pointer) -> Iterator[Element]:
    """The windows of a resource; without one it has its greatest capacity then."""
    windows = task.resources[int(at[1])].availability
    usual = max(resource.get("capacity", 1), *(w.capacity for w in windows), 0)
    for k, window in enumerate(resource.get("availability", ())):
        capacity = window["capacity"]
        span = f"from {_at(task, windows[k].from_)} to {_at(task, windows[k].to)}"
        text = f"{resource['id']!r} has a capacity of {capacity} {span}"
        instead = (("from", window["from"]), ("to", window["to"]), ("capacity", usual))
        if capacity < usual:
            yield Element("window", (*at, "availability", k), text, instead, of=str(resource["id"]))


def _of_variable(task: Task, variable: Mapping[str, Any], at: Pointer) -> Iterator[Element]:
    of = str(variable["id"])
    for field, words in (("min", "below"), ("max", "above")):
        if variable.get(field) is not None:
            initial = variable.get("initial", 0)
            text = f"{of!r} begins with {initial} and is never {words} {variable[field]}"
            yield Element(f"number_{field}", (*at, field), text, of=of)
    for k, change in enumerate(variable.get("changes", ())):
        when = _at(task, task.state[int(at[1])].changes[k].at)
        text = f"{variable['id']!r} becomes {change['value']!r} at {when}"
        yield Element(
            "timed_change", (*at, "changes", k), text, of=str(variable["id"]), relaxes=False
        )


_LIMITS = (
    ("release", "is released at"),
    ("deadline", "ends by"),
    ("latest_start", "starts by"),
    ("earliest_end", "ends no earlier than"),
    ("start", "starts at"),
)


def _of_action(
    task: Task, action: Mapping[str, Any], at: Pointer, longest: str
) -> Iterator[Element]:
    of = str(action["id"])
    for field, words in _LIMITS:
        if action.get(field) is not None:
            value = getattr(task.actions[int(at[1])], field)
            when = _when(task, value, action[field])
            yield Element(field, (*at, field), f"{of!r} {words} {when}", of=of)
    if action.get("calendar") is not None:
        text = f"{of!r} is done as in calendar {action['calendar']!r}"
        yield Element("calendar", (*at, "calendar"), text, of=of)
    if action.get("max_pause") is not None:
        text = f"{of!r} pauses for at most {action['max_pause']}"
        yield Element("max_pause", (*at, "max_pause"), text, of=of)
    yield from _of_part(task, action, at, of, repr(of), longest)
    for m, mode in enumerate(action.get("modes", ())):
        name = f"{of!r} in mode {mode['id']!r}"
        yield from _of_part(task, mode, (*at, "modes", m), of, name, longest)


def _of_part(
    task: Task, part: Mapping[str, Any], at: Pointer, of: str, name: str, longest: str
) -> Iterator[Element]:
    """The elements of an action or of one of its modes."""
    if part.get("duration") is not None:
        verb = "works for" if part.get("breaks") == "pause" else "takes"
        text = f"{name} {verb} {_length(task, part['duration'])}"
        instead = (("min", 0), ("max", longest))
        yield Element("duration", (*at, "duration"), text, instead, of)
    for k, use in enumerate(part.get("uses", ())):
        yield Element("use", (*at, "uses", k), f"{name} uses {_use(use)}", of=of)
    for field in ("consumes", "produces"):
        for k, change in enumerate(part.get(field, ())):
            text = f"{name} {field} {change.get('amount', 1)} of {change['resource']!r}"
            yield Element(field, (*at, field, k), text, of=of, relaxes=False)
    for k, condition in enumerate(part.get("conditions", ())):
        when = {"all": "throughout"}.get(condition["at"], f"at its {condition['at']}")
        text = f"{name} needs {_fact(condition)} {when}"
        yield Element("condition", (*at, "conditions", k), text, of=of)
    for k, effect in enumerate(part.get("effects", ())):
        text = f"{name} makes {_fact(effect)} at its {effect['at']}"
        yield Element("effect", (*at, "effects", k), text, of=of, relaxes=False)


# --- words --------------------------------------------------------------------------------------


def _at(task: Task, value: Instant | None) -> str:
    number = format_number(task.number(value)) if value is not None else "?"
    return f"{number} {task.time_unit}"


def _when(task: Task, value: Any, written: Any) -> str:
    """A point in time in the task's unit; a range of them as it is written."""
    if isinstance(written, Mapping):
        return " to ".join(str(written[k]) for k in ("min", "max") if k in written)
    return _at(task, value)


def _length(task: Task, written: Any) -> str:
    if isinstance(written, Mapping):
        return f"{written.get('min', 0)} to {_length(task, written.get('max', '?'))}"
    return f"{written} {task.time_unit}" if isinstance(written, (int, float)) else str(written)


def _use(use: Mapping[str, Any]) -> str:
    names: Sequence[str] = use.get("one_of") or [use["resource"]]
    amount = use.get("amount", 1)
    listed = repr(names[0]) if len(names) == 1 else f"one of {', '.join(map(repr, names))}"
    return listed if amount == 1 else f"{amount} of {listed}"


def _precedence(edge: Any) -> str:
    if not isinstance(edge, Mapping):
        return f"{edge[0]!r} precedes {edge[1]!r}"
    text = f"{edge['before']!r} precedes {edge['after']!r}"
    if edge.get("type", "finish-start") != "finish-start":
        text += f", {edge['type']}"
    for field, words in (("min_lag", "at least"), ("max_lag", "at most")):
        if edge.get(field) not in (None, 0 if field == "min_lag" else None):
            text += f", {words} {edge[field]} apart"
    return text


def _first(edge: Any, key: str) -> str:
    return str(edge[key] if isinstance(edge, Mapping) else edge[0])


def _fact(one: Mapping[str, Any]) -> str:
    for word in ("at_least", "at_most", "equals", "add", "set"):
        if word in one:
            return f"{one['var']!r} {word.replace('_', ' ')} {one[word]}"
    value = one.get("value", True)
    return f"{one['var']!r} = {str(value).lower() if isinstance(value, bool) else value}"


def _goal(goal: Any) -> str:
    if isinstance(goal, Mapping):
        return f"in the end {_fact(goal)}" if "var" in goal else f"{goal} is wanted"
    return f"{goal!r} is present"


def _said(kind: str, one: Mapping[str, Any]) -> str:
    """A selection, coupling or sequence as its fields say it."""
    if "consecutive" in one:
        first, second = one["consecutive"]
        where = f" of {one['resource']!r}" if "resource" in one else ""
        return f"{second!r} is the next use{where} after {first!r}"
    if "same_order" in one:
        return f"jobs have one order on {' and '.join(map(repr, one['same_order']))}"
    if one.get("all_or_none"):
        where = f", where {one['if']!r} is" if "if" in one else ""
        return f"all or none of {_listed(one['actions'])} are present{where}"
    parts = [f"{key} {_listed(value)}" for key, value in one.items()]
    return f"the {kind} of {', '.join(parts)}"


def _listed(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(repr(item) for item in value)
    return repr(value) if isinstance(value, str) else str(value)
