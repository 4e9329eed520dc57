"""Turns pydantic's errors about the shape of a document into plain messages."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from irc.diagnostics import Code, Diagnostic, Findings, did_you_mean
from irc.diagnostics.fix import Fix, renamed, replaced
from irc.diagnostics.source import Pointer
from irc.diagnostics.suggest import certain_keyword, closest
from irc.model import Task
from irc.model.lazy import Lazy, PartError, adapter
from irc.model.parts import PRECEDENCE_ALIASES
from irc.model.quantities import TimeError

_ALIASES = {new: old for old, new in (*PRECEDENCE_ALIASES.items(), ("dependencies", "precedence"))}
_CANONICAL = {old: new for new, old in _ALIASES.items()}
_QUOTED = re.compile(r"'([^']*)'")
_WHOLE = re.compile(r"-?(0|[1-9]\d{0,17})", re.ASCII)

_HINTS = {
    "needs either 'resource' or 'one_of'": "name one resource, or a choice of several, not both",
}

_EXPECTED = {
    "string_type": "expected text in double quotes",
    "string_too_short": "expected a text that is not empty",
    "string_unicode": "expected text without lone surrogates",
    "int_type": "expected a whole number",
    "int_parsing": "expected a whole number",
    "int_from_float": "expected a whole number",
    "bool_type": "expected true or false",
    "tuple_type": "expected a list [...]",
    "dict_type": "expected an object {...}",
    "model_type": "expected an object {...}",
    "model_attributes_type": "expected an object {...}",
    "too_short": "expected at least one entry",
    "datetime_parsing": "expected a date-time such as 2026-03-01T08:00:00Z",
    "datetime_from_date_parsing": "expected a date-time such as 2026-03-01T08:00:00Z",
    "datetime_type": "expected a date-time such as 2026-03-01T08:00:00Z",
    "union_tag_not_found": "expected an object with 'op'",
}


def faults_in_words(error: ValidationError, raw: Mapping[str, Any]) -> list[Diagnostic]:
    """Every fault of shape of the document `raw` as a finding."""
    reported = Findings()
    for fault in error.errors(include_url=False):
        _add(fault, raw, reported)
    misspelt = {
        (d.pointer[:-1], _field_close_to(str(d.pointer[-1]), _names_at(d.pointer[:-1], raw)))
        for d in reported.items
        if d.code is Code.UNKNOWN_FIELD
    }
    operations = [o for d in reported.items for o in d.fix]
    misspelt |= {(o.path[:-1], str(o.path[-1])) for o in operations if o.op == "move" and o.path}
    rewritten = {o.path for o in operations if o.op == "replace"}
    wrapped = any(o.op == "move" and not o.path for o in operations)
    return folded(
        d
        for d in reported.items
        if not _is_reported_as_misspelt(d, misspelt)
        and not any(d.pointer[:n] in rewritten for n in range(len(d.pointer)))
        and not (wrapped and d.code is Code.MISSING_FIELD and not d.pointer)
    )


def folded(found: Iterable[Diagnostic]) -> list[Diagnostic]:
    """The findings with one for each kind of unknown field, however many elements have it."""
    kinds: dict[object, list[Diagnostic]] = {}
    for k, d in enumerate(found):
        places = tuple("*" if isinstance(part, int) else part for part in d.pointer)
        foreign = d.code is Code.UNKNOWN_FIELD or (d.code is Code.WRONG_TYPE and d.fix)
        kinds.setdefault((d.code, places, d.fix == ()) if foreign else k, []).append(d)
    return [_one_of_many(alike) for alike in kinds.values()]


def _one_of_many(alike: list[Diagnostic]) -> Diagnostic:
    first, more = alike[0], len(alike) - 1
    if not more:
        return first
    shown = f" (likewise in {more:,} more place{'s' if more > 1 else ''})"
    telling = next((d for d in alike if d.hint and "…" not in d.hint), first)
    fix = tuple(operation for d in alike for operation in d.fix)
    return replace(first, message=first.message + shown, hint=telling.hint, fix=fix)


def _is_reported_as_misspelt(d: Diagnostic, misspelt: set[tuple[Pointer, str | None]]) -> bool:
    """Whether a field is missing only because its name is misspelt."""
    if d.code is not Code.MISSING_FIELD:
        return False
    return (d.pointer, _QUOTED.findall(d.message)[-1]) in misspelt


@lru_cache(maxsize=1024)
def _field_close_to(word: str, names: tuple[str, ...]) -> str | None:
    close = certain_keyword(word, names) or closest(word, names)
    return None if close is None else _CANONICAL.get(close, close)


def _add(fault: Any, raw: Mapping[str, Any], findings: Findings) -> None:
    kind, loc = fault["type"], tuple(fault["loc"])
    cause = (fault.get("ctx") or {}).get("error")
    if isinstance(cause, PartError):
        for inner in cause.faults:
            _add({**inner, "loc": (*loc, *inner["loc"])}, raw, findings)
        return
    if kind in ("missing", "extra_forbidden") and _adds_time(
        _pointer(loc[:-1], raw), raw, findings
    ):
        return
    if kind == "missing":
        parent = _pointer(loc[:-1], raw)
        findings.add(
            Code.MISSING_FIELD,
            f"{_element(parent, raw)} has no '{loc[-1]}'",
            parent,
            hint=f'add "{loc[-1]}": …',
        )
        return
    pointer = _pointer(loc, raw)
    if kind == "extra_forbidden":
        hint, fix = _instead_of(pointer, raw)
        findings.add(
            Code.UNKNOWN_FIELD,
            f"{_element(pointer[:-1], raw)} has no field {str(loc[-1])!r}",
            pointer,
            hint=hint,
            at_key=True,
            fix=fix,
        )
        return
    value = _value_at(pointer, raw)
    if kind == "too_short" and value:
        return  # Each of its entries has its own fault.
    if isinstance(cause, TimeError):
        findings.add(
            Code.BAD_TIME, f"{_where(pointer, raw)}: {cause}", pointer, hint=_time_hint(str(cause))
        )
    elif kind in ("literal_error", "union_tag_invalid"):
        _add_word(fault, pointer, raw, findings)
    else:
        message = _EXPECTED.get(kind) or str(cause or fault["msg"])
        found = "" if kind == "value_error" else f", found {_shown(value)}"
        meant, fix = _instead_of_value(kind, pointer, value, raw)
        advice = meant or _HINTS.get(message)
        if not fix and kind == "model_type" and pointer[:1] in (("precedence",), ("dependencies",)):
            advice = 'write {"before": …, "after": …}, or a pair of two names'
        findings.add(
            Code.WRONG_TYPE,
            f"{_where(pointer, raw)}: {message}{found}",
            pointer,
            hint=advice,
            fix=fix,
        )


def _adds_time(pointer: Pointer, raw: Any, findings: Findings) -> bool:
    """Whether an object in the place of a time is a number and its unit; reports it once."""
    from irc.model.foreign_shapes import kind_at, time_meant

    text = time_meant(_value_at(pointer, raw)) if kind_at(pointer) == "duration" else None
    if text is not None and not any(d.pointer == pointer for d in findings.items):
        message = (
            f"{_where(pointer, raw)}: expected a time, found an object with a number and a unit"
        )
        hint, fix = f'write "{text}"', replaced(pointer, text)
        findings.add(Code.WRONG_TYPE, message, pointer, hint=hint, fix=fix)
    return text is not None


def _instead_of(pointer: Pointer, raw: Any) -> tuple[str, Fix]:
    """(what to write instead of an unknown field, the certain repair)."""
    fix = _renaming(pointer, raw)
    if fix:
        return f"did you mean `{fix[0].path[-1]}`?", fix
    from irc.model.foreign_shapes import foreign_field

    meant = foreign_field(pointer, raw)
    if meant is not None:
        return meant
    guess = _field_close_to(str(pointer[-1]), _names_at(pointer[:-1], raw))
    if guess:
        return f"did you mean `{guess}`?", ()
    return _known_fields(_fields_at(pointer[:-1], raw)), ()


def _add_word(fault: Any, pointer: Pointer, raw: Any, findings: Findings) -> None:
    """Adds a fault of a value, or of the tag of an object, that must be one of a few words."""
    value = _value_at(pointer, raw)
    expected = fault["ctx"].get("expected") or fault["ctx"].get("expected_tags", "")
    if fault["type"] == "union_tag_invalid":
        tag = fault["ctx"]["discriminator"].strip("'")
        pointer, value = (*pointer, tag), value.get(tag)
    words = tuple(_QUOTED.findall(expected))
    sure = _word_meant(value, words) if isinstance(value, str) else None
    findings.add(
        Code.WRONG_TYPE,
        f"{_where(pointer, raw)}: expected {_listed(words) or expected}, found {_shown(value)}",
        pointer,
        hint=f"did you mean `{sure}`?" if sure else did_you_mean(str(value), words),
        fix=replaced(pointer, sure) if sure else (),
    )


def _word_meant(word: str, words: tuple[str, ...]) -> str | None:
    """The word of the IR that is certainly meant, also where another format has another one."""
    from irc.model.foreign_shapes import objective_meant, precedence_type_meant

    meant = objective_meant(word) or precedence_type_meant(word)
    return meant if meant in words else certain_keyword(word, words)


def _known_fields(known: Sequence[str]) -> str:
    return f"known fields are {', '.join(known)}; other data belongs in the task's `metadata`"


def _time_hint(message: str) -> str | None:
    if "1 h 30 min" in message:
        return None  # The message says what to write.
    if "'origin'" in message:
        return 'add "origin": "2026-03-01T08:00:00Z", or count from t = 0'
    if "date-time" in message:
        return "write a date-time such as 2026-03-01T08:00:00Z"
    return "write a number, or a text with units such as '1 h 30 min'"


def _listed(words: Sequence[str]) -> str:
    quoted = [repr(word) for word in words]
    return " or ".join(filter(None, (", ".join(quoted[:-1]), *quoted[-1:])))


def _renaming(pointer: Pointer, raw: Any) -> Fix:
    """The fix of an unknown field whose right name is certain, if that name is free."""
    *parents, name = pointer
    names = _names_at(tuple(parents), raw)
    meant = certain_keyword(str(name), names)
    siblings = _value_at(tuple(parents), raw)
    if meant is None or not isinstance(siblings, Mapping):
        return ()
    taken = {_CANONICAL.get(s, s) for s in siblings if s in names}
    others = (s for s in siblings if s not in names and s != name)
    if _CANONICAL.get(meant, meant) in taken or any(
        certain_keyword(str(other), names) == meant for other in others
    ):
        return ()
    return renamed(pointer, meant)


def _instead_of_value(kind: str, pointer: Pointer, value: Any, raw: Any) -> tuple[str | None, Fix]:
    """(what to write instead of a value of the wrong type, the certain repair)."""
    fix = _as_meant(kind, pointer, value)
    if fix:
        meant = fix[0].value
        text = f'"{meant}"' if isinstance(meant, str) else f"{_shown(meant)} without quotes"
        return f"write {text}", fix
    from irc.model.foreign_shapes import foreign_value

    meant = foreign_value(pointer, value, raw)
    return (None, ()) if meant is None else meant


def _as_meant(kind: str, pointer: Pointer, value: Any) -> Fix:
    """The fix of a number or truth value that was written as text."""
    if kind == "int_type" and isinstance(value, str) and _WHOLE.fullmatch(value):
        return replaced(pointer, int(value))
    if kind == "string_type" and type(value) is int:
        return replaced(pointer, str(value))
    if kind == "bool_type" and value in ("true", "false"):
        return replaced(pointer, value == "true")
    return ()


def _pointer(loc: Sequence[str | int], raw: Any) -> Pointer:
    """A pydantic location as a path that exists in the document: tags of unions are dropped."""
    path: list[str | int] = []
    for part in loc:
        if isinstance(raw, Mapping) and isinstance(part, str):
            part = part if part in raw else _ALIASES.get(part, part)
            if part in raw:
                path.append(part)
                raw = raw[part]
        elif isinstance(raw, (list, tuple)) and isinstance(part, int) and part < len(raw):
            path.append(part)
            raw = raw[part]
        elif isinstance(raw, (list, tuple)) and part in ("before", "after") and len(raw) == 2:
            index = ("before", "after").index(str(part))
            path.append(index)
            raw = raw[index]
    return tuple(path)


def _value_at(pointer: Pointer, raw: Any) -> Any:
    for part in pointer:
        raw = raw[part]
    return raw


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):
        return "an object"
    if isinstance(value, (list, tuple)):
        return "a list" if value else "an empty list"
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _where(pointer: Pointer, raw: Any) -> str:
    """A field by its name, an entry of a list by its number, a name of a pair by its meaning.

    With it the element that it is a field of, where that has an id or a number.
    """
    names = [part for part in pointer if isinstance(part, str)]
    if not names:
        return "the task"
    *parents, last = pointer
    if isinstance(last, str):
        owner = _owner(tuple(parents), raw)
        return f"'{last}' of {owner}" if owner else f"'{last}'"
    if parents and isinstance(parents[-1], int):
        return f"'{('before', 'after')[last]}' of {_kind(names[-1])} {parents[-1] + 1}"
    return f"{_kind(names[-1])} {last + 1}"


def _owner(pointer: Pointer, raw: Any) -> str | None:
    """The nearest element with an id that a path lies in, else the nearest entry of a list."""
    around = [pointer[:n] for n in range(len(pointer), 0, -1) if isinstance(pointer[n - 1], int)]
    for path in around:
        value = _value_at(path, raw)
        if isinstance(value, Mapping) and isinstance(value.get("id"), (str, int)):
            if value["id"] == "":
                return _element(path, raw)
            kind = _kind([part for part in path if isinstance(part, str)][-1])
            return f"{kind} {str(value['id'])!r}"
    return _element(around[0], raw) if around else None


def _kind(array: str) -> str:
    """The word for one entry of an array."""
    return {
        "uses": "use",
        "modes": "mode",
        "changes": "change",
        "dependencies": "precedence",
        "availability": "window",
        "one_of": "entry of 'one_of'",
    }.get(array, array.removesuffix("s"))


def _element(pointer: Pointer, raw: Any) -> str:
    """An element in words: "action 'boil'", "precedence 3", "the task"."""
    if not pointer:
        return "the task"
    value = _value_at(pointer, raw)
    names = [part for part in pointer if isinstance(part, str)]
    kind = _kind(names[-1])
    if isinstance(value, Mapping) and isinstance(value.get("id"), str) and value["id"]:
        return f"{kind} {value['id']!r}"
    last = pointer[-1]
    return f"{kind} {last + 1}" if isinstance(last, int) else f"'{last}'"


def _fields_at(pointer: Pointer, raw: Any) -> tuple[str, ...]:
    """The fields that the IR has at a path; those of its own `op` where it is a change."""
    path: list[str] = []
    for part in pointer:
        raw = raw[part]
        if isinstance(part, str):
            path.append(_CANONICAL.get(part, part))
        elif isinstance(raw, Mapping) and isinstance(raw.get("op"), str):
            path.append(f"{_OP}{raw['op']}")
    return _fields_of(tuple(path))


_OP = "op:"
"""The beginning of a step of a path that says which change it is."""


@lru_cache(maxsize=1024)
def _fields_of(path: tuple[str, ...]) -> tuple[str, ...]:
    """The fields at the end of a path of fields, and of changes by their `op`."""
    model: type[BaseModel] = Task
    for part in path:
        if part.startswith(_OP):
            model = _change_model(part.removeprefix(_OP)) or model
            continue
        field = model.model_fields.get(part)
        nested = None if field is None else _model_in((field.annotation, *field.metadata))
        if nested is None:
            return ()
        model = nested
    return tuple(field.alias or name for name, field in model.model_fields.items())


def _names_at(pointer: Pointer, raw: Any) -> tuple[str, ...]:
    """The fields at a path, and their other names."""
    fields = _fields_at(pointer, raw)
    return (*fields, *(alias for alias, field in _CANONICAL.items() if field in fields))


def _change_model(op: object) -> type[BaseModel] | None:
    from irc.model import Change

    kinds: tuple[type[BaseModel], ...] = get_args(get_args(Change)[0])
    return next((k for k in kinds if op in get_args(k.model_fields["op"].annotation)), None)


def _model_in(annotation: Any) -> type[BaseModel] | None:
    """The first model that a type mentions."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if isinstance(annotation, Lazy):
        return _model_in(adapter(annotation.module, annotation.name)._type)
    inner = annotation if isinstance(annotation, tuple) else get_args(annotation)
    return next(filter(None, map(_model_in, inner)), None)
