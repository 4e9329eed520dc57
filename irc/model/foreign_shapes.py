"""Shapes of other formats in the place of the IR's: what to write instead, and certain repairs.

People and language models write `tasks`, `depends_on`, `machines` or `"uses": ["oven"]`. Each
function looks at one fault of shape. A `Fix` is given only where it is certain what was meant.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from irc.diagnostics.fix import Fix, added, moved, removed, renamed, replaced
from irc.diagnostics.source import Pointer
from irc.diagnostics.suggest import normal_form
from irc.model.foreign_words import (
    ADVICE,
    ANY_OF_THESE,
    OBJECTIVES,
    PRECEDENCE_TYPES,
    PREDECESSORS,
    SUCCESSORS,
    TIME_WORDS,
    field_meant,
)

_KINDS = {
    "actions": "action",
    "resources": "resource",
    "uses": "use",
    "modes": "mode",
    "precedence": "precedence",
    "dependencies": "precedence",
    "groups": "group",
    "state": "state",
    "conditions": "condition",
    "effects": "effect",
    "goals": "goal",
    "availability": "window",
    "duration": "duration",
    "events": "event",
}
_NAMES = frozenset(("name", "title", "task", "step", "activity", "action", "displayname"))
_ARROW = re.compile(r"\s*(?:->|=>|→|<|\bbefore\b|\bprecedes\b)\s*")
_ASIDE = frozenset(
    ("reasoning", "explanation", "notes", "thoughts", "analysis", "comment", "irc", "version")
)
"""Words beside a wrapped task that say nothing about it."""


class Meant(NamedTuple):
    """How to write a foreign field or value; `fix` is empty where that is not certain."""

    hint: str
    fix: Fix = ()


def kind_at(pointer: Pointer) -> str:
    """The kind of the element at a path; empty where it has none."""
    if not pointer:
        return "task"
    names = [part for part in pointer if isinstance(part, str)]
    in_change = "changes" in pointer and names[-1] == "changes"
    return "" if in_change else _KINDS.get(names[-1], "")


def foreign_field(pointer: Pointer, raw: Any) -> Meant | None:
    """The meaning of an unknown field that other formats have; None if nothing is known of it."""
    *parents, name = pointer
    element, word = _value_at(tuple(parents), raw), normal_form(str(name))
    kind = kind_at(tuple(parents))
    if not isinstance(element, Mapping):
        return None
    value = element[name]
    if kind == "task" and _is_task(value) and "actions" not in element:
        return _wrapped(pointer, element)
    if kind == "action" and len(pointer) == _OWN:
        own = _of_action(pointer, word, value, raw)
        if own is not None:
            return own
    field = _field(kind, str(name), element)
    if field is None:
        advice = ADVICE.get(kind, {}).get(word)
        return None if advice is None else Meant(advice)
    return _as_field(pointer, field, kind, element)


_OWN = 3
"""The length of a path to a field of an action of the task."""


def _field(kind: str, name: str, element: Mapping[str, Any]) -> str | None:
    if kind in ("action", "resource") and normal_form(name) in _NAMES and "id" in element:
        return "label"
    return field_meant(kind, name)


def _is_task(value: Any) -> bool:
    return isinstance(value, Mapping) and any(
        name == "actions" or field_meant("task", str(name)) == "actions" for name in value
    )


def _wrapped(pointer: Pointer, element: Mapping[str, Any]) -> Meant:
    hint = f'the task is inside "{pointer[-1]}": write what is in it at the top'
    alone = all(normal_form(str(k)) in _ASIDE for k in element if k != pointer[-1])
    return Meant(hint, moved(pointer, ()) if alone else ())


def _of_action(pointer: Pointer, word: str, value: Any, raw: Any) -> Meant | None:
    """The meaning of an action's field that belongs elsewhere, or has a unit in its name."""
    if word in PREDECESSORS or word in SUCCESSORS:
        return _order(pointer, word in SUCCESSORS, value, raw)
    action = _value_at(pointer[:-1], raw)
    if word == "action" and "item" in action:
        return Meant(ADVICE["action"]["item"])
    if word == "optional" and isinstance(value, bool) and "occurs" not in action:
        hint = 'an action that may be left out has "occurs": "optional"'
        fix = (*replaced(pointer, "optional"), *renamed(pointer, "occurs"))
        return Meant(hint, fix if value else removed(pointer))
    for beginning in ("duration", "time", "length", "dur"):
        unit = TIME_WORDS.get(word.removeprefix(beginning).removeprefix("in"))
        if word.startswith(beginning) and unit and _is_number(value):
            text = f"{value} {unit}"
            fix = (*replaced(pointer, text), *renamed(pointer, "duration"))
            return Meant(f'write "duration": "{text}"', () if "duration" in action else fix)
    return None


