"""Reads benchmark files: JSON with one instance or a list of them, every fault located.

An importer asks a `Part` for the fields that it needs. A missing field or a wrong type becomes a
diagnostic with the instance and the field, and reading goes on, so that one run reports all.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report, did_you_mean
from irc.diagnostics.source import Pointer, Range, Source
from irc.frontends.json.document import decode_list_or_object
from irc.model.quantities import Span, TimeError
from irc.model.times import parse_span

_DIGITS = 100
"""Longer whole numbers are refused."""


@dataclass(frozen=True)
class Faults:
    """The faults of a file, in the order in which they are found."""

    source: Source
    findings: Findings = field(default_factory=Findings)

    def add(
        self, message: str, pointer: Pointer = (), *, hint: str | None = None, key: bool = False
    ) -> None:
        """Records one fault; `pointer` is its place in the file (`key`: the key itself)."""
        self.findings.add(Code.NOT_AN_IMPORT, message, pointer, hint=hint, at_key=key)

    def raise_any(self) -> None:
        """Raises `InputError` with all faults, if there are any."""
        if self.findings.items:
            raise InputError(Report(tuple(self.findings.items), self.source))


@dataclass(frozen=True)
class Part:
    """A value of another format's document, with its owner and its place."""

    value: Any
    pointer: Pointer
    owner: str
    """The name of the instance in messages."""
    faults: Faults

    def fault(self, message: str, *, hint: str | None = None, key: bool = False) -> None:
        """Records a fault of this value."""
        inner = ".".join(map(str, self._inside))
        where = f"{self.owner}, {inner}" if inner else self.owner
        self.faults.add(f"{where}: {message}", self.pointer, hint=hint, key=key)

    @property
    def _inside(self) -> Pointer:
        return (
            self.pointer[1:]
            if self.pointer and isinstance(self.pointer[0], int)
            else (self.pointer)
        )

    def child(self, key: str | int, value: Any) -> Part:
        """An element of this value."""
        return Part(value, (*self.pointer, key), self.owner, self.faults)

    def members(self) -> dict[str, Part]:
        """The fields of an object; otherwise none, and a fault."""
        if not isinstance(self.value, Mapping):
            self.fault(f"expected an object, found {_shown(self.value)}")
            return {}
        return {str(key): self.child(key, value) for key, value in self.value.items()}

    def items(self) -> list[Part]:
        """The entries of a list; otherwise none, and a fault."""
        if not isinstance(self.value, list):
            self.fault(f"expected a list, found {_shown(self.value)}")
            return []
        return [self.child(position, value) for position, value in enumerate(self.value)]

    def text(self) -> str | None:
        """A text that is not empty; otherwise None, and a fault."""
        if isinstance(self.value, str) and self.value:
            return self.value
        self.fault(f"expected a text, found {_shown(self.value)}")
        return None

    def whole(self, least: int = 0) -> int | None:
        """A whole number of at least `least`; otherwise None, and a fault."""
        value = self.value
        if isinstance(value, Decimal) and value == value.to_integral_value():
            value = int(value) if abs(value.adjusted()) < _DIGITS else value
        if type(value) is int and least <= value < 10**_DIGITS:
            return value
        self.fault(f"expected a whole number, {least} or more, found {_shown(self.value)}")
        return None

    def flag(self) -> bool:
        """True or false; otherwise false, and a fault."""
        if not isinstance(self.value, bool):
            self.fault(f"expected true or false, found {_shown(self.value)}")
        return self.value is True

    def time(self) -> Span | None:
        """A length of time, 0 or more; otherwise None, and a fault."""
        try:
            span = parse_span(self.value) if not isinstance(self.value, bool) else None
        except TimeError as error:
            self.fault(str(error))
            return None
        if span is None or not isinstance(self.value, (int, Decimal)):
            self.fault(f"expected a number, found {_shown(self.value)}")
        elif self.value < 0:
            self.fault(f"expected a time of 0 or more, found {self.value}")
        else:
            return span
        return None

    def one_of(self, known: Collection[str], what: str) -> str | None:
        """A text among `known`; otherwise None, and a fault with the nearest one."""
        text = self.text()
        if text is not None and text not in known:
            hint = did_you_mean(text, known) or f"known are {', '.join(known) or 'none'}"
            self.fault(f"there is no {what} {text!r}", hint=hint)
            return None
        return text

    def record(self, required: Collection[str], optional: Collection[str]) -> dict[str, Part]:
        """An object's fields, after faults for missing and unknown ones.

        A field that is null counts as absent.
        """
        members = self.members()
        if isinstance(self.value, Mapping):
            known = [*required, *optional]
            for key in members.keys() - set(known):
                hint = did_you_mean(key, known) or f"known fields are {', '.join(known)}"
                members[key].fault("this importer does not know the field", hint=hint, key=True)
            for key in required:
                if self.value.get(key) is None:
                    self.fault(f"the field '{key}' is missing")
        return {key: part for key, part in members.items() if part.value is not None}


def read_instances(text: str, name: str) -> tuple[list[Part], Faults]:
    """The instances of a file: its objects, each named by its id if it has one.

    Raises `InputError` if the file is not JSON, or neither an object nor a list of objects.
    """
    content, faults = read_json(text, name)
    if isinstance(content, Mapping):
        return [Part(content, (), _called(content, name), faults)], faults
    if not isinstance(content, list) or not content:
        faults.add(f"{name} holds neither an instance (an object) nor a list of them")
        faults.raise_any()
    instances = [
        Part(item, (i,), _called(item, f"{name}, instance {i + 1}"), faults)
        for i, item in enumerate(content)
    ]
    return instances, faults


def read_json(text: str, name: str, hint: str | None = None) -> tuple[Any, Faults]:
    """(the object or list that a file holds, where its faults are collected).

    Raises `InputError` with every fault of the text; `hint` says what the format expects.
    """
    faults = Faults(Source(name, text, _locate))
    return _decode(text, name, faults, hint), faults


def without_empty(document: Mapping[str, Any]) -> dict[str, Any]:
    """A task document without empty lists, except `actions`."""
    return {key: value for key, value in document.items() if value != [] or key == "actions"}


def _called(instance: Any, otherwise: str) -> str:
    name = instance.get("id") if isinstance(instance, Mapping) else None
    return repr(name) if isinstance(name, str) and name else otherwise


def _decode(text: str, name: str, faults: Faults, hint: str | None) -> Any:
    start = len(text) - len(text.lstrip("\ufeff \t\r\n"))
    if text[start : start + 1] not in ("{", "["):
        message = f"{name} holds neither an instance (an object) nor a list of them"
        faults.findings.add(Code.NOT_AN_IMPORT, message, offset=start, hint=hint)
        faults.raise_any()
    decoded = decode_list_or_object(text, start)
    if isinstance(decoded, list):
        for fault in decoded:
            message = f"{name} is not JSON: {fault.message}"
            faults.findings.add(
                Code.NOT_AN_IMPORT, message, hint=fault.hint or hint, offset=fault.offset
            )
        faults.raise_any()
    return decoded[0]


def _locate(text: str, wanted: frozenset[Pointer]) -> Mapping[Pointer, Range]:
    from irc.frontends.json.scan import scan

    return scan(text, len(text) - len(text.lstrip("\ufeff \t\r\n")), wanted).places


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):
        return "an object"
    if isinstance(value, list):
        return "a list"
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    text = ascii(value) if isinstance(value, str) else str(value)
    return text if len(text) <= 40 else text[:37] + "..."
