"""The elements of an XML document with their places, and the faults that are found in them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import datetime
from decimal import Decimal, InvalidOperation
from functools import cached_property
from importlib.util import find_spec
from typing import Any

from irc.diagnostics import Code, Diagnostic, Findings, InputError, Report
from irc.diagnostics.source import Source
from irc.targets import EngineMissing

NAMESPACE = "http://schemas.microsoft.com/project"
_DEEPEST = 50
"""Elements that are nested deeper than this are refused; a project has about ten levels."""

_DURATION = re.compile(
    r"P(?:(\d{1,9})D)?(?:T(?:(\d{1,9})H)?(?:(\d{1,9})M)?(?:(\d{1,9}(?:\.\d{1,9})?)S)?)?\Z", re.ASCII
)


@dataclass
class Faults:
    """The faults of a document, and warnings where it is read differently from what it says."""

    source: Source
    findings: Findings = field(default_factory=Findings)
    _said: set[tuple[int, str]] = field(default_factory=set, repr=False)

    def add(self, element: Element, message: str, hint: str | None = None) -> None:
        """Records a fault at an element."""
        self._add(Code.NOT_AN_IMPORT, element, message, hint)

    def warn(self, element: Element, message: str, hint: str | None = None) -> None:
        """Records that an element is read differently from what it says."""
        self._add(Code.LENIENT, element, message, hint)

    def _add(self, code: Code, element: Element, message: str, hint: str | None) -> None:
        """Records a finding, once: an element may be asked for its contents more than once."""
        if (element.place, message) not in self._said:
            self._said.add((element.place, message))
            offset = self._offset(element.place)
            self.findings.items.append(Diagnostic(code, message, offset=offset, hint=hint))

    def _offset(self, place: int) -> int:
        """The offset in characters of an offset in bytes."""
        return place if self._bytes is None else len(self._bytes[:place].decode(errors="replace"))

    @cached_property
    def _bytes(self) -> bytes | None:
        """The text in bytes; None where each character is one byte."""
        return None if self.source.text.isascii() else self.source.text.encode()

    def report(self) -> Report:
        """All that was found."""
        return Report(tuple(self.findings.items), self.source)

    def raise_any(self) -> None:
        """Raises `InputError` with all faults, if there are any."""
        if self.findings.has_errors:
            raise InputError(self.report())


@dataclass
class Element:
    """An element: its name without the namespace, its text, its children, its place in bytes."""

    name: str
    place: int
    faults: Faults = field(repr=False)
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def child(self, name: str) -> Element | None:
        """The first child of a name."""
        return next((one for one in self.children if one.name == name), None)

    def all(self, *path: str) -> Iterator[Element]:
        """The descendants on a path of names."""
        for one in self.children:
            if one.name == path[0]:
                if len(path) == 1:
                    yield one
                else:
                    yield from one.all(*path[1:])

    def at(self, name: str) -> Element:
        """The child of a name, or this element where there is none: the place of a fault."""
        return self.child(name) or self

    def said(self, name: str) -> str:
        """The text of a child; empty where there is none."""
        one = self.child(name)
        return "" if one is None else one.text.strip()

    def extended(self, field: int) -> str:
        """The value of an extended attribute by the number of its field; empty without one."""
        for one in self.all("ExtendedAttribute"):
            if one.said("FieldID") == str(field):
                return one.said("Value")
        return ""

    def flag(self, name: str, otherwise: bool = False) -> bool:
        """Whether a child says yes."""
        said = self.said(name).lower()
        if said in ("", "0", "1", "false", "true"):
            return otherwise if not said else said in ("1", "true")
        self.faults.add(self.at(name), f"{name}: expected 0 or 1, found {said[:40]!r}")
        return otherwise

    def whole(self, name: str, otherwise: int = 0) -> int:
        """The whole number of a child."""
        said = self.said(name)
        if not said:
            return otherwise
        if re.fullmatch(r"[+-]?\d{1,18}(\.0+)?", said, re.ASCII):
            return int(said.partition(".")[0])
        self.faults.add(self.at(name), f"{name}: expected a whole number, found {said[:40]!r}")
        return otherwise

    def number(self, name: str, otherwise: Decimal) -> Decimal:
        """The number of a child, 0 or more and at most 10⁹, exactly."""
        said = self.said(name)
        if not said:
            return otherwise
        try:
            found = Decimal(said)
        except InvalidOperation:
            found = Decimal(-1)
        if found.is_finite() and 0 <= found <= 10**9:
            return round(found, 6)
        self.faults.add(self.at(name), f"{name}: expected a number from 0, found {said[:40]!r}")
        return otherwise

    def date(self, name: str) -> datetime | None:
        """The date-time of a child, without a zone; None where there is none ("NA")."""
        said = self.said(name)
        if said in ("", "NA"):
            return None
        try:
            found = datetime.fromisoformat(said)
        except ValueError:
            found = None
        if found is None or found.tzinfo is not None:
            message = f"{name}: expected a date-time without a zone, such as 2026-03-02T08:00:00"
            self.faults.add(self.at(name), f"{message}, found {said[:40]!r}")
            return None
        return found

    def seconds(self, name: str) -> Decimal | None:
        """The length of time of a child (`PT8H30M0S`) in seconds; None where there is none."""
        said = self.said(name)
        if not said:
            return None
        match = _DURATION.match(said)
        if match is None or said in ("P", "PT"):
            message = f"{name}: expected a duration such as PT8H30M0S, found {said[:40]!r}"
            self.faults.add(self.at(name), message)
            return None
        days, hours, minutes, seconds = (Decimal(part or 0) for part in match.groups())
        return ((days * 24 + hours) * 60 + minutes) * 60 + seconds


def parse_project(text: str, name: str) -> Element:
    """The element `Project` of a document, each element with its place.

    Raises `InputError` for what is no XML, has a document type (and so perhaps entities that
    expand without end) or is no project, and `EngineMissing` without defusedxml
    (`pip install 'irc-compiler[files]'`).
    """
    if find_spec("defusedxml") is None:
        raise EngineMissing("MS Project XML needs defusedxml: pip install 'irc-compiler[files]'")
    from xml.etree.ElementTree import ParseError

    from defusedxml import DefusedXmlException, DTDForbidden
    from defusedxml.ElementTree import DefusedXMLParser

    text = text.removeprefix("\ufeff")
    faults = Faults(Source(name, text))
    builder = _Builder(faults)
    parser = DefusedXMLParser(target=builder, forbid_dtd=True)
    builder.expat = parser.parser
    try:
        parser.feed(text)
        parser.close()
    except ParseError as error:
        line, column = error.position
        offset = sum(len(one) for one in text.splitlines(keepends=True)[: line - 1]) + column
        faults.findings.add(
            Code.NOT_AN_IMPORT, f"this is not XML: {error}", offset=min(offset, len(text))
        )
    except (DTDForbidden, DefusedXmlException):
        message = "the file declares a document type or entities, which no project needs"
        faults.findings.add(Code.NOT_AN_IMPORT, message, offset=max(text.find("<!"), 0))
    except _TooDeep:
        message = f"elements are nested more than {_DEEPEST} deep"
        faults.findings.add(Code.NOT_AN_IMPORT, message, offset=0)
    faults.raise_any()
    root = builder.root
    if root is None or root.name != "Project":
        found = "nothing" if root is None else f"<{root.name}>"
        place = root or Element("", 0, faults)
        hint = "save the project in MS Project as 'XML format (*.xml)'"
        faults.add(place, f"expected <Project xmlns={NAMESPACE!r}>, found {found}", hint)
        faults.raise_any()
    assert root is not None
    return root


class _TooDeep(Exception):
    """Elements are nested too deeply."""


class _Builder:
    """Makes the elements from what a parser finds; elements of other namespaces keep theirs."""

    def __init__(self, faults: Faults) -> None:
        self.faults = faults
        self.root: Element | None = None
        self.expat: Any = None
        self._open: list[Element] = []

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """An element begins."""
        if len(self._open) >= _DEEPEST:
            raise _TooDeep
        name = tag.removeprefix(f"{{{NAMESPACE}}}")
        element = Element(name, self.expat.CurrentByteIndex, self.faults)
        if self._open:
            self._open[-1].children.append(element)
        elif self.root is None:
            self.root = element
        self._open.append(element)

    def end(self, tag: str) -> None:
        """An element ends."""
        self._open.pop()

    def data(self, text: str) -> None:
        """A part of the text of an element."""
        if self._open:
            self._open[-1].text += text

    def close(self) -> Element | None:
        """The document ends."""
        return self.root