def _order(pointer: Pointer, follows: bool, value: Any, raw: Any) -> Meant:
    """The precedences that a list of predecessors, or of successors, means."""
    name = _value_at(pointer[:-1], raw).get("id", _value_at(pointer[:-1], raw).get("name"))
    others = [value] if isinstance(value, (str, int)) else value
    array = "dependencies" if "dependencies" in raw else "precedence"
    name = str(name) if isinstance(name, (str, int)) else "…"
    if not isinstance(others, list) or not all(type(o) in (str, int) for o in others):
        pair = json.dumps([name, "…"] if follows else ["…", name], ensure_ascii=False)
        return Meant(f'the order is a list of the task: "{array}": [{pair}]')
    pairs = [[name, str(o)] if follows else [str(o), name] for o in others]
    shown = ", ".join(json.dumps(pair, ensure_ascii=False) for pair in pairs[:3] or [["…", name]])
    hint = f'the order is a list of the task: "{array}": [{shown}{", …" if pairs[3:] else ""}]'
    if name == "…" or not isinstance(raw.get(array, []), list):
        return Meant(hint)
    return Meant(hint, (*removed(pointer), *(added((array,), pair, pointer) for pair in pairs)))


def _as_field(pointer: Pointer, field: str, kind: str, element: Mapping[str, Any]) -> Meant:
    """A foreign field as the field that it means, with its value as the IR writes it."""
    name = str(pointer[-1])
    value = element[name]
    rivals = [k for k in element if k == field or _field(kind, str(k), element) == field]
    if rivals[0] != name or field in element:
        return Meant(f"`{field}` means the same; keep one of the two")
    written = _as_value(field, kind, str(name), value)
    if written is None:
        return Meant(_how_to_write(field, kind, value))
    if written == value and type(written) is type(value):
        return Meant(f"did you mean `{field}`?", renamed(pointer, field))
    shown = json.dumps(written, ensure_ascii=False, default=str)
    hint = f'write "{field}": {shown if len(shown) <= _LONGEST_SHOWN else shown[:40] + " …"}'
    return Meant(hint, (*replaced(pointer, written), *renamed(pointer, field)))


_LONGEST_SHOWN = 120


def _how_to_write(field: str, kind: str, value: Any) -> str:
    if field == "uses":
        if isinstance(value, list) and len(value) > 1:
            return (
                'write "uses": [{"one_of": ["a", "b"]}] for any one of them, or one '
                '{"resource": "a"} for each of them'
            )
        return 'write "uses": [{"resource": "…"}]'
    examples = {
        "actions": '[{"id": "…", "duration": 5}]',
        "resources": '[{"id": "…", "capacity": 1}]',
        "precedence": '[["…", "…"]], the earlier action first',
    }
    return f'write "{field}": {examples.get(field, "…")}'


def _as_value(field: str, kind: str, word: str, value: Any) -> Any:
    """A value as the IR writes it for a field; None where its meaning is not certain."""
    if field == "uses":
        several = isinstance(value, list) and len(value) > 1
        if several and normal_form(word).startswith(_ANY_OF):
            return [{"one_of": value}] if all(isinstance(v, str) for v in value) else None
        return None if several and normal_form(word) in ANY_OF_THESE else uses_meant(value)
    if kind == "task" and field == "resources":
        return elements_meant(value, "capacity")
    if kind == "task" and field == "actions":
        return elements_meant(value, "duration")
    if kind == "task" and field == "precedence":
        return value if isinstance(value, list) else None
    if field in ("id", "name", "label", "description", "time_unit", "before", "after", "resource"):
        return value if isinstance(value, str) else str(value) if type(value) is int else None
    if field in ("capacity", "amount"):
        return value if type(value) is int else None
    if field == "objective":
        words = [value] if isinstance(value, str) else value
        listed = [objective_meant(w) for w in words] if isinstance(words, list) else [None]
        return None if None in listed else listed
    if field == "type":
        return precedence_type_meant(value)
    return value


