"""A JSON scanner that finds the places of elements and the faults of the text.

`json.loads` is fast but forgets positions and stops at its first error with a short message. This
scanner runs only for diagnostics: it finds the places of wanted elements, and describes syntax
errors for people and for language models that repair their answer. It is iterative, so nesting
cannot exhaust the stack. Past a notation of another language (comments, single quotes, trailing
commas, Python's True) it reads on, and says which edit of the text makes it JSON.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from dataclasses import dataclass, field

from irc.diagnostics import Code
from irc.diagnostics.fix import TextEdit
from irc.diagnostics.source import Pointer, Range
from irc.frontends.json import notations

MAX_FAULTS = 1000
"""Limit on faults of a text; the rest of it is not read."""

_LONGEST_NUMBER = 1000
_LONGEST_EXPONENT = 6

_SPACE = re.compile(r"[ \t\n\r]*")
# Possessive, so that a string without an end is not tried again at each character.
_STRING = re.compile(r'"((?:[^"\\\x00-\x1f]++|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*+)"')
_STRING_BODY = re.compile(r'"(?:[^"\\\x00-\x1f]++|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*+')
_NUMBER = re.compile(r"-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?(\d+))?", re.ASCII)
_WORD = re.compile(r"[A-Za-z_][\w-]*")
_NOT_FINITE = frozenset(("NaN", "Infinity", "-Infinity", "nan", "inf", "infinity"))


@dataclass(frozen=True, slots=True)
class JsonFault:
    """A fault of the text itself."""

    code: Code
    offset: int
    message: str
    hint: str | None = None
    edits: tuple[TextEdit, ...] = ()
    """The edits that certainly make the text what was meant, where they are known."""


@dataclass
class Scan:
    """The result of a scan: the places of the wanted elements, and all faults."""

    places: dict[Pointer, Range] = field(default_factory=dict)
    faults: list[JsonFault] = field(default_factory=list)
    end: int = 0


class _Stop(Exception):
    """Ends a scan after a fault it cannot read past."""


@dataclass
class _Open:
    """An object or array that is not closed yet."""

    kind: str
    start: int
    key_start: int | None
    keys: set[str] = field(default_factory=set)
    count: int = 0


class _Scanner:
    def __init__(self, text: str, wanted: Collection[Pointer], max_depth: int) -> None:
        self.max_depth = max_depth
        self.text = text
        self.wanted = wanted
        self.scan = Scan()
        self.path: list[str | int] = []
        self.open: list[_Open] = []

    def run(self, start: int) -> Scan:
        try:
            self.scan.end = self._document(start)
        except _Stop:
            self.scan.end = len(self.text)
        return self.scan

    def _fault(
        self, code: Code, offset: int, message: str, hint: str | None = None, *edits: TextEdit
    ) -> None:
        if len(self.scan.faults) >= MAX_FAULTS:
            message = (
                f"the {MAX_FAULTS} faults above are the limit: the rest of the text is not read"
            )
            self.scan.faults.append(JsonFault(Code.TOO_LARGE, offset, message))
            raise _Stop
        self.scan.faults.append(JsonFault(code, offset, message, hint, edits))

    def _mend(self, offset: int, message: str, hint: str | None, *edits: TextEdit) -> None:
        """Records a fault of syntax that the edits mend; reading goes on behind it."""
        self._fault(Code.SYNTAX, offset, message, hint, *edits)

    def _stop(self, offset: int, message: str, hint: str | None = None) -> _Stop:
        self._fault(Code.SYNTAX, offset, message, hint)
        return _Stop()

    def _skip(self, at: int) -> int:
        match = _SPACE.match(self.text, at)
        at = match.end() if match else at
        while self.open and (comment := notations.comment_at(self.text, at)) is not None:
            shown = self.text[at : at + 12].split("\n")[0]
            message = f"a comment, {shown!r}, stands where JSON has none"
            self._mend(at, message, "JSON has no comments: remove it", TextEdit(at, comment, ""))
            match = _SPACE.match(self.text, comment)
            at = match.end() if match else comment
        return at

    def _place(self, start: int, end: int, key_start: int | None) -> None:
        pointer = tuple(self.path)
        if pointer in self.wanted:
            self.scan.places.setdefault(pointer, Range(start, end, key_start))

    def _document(self, at: int) -> int:
        at = self._value(self._skip(at), None)
        while self.open:
            at = self._element(at)
        return at

    def _element(self, at: int) -> int:
        """Reads one element of the innermost open object or array, or its end."""
        inner, at = self.open[-1], self._skip(at)
        closing = _CLOSING[inner.kind]
        if self.text.startswith(closing, at):
            return self._close(at + 1)
        if inner.count:
            at = self._comma(at, inner, closing)
            if self.text.startswith(closing, at):
                return self._close(at + 1)
        inner.count += 1
        if inner.kind != "{":
            self.path.append(inner.count - 1)
            return self._value(at, None)
        return self._member(at, inner)

    def _close(self, end: int) -> int:
        inner = self.open.pop()
        if inner.kind == "(":
            edits = TextEdit(inner.start, inner.start + 1, "["), TextEdit(end - 1, end, "]")
            message = "a list in parentheses"
            self._mend(inner.start, message, "JSON writes lists as [ … ]", *edits)
        self._place(inner.start, end, inner.key_start)
        if self.path:
            self.path.pop()
        return end

    def _comma(self, at: int, inner: _Open, closing: str) -> int:
        if not self.text.startswith(",", at):
            return self._missing_comma(at, inner, closing)
        after = self._skip(at + 1)
        while self.text.startswith(",", after):
            message, hint = f"expected a value, found {self._shown(after)!r}", "remove this comma"
            self._mend(after, message, hint, TextEdit(after, after + 1, ""))
            after = self._skip(after + 1)
        if self.text.startswith(closing, after):
            message = f"a comma before '{closing}'"
            self._mend(at, message, "remove this comma", TextEdit(at, at + 1, ""))
        return after

    def _missing_comma(self, at: int, inner: _Open, closing: str) -> int:
        """Reads on where an element stands on a line of its own, or behind a bracket."""
        end = at
        while self.text[end - 1] in " \t\r\n":
            end -= 1
        apart = "\n" in self.text[end:at] or self.text[end - 1] in "}]"
        if not (apart and self.text.startswith(('"', "{", "["), at)):
            raise self._expected(at, f"',' or '{closing}'", inner)
        message = f"expected ',' or '{closing}', found {self._shown(at)!r}"
        self._mend(at, message, "put a comma before it", TextEdit(end, end, ","))
        return at

    def _shown(self, at: int) -> str:
        return self.text[at : at + 12].split("\n")[0]

    def _expected(self, at: int, what: str, inner: _Open | None) -> _Stop:
        if at >= len(self.text):
            return self._ended()
        shown = self.text[at : at + 12].split("\n")[0]
        hint = _habit(self.text, at)
        if hint is None and "','" in what and shown[0] in '"{[':
            hint = "put a comma before it"
        if hint is None and inner is not None:
            name = "object" if inner.kind == "{" else "array"
            line = self.text.count("\n", 0, inner.start) + 1
            hint = f"the {name} that is open here began in line {line}"
        return self._stop(at, f"expected {what}, found {shown!r}", hint)

    def _ended(self) -> _Stop:
        hint = None
        if self.open:
            inner = self.open[-1]
            name = "object '{'" if inner.kind == "{" else "array '['"
            line = self.text.count("\n", 0, inner.start) + 1
            hint = f"the {name} of line {line} is not closed; the text was probably cut off"
        end = len(self.text.rstrip())
        return self._stop(max(0, end - 1), "the text ends inside the JSON document", hint)

    def _member(self, at: int, inner: _Open) -> int:
        key_start = at
        if self.text.startswith('"', at):
            key, at = self._string(at)
        else:
            key, at = self._other_key(at, inner)
        self.path.append(key)
        if key in inner.keys:
            self._fault(
                Code.DUPLICATE_KEY,
                key_start,
                f"the key {key!r} appears twice in this object",
                "keep one of the two",
            )
        inner.keys.add(key)
        at = self._skip(at)
        if not self.text.startswith(":", at):
            raise self._expected(at, "':' after the key", inner)
        return self._value(self._skip(at + 1), key_start)

    def _other_key(self, at: int, inner: _Open) -> tuple[str, int]:
        """A key in other quotes, or without any."""
        found = notations.quoted_at(self.text, at) or notations.bare_key_at(self.text, at)
        if found is None:
            raise self._expected(at, "a key in double quotes", inner)
        self._quote(at, "a key in double quotes", found)
        return found

    def _quote(self, at: int, what: str, found: tuple[str, int]) -> None:
        message = f"expected {what}, found {self._shown(at)!r}"
        edit = TextEdit(at, found[1], json.dumps(found[0], ensure_ascii=False))
        self._mend(at, message, _habit(self.text, at), edit)

    def _value(self, at: int, key_start: int | None) -> int:
        first = self.text[at : at + 1]
        if first in ("{", "[") or (first == "(" and self.open):
            if len(self.open) >= self.max_depth:
                self._fault(
                    Code.TOO_LARGE,
                    at,
                    f"nested more than {self.max_depth} levels deep",
                    "a task needs eight levels; look for brackets that are not closed",
                )
                raise _Stop
            self.open.append(_Open(first, at, key_start))
            return at + 1
        end = self._string(at)[1] if first == '"' else self._scalar(at)
        self._place(at, end, key_start)
        if self.path:
            self.path.pop()
        return end

    def _string(self, at: int) -> tuple[str, int]:
        match = _STRING.match(self.text, at)
        if match:
            body = match[1]
            text = _unescape(body) if "\\" in body else body
            if "\ufffd" in text and "\ufffd" not in body:
                self._fault(
                    Code.SYNTAX,
                    at,
                    "this text has half a character (a lone surrogate)",
                    "write the character itself, or both halves of its escape",
                )
            return text, match.end()
        partial = _STRING_BODY.match(self.text, at)
        stop = partial.end() if partial else at + 1
        if stop >= len(self.text) or _CUT_ESCAPE.fullmatch(self.text, stop):
            hint = 'close it with "; the text was probably cut off'
            raise self._stop(at, "the string that begins here is not closed", hint)
        if self.text[stop] == "\\":
            shown = self.text[stop : stop + 2]
            hint = r"write \\ for a backslash"
            shown = repr(shown)[1:-1].replace("\\\\", "\\", 1)
            raise self._stop(stop, f"the escape '{shown}' does not exist in JSON", hint)
        return self._broken_string(at, stop)

    def _broken_string(self, at: int, stop: int) -> tuple[str, int]:
        """Reads on behind a text with line breaks in it, if something closes it."""
        message = "a line break or control character inside a string"
        hint = 'write it as an escape such as \\n, or close the string with "'
        found = notations.broken_text_at(self.text, at)
        if found is None and self.text.find('"', stop) < 0:
            hint = 'close it with "; the text was probably cut off'
            raise self._stop(at, "the string that begins here is not closed", hint)
        if found is None:
            raise self._stop(stop, message, hint)
        written = json.dumps(found[0], ensure_ascii=False)
        self._mend(stop, message, hint, TextEdit(at, found[1], written))
        return found

    def _scalar(self, at: int) -> int:
        for word in ("true", "false", "null"):
            if self.text.startswith(word, at):
                return at + len(word)
        number = _NUMBER.match(self.text, at)
        if number and not self.text.startswith("-I", at):
            if number.end() - at > _LONGEST_NUMBER or len(number[1] or "") > _LONGEST_EXPONENT:
                self._fault(
                    Code.BAD_NUMBER,
                    at,
                    "a number out of range",
                    f"a number may have {_LONGEST_NUMBER} characters, and its exponent "
                    f"{_LONGEST_EXPONENT} digits",
                )
            return number.end()
        sign = 1 if self.text.startswith(("-", "+"), at) else 0
        word_match = _WORD.match(self.text, at + sign)
        if word_match and word_match[0] in _NOT_FINITE:
            self._fault(
                Code.BAD_NUMBER,
                at,
                f"{self.text[at : word_match.end()]} is not a number in JSON",
                "write a finite number, or leave the field out",
            )
            return word_match.end()
        return self._other_scalar(at)

    def _other_scalar(self, at: int) -> int:
        """The end of a text, word or number as other languages write it."""
        inner = self.open[-1] if self.open else None
        quoted = notations.quoted_at(self.text, at)
        if inner is not None and quoted is not None:
            self._quote(at, "a value", quoted)
            return quoted[1]
        meant = notations.word_or_number_at(self.text, at)
        if inner is None or meant is None:
            raise self._expected(at, "a value", inner)
        written, end = meant
        message, hint = f"expected a value, found {self._shown(at)!r}", f"JSON writes {written}"
        self._mend(at, message, hint, TextEdit(at, end, written))
        return end


_CLOSING = {"{": "}", "[": "]", "(": ")"}


_HABITS = {"True": "true", "False": "false", "None": "null", "undefined": "null"}
"""Words of other languages, and how JSON writes them."""


def _habit(text: str, at: int) -> str | None:
    """The hint for a notation of other languages."""
    if text.startswith(("//", "/*", "#"), at):
        return "JSON has no comments: remove it"
    if text.startswith(("'", "‘", "’", "“", "”"), at):
        return 'JSON has only double quotes: "…"'
    word = _WORD.match(text, at)
    if word is None:
        return None
    if word[0] in _HABITS:
        return f"JSON writes {_HABITS[word[0]]}"
    return "write text in double quotes"


_ESCAPE = re.compile(r'\\(["\\/bfnrt]|u[0-9a-fA-F]{4})')
_CUT_ESCAPE = re.compile(r"\\(u[0-9a-fA-F]{0,3})?")
_SIMPLE = {"b": "\b", "f": "\f", "n": "\n", "r": "\r", "t": "\t"}


def _unescape(body: str) -> str:
    def one(match: re.Match[str]) -> str:
        code = match[1]
        return chr(int(code[1:], 16)) if code[0] == "u" else _SIMPLE.get(code, code)

    text = _ESCAPE.sub(one, body)
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def scan(
    text: str, start: int = 0, wanted: Collection[Pointer] = frozenset(), max_depth: int = 1000
) -> Scan:
    """Scans one JSON value from `start` for the places of the `wanted` elements and for faults."""
    return _Scanner(text, wanted, max_depth).run(start)