_ANY_OF = ("eligible", "possible")
"""Beginnings of words for several resources of which any one is held."""


def uses_meant(value: Any) -> list[Any] | None:
    """The uses that a name, a list of names, or a mapping of names to amounts means."""
    if isinstance(value, str):
        return [{"resource": value}]
    if isinstance(value, Mapping):
        if {"resource", "one_of", "name", "id"} & value.keys():
            return [dict(value)]
        if value and all(type(amount) is int for amount in value.values()):
            return [{"resource": name, "amount": amount} for name, amount in value.items()]
        return None
    if isinstance(value, list) and all(isinstance(v, (str, Mapping)) for v in value):
        return [{"resource": v} if isinstance(v, str) else v for v in value]
    return None


def elements_meant(value: Any, field: str) -> list[Any] | None:
    """The elements that a list of names and objects, or a mapping by name, means.

    In a mapping of names to numbers the numbers are the elements' `field`.
    """
    if isinstance(value, list):
        if all(isinstance(v, Mapping) for v in value):
            return value
        if field == "capacity" and all(isinstance(v, (str, Mapping)) for v in value):
            return [{"id": v} if isinstance(v, str) else v for v in value]
        return None
    if not isinstance(value, Mapping) or not value:
        return None
    if all(isinstance(v, Mapping) and "id" not in v for v in value.values()):
        return [{"id": name, **inner} for name, inner in value.items()]
    plain = (int, str) if field == "duration" else (int,)
    if all(isinstance(v, plain) and not isinstance(v, bool) for v in value.values()):
        return [{"id": name, field: inner} for name, inner in value.items()]
    return None


def foreign_value(pointer: Pointer, value: Any, raw: Any) -> Meant | None:
    """The meaning of a value of the wrong type that other formats have; None if not known."""
    names = [part for part in pointer if isinstance(part, str)]
    last = names[-1] if names else ""
    if pointer and isinstance(pointer[-1], int):
        return _entry_meant(pointer, last, value)
    if last == "uses":
        return _written(pointer, uses_meant(value))
    if pointer in (("precedence",), ("dependencies",)):
        return Meant('write a list of pairs, the earlier action first: [["…", "…"]]')
    if pointer in (("resources",), ("actions",)):
        field = "capacity" if last == "resources" else "duration"
        return _written(pointer, elements_meant(value, field))
    return None


def _entry_meant(pointer: Pointer, array: str, value: Any) -> Meant | None:
    if array == "uses" and isinstance(value, str):
        return _written(pointer, {"resource": value})
    if array == "resources" and isinstance(value, str) and len(pointer) == _ENTRY:
        return _written(pointer, {"id": value})
    if array in ("precedence", "dependencies"):
        ends = _ARROW.split(value.strip()) if isinstance(value, str) else []
        return _written(pointer, ends) if len(ends) == 2 and all(ends) else None
    return None


_ENTRY = 2
"""The length of a path to an entry of an array of the task."""


def _written(pointer: Pointer, meant: Any) -> Meant | None:
    if meant is None:
        return None
    shown = json.dumps(meant, ensure_ascii=False, default=str)
    shown = shown if len(shown) <= _LONGEST_SHOWN else shown[:40] + " …"
    return Meant(f"write {shown}", replaced(pointer, meant))


def time_meant(value: Any) -> str | None:
    """The time that an object with a number and a unit means."""
    if not isinstance(value, Mapping) or len(value) != 2:
        return None
    unit = next((value[k] for k in ("unit", "units", "time_unit") if k in value), None)
    number = next((value[k] for k in ("value", "amount", "duration", "time") if k in value), None)
    return f"{number} {unit}" if isinstance(unit, str) and _is_number(number) else None


def objective_meant(word: Any) -> str | None:
    """The objective that a word means."""
    return OBJECTIVES.get(normal_form(word)) if isinstance(word, str) else None


def precedence_type_meant(word: Any) -> str | None:
    """The type of a precedence that a word means."""
    return PRECEDENCE_TYPES.get(normal_form(word)) if isinstance(word, str) else None


def _is_number(value: Any) -> bool:
    from decimal import Decimal

    return isinstance(value, (int, float, Decimal)) and not isinstance(value, bool)


def _value_at(pointer: Pointer, raw: Any) -> Any:
    for part in pointer:
        raw = raw[part]
    return raw
