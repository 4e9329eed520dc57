"""Reads a text of the DSL as the plain document, in the form of the IR's JSON, with its places.

Statements are read one by one, so that a fault in one hides no other: `read_dsl` returns the
document of all sound statements together with every fault.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from irc.diagnostics import Code, Diagnostic, Report
from irc.diagnostics.source import Pointer, Range, Source
from irc.frontends.dsl import changes, nodes, rules
from irc.frontends.dsl.build import Builder, repeated_clause
from irc.frontends.dsl.document_parts import ExpansionLimit, Places, Sink
from irc.frontends.dsl.faults import Fault
from irc.frontends.dsl.grammar import StatementParser, parse_statement
from irc.frontends.dsl.include import Library
from irc.frontends.dsl.lex_words import unlexed
from irc.frontends.dsl.lexer import (
    CALENDAR_WORDS,
    CLAUSE_WORDS,
    PHRASE_STARTS,
    RULE_STARTS,
    RULE_WORDS,
    STATEMENT_WORDS,
    Lexeme,
    LexFault,
    classified,
    lexemes,
)
from irc.frontends.dsl.lines import MAX_NESTING, Statement, outline
from irc.frontends.dsl.metadata import FREE_FORM, json_after
from irc.frontends.dsl.nodes import kind, part, span
from irc.frontends.dsl.plain import plain_statement
from irc.frontends.dsl.pool_uses import resolved_pools
from irc.frontends.dsl.templates import Value, filled

MAX_FAULTS = 1000
"""Limit on faults; the rest of the text is not read, because it is probably another language."""

ARRAYS = (
    *("calendars", "resources", "state", "actions", "precedence", "groups"),
    *("couplings", "select", "sequences", "goals", "events"),
)

Values = Mapping[str, Value]


@dataclass(frozen=True)
class DslReading:
    """The document of a DSL text, with every fault of the text.

    `document` has the shape of the IR's JSON and the contents of the sound statements; `source`
    finds the places of its parts. `broken` are the texts of faulty statements.
    """

    document: dict[str, Any]
    source: Source
    faults: tuple[Diagnostic, ...] = ()
    notes: tuple[Diagnostic, ...] = ()
    broken: tuple[str, ...] = ()


def read_dsl(
    text: str, name: str = "<text>", folder: Path | None = None, *, file: Path | None = None
) -> DslReading:
    """Reads a text. Its includes must be in `folder`; `file` is its own path.

    Never raises for the contents of the text.
    """
    notes = []
    if text.startswith("\ufeff"):
        text = text[1:]
        notes.append(
            Diagnostic(Code.BYTE_ORDER_MARK, "a byte-order mark at the start is ignored", offset=0)
        )
    library = Library(folder)
    reader = _Reader(library, Builder(ExpansionLimit()))
    reader.read(text, file)
    return DslReading(
        reader.document(),
        Source(name, text, _Locator(library, file)),
        tuple(reader.faults.values()),
        tuple(notes),
        tuple(reader.broken),
    )


@dataclass(frozen=True, slots=True)
class _Locator:
    """Finds the elements of a text and of its included files."""

    library: Library
    file: Path | None

    def __call__(self, text: str, wanted: frozenset[Pointer]) -> Mapping[Pointer, Range]:
        # Read the same texts again, this time with places.
        places = Places(wanted)
        again = Library(self.library.folder, self.library.known, kept=True)
        _Reader(again, Builder(ExpansionLimit(), places)).read(text, self.file)
        return places.found


def readable_statements(text: str, most: int) -> int:
    """The number of sound statements among the first `most` statements of a text."""
    text = text.removeprefix("\ufeff")
    reader = _Reader(Library(None), Builder(ExpansionLimit()), text=text)
    try:
        statements = outline(text).statements[:most]
    except Fault:
        return 0
    good = 0
    for statement in statements:
        try:
            raw = reader._tokens(statement)
            colon = _colon(raw)
            if statement.first not in FREE_FORM:
                parse_statement(classified(raw[: colon + 1] or raw), "statement")
        except Fault:
            continue
        good += 1
    return good


def syntax_faults(text: str, name: str) -> Report:
    """The faults of a text's own statements; included files are not read."""
    text = text.removeprefix("\ufeff")
    reader = _Reader(Library(None), Builder(ExpansionLimit()), includes=False)
    reader.read(text, None)
    return Report(tuple(reader.faults.values()), Source(name, text))


@dataclass(slots=True)
class _Reader:
    library: Library
    builder: Builder
    sink: Sink = field(default_factory=lambda: Sink({part: [] for part in ARRAYS}))
    fields: dict[str, Any] = field(default_factory=dict)
    faults: dict[tuple[Any, ...], Diagnostic] = field(default_factory=dict)
    broken: list[str] = field(default_factory=list)
    parser: StatementParser = field(default_factory=StatementParser)
    text: str = ""
    path: Path | None = None
    """The folder of the file that is being read, if it is a file."""
    within: tuple[Path, ...] = ()
    """The files that include the one being read, and this file itself."""
    statements: int = 0
    stopped: bool = False
    """Whether the text has reached a limit of expansion."""
    includes: bool = True
    """Whether included files are read."""

    # --- texts ---

    def read(self, text: str, file: Path | None) -> None:
        """Reads the task's own text."""
        self.text = text
        if file is not None:
            self.path = file.parent
            self.within = (file.resolve(),)
        self._text()
        if not self.statements and not self.faults:
            self._tell(
                Fault(
                    Code.DSL_SYNTAX,
                    "the input is empty" if not text.strip() else "there is no statement",
                    0,
                    0,
                    "expected a task such as `boil eggs 4 min`",
                )
            )
        for fault, within in resolved_pools(self.builder, self.sink, faulty=bool(self.broken)):
            self.builder.source = within
            self._tell(fault)
        self.builder.source = None

    def _text(self) -> None:
        try:
            found = outline(self.text)
        except Fault as fault:
            self._tell(fault)
            return
        for misplaced in found.faults:
            self._tell(misplaced)
        self._each(found.statements, self._statement, {})

    def _each(
        self, statements: list[Statement], read: Callable[[Statement, Values], None], values: Values
    ) -> None:
        for statement in statements:
            if self.stopped or len(self.faults) >= MAX_FAULTS:
                break
            self.statements += 1
            before = self.sink.lengths() if statement.body or values else None
            try:
                read(statement, values)
            except Fault as fault:
                if before is not None:
                    self.sink.cut(before)
                self._tell(fault, statement)
                self.stopped = self.stopped or fault.code is Code.DSL_EXPANSION

    def _tell(self, fault: Fault, statement: Statement | None = None) -> None:
        within = self.builder.source
        # In a `for` the same place is read many times; report a fault there once.
        key = (fault.code, fault.start, within and within.name)
        if key in self.faults:
            return
        self.faults[key] = Diagnostic(
            fault.code,
            fault.message,
            hint=fault.hint,
            offset=fault.start,
            end=fault.end,
            within=within,
        )
        if statement is not None and statement.spans:
            self.broken.append(self.text[statement.start : statement.end])
        if len(self.faults) == MAX_FAULTS:
            self.faults[("last",)] = Diagnostic(
                Code.TOO_LARGE,
                f"more than {MAX_FAULTS} faults: the rest of the text is not read",
                offset=fault.start,
                within=within,
            )

    def document(self) -> dict[str, Any]:
        """The document without its empty arrays."""
        arrays = self.sink.arrays
        filled_arrays = {part: arrays[part] for part in ARRAYS if arrays[part] or part == "actions"}
        return {**self.fields, **filled_arrays}

    # --- statements ---

    def _statement(self, statement: Statement, values: Values) -> None:
        """Reads a statement of the task."""
        if plain_statement(statement, self.text, self.sink, self.builder):
            return
        if statement.first in FREE_FORM:
            self._free_form(statement, statement.first, values)
            return
        raw = self._tokens(statement)
        if raw[0].value == "for" and raw[0].type == "WORD":
            self._for(statement, raw, values, self._statement)
            return
        if raw[0].value == "event" and raw[0].type == "WORD":
            self._event(statement, raw, values)
            return
        _no_body(statement, raw)
        tree = self.parser.parse(classified(filled(raw, values)), "statement")
        rule = str(tree.data)
        if rule in _TASK_FIELDS:
            if values:
                raise Fault(
                    Code.DSL_SYNTAX,
                    f"`{raw[0].value}` cannot stand in a `for`",
                    *span(tree),
                    "it is about the whole task",
                )
            if rule == "include":
                if self.includes:
                    self._include(tree)
            else:
                self._field(rule, tree)
            return
        _ELEMENTS[rule](self.builder, tree, self.sink)

    def _tokens(self, statement: Statement) -> list[Lexeme]:
        """The raw tokens of a statement. Raises `Fault` at the first place without a token."""
        if statement.tokens is not None:
            return statement.tokens
        found: list[Lexeme] = []
        for begin, end in statement.spans:
            first = len(found)
            for token in lexemes(self.text, begin, end):
                if isinstance(token, LexFault):
                    raise unlexed(token, self.text)
                if token.type != "COMMENT":
                    found.append(token)
            own: Collection[str] = ()
            if found and found[0].value == "calendar":
                own = CALENDAR_WORDS
            elif found and found[0].value in RULE_STARTS:
                own = RULE_WORDS
            if (
                0 < first < len(found)
                and _of_name(found, first - 1)
                and _of_name(found, first)
                and found[first].value not in own
            ):
                raise Fault(
                    Code.DSL_INDENTATION,
                    "this line is indented, but does not continue the statement above it",
                    found[first].start_pos,
                    found[first].end_pos,
                    "remove the spaces before it; a name or a time must be on one line",
                )
        return found

    def _field(self, rule: str, tree: Any) -> None:
        """Reads a field of the whole task, which may appear once."""
        key, value_node = tree.children[0], tree.children[-1]
        if rule == "objective":
            field_name, value = "objective", self.builder.aims(tree, ("objective",))
            start, end = span(tree)
        else:
            field_name = _TASK_FIELDS[rule]
            placed = _FIELD_VALUES[rule](value_node)
            value, start, end = placed.value, placed.start, placed.end
        if field_name in self.fields:
            raise repeated_clause(f"`{key if rule != 'objective' else 'minimize'}`", *span(tree))
        self.fields[field_name] = value
        self.builder.mark((field_name,), start, end, span(tree)[0])

    def _free_form(self, statement: Statement, word: str, values: Values) -> None:
        if values:
            raise Fault(
                Code.DSL_SYNTAX,
                f"`{word}` cannot stand in a `for`",
                statement.start,
                statement.end,
                "it is about the whole task",
            )
        found = json_after(word, self.text, statement.start + len(word), statement.end)
        names = ("couplings", "select", "sequences") if word == "choices" else (word,)
        if any(name in self.fields for name in names):
            raise repeated_clause(f"`{word}`", statement.start, statement.end)
        if word == "choices":
            self._choices(found, statement)
            return
        self.fields[word] = found.value if word == "metadata" else found.value.get("of")
        self.builder.mark((word,), found.start, found.end, statement.start)

    def _choices(self, found: nodes.Placed, statement: Statement) -> None:
        """Takes over couplings, selections and sequences that are written as JSON."""
        for name, entries in found.value.items():
            self.builder.mark((name,), found.start, found.end, statement.start)
            if name not in ARRAYS or not isinstance(entries, list):
                self.fields[name] = entries
                continue
            for entry in entries:
                self.builder.mark(self.sink.next(name), found.start, found.end)
                self.sink.put(name, entry)

    # --- include ---

    def _include(self, tree: Any) -> None:
        file = nodes.text(part(tree, "STRING"))
        included = self.library.open(str(file.value), self.path, file.start, file.end)
        if included.path in self.within:
            chain = [p.name for p in self.within[self.within.index(included.path) :]]
            raise Fault(
                Code.DSL_INCLUDE,
                f"this include is circular: {' → '.join([*chain, included.path.name])}",
                file.start,
                file.end,
                "remove it",
            )
        outer = (self.text, self.path, self.within, self.builder.source)
        self.text, self.path = included.source.text, included.path.parent
        self.within = (*self.within, included.path)
        self.builder.source = included.source
        self._text()
        self.text, self.path, self.within, self.builder.source = outer

    # --- for ---

    def _for(
        self,
        statement: Statement,
        raw: list[Lexeme],
        values: Values,
        read: Callable[[Statement, Values], None],
    ) -> None:
        body = _body(statement, raw)
        header = raw[: _colon(raw) + 1]
        tree = self.parser.parse(classified(filled(header, values)), "statement")
        variable = str(part(tree, "WORD"))
        if not variable.isidentifier() or variable in values:
            raise Fault(
                Code.DSL_TEMPLATE,
                f"`{variable}` is the name of a `for` around this one"
                if variable in values
                else f"`{variable}` cannot be the name of a `for`",
                *span(part(tree, "WORD")),
                "choose another word",
            )
        if not values:
            self._foresee(statement, tree)
        if len(values) >= MAX_NESTING:
            raise Fault(Code.TOO_LARGE, f"`for`s nested more than {MAX_NESTING} deep", *span(tree))
        listed = self._listed(tree)
        length = sum(statement.end - statement.start for statement in body)
        self.builder.expansion.repeat(len(listed) * len(body), len(listed) * length, *span(tree))
        for value in listed:
            if self.stopped:
                break
            self._each(body, read, {**values, variable: value})

    def _foresee(self, statement: Statement, tree: Any) -> None:
        """Raises `Fault` if a `for`, with those in it, produces too many statements.

        This reports the fault at once, not after most of the statements were made.
        """
        count = self._weight(statement)
        if count > self.builder.expansion.statements:
            self.builder.expansion.repeat(count, 0, *span(tree))

    def _weight(self, statement: Statement, depth: int = 0) -> int:
        """The number of statements that a statement produces, estimated from its text alone."""
        if depth > MAX_NESTING:
            return 1
        try:
            raw = self._tokens(statement)
            if raw[0].type != "WORD" or raw[0].value != "for":
                return 1
            body = _body(statement, raw)
            inner = sum(self._weight(part, depth + 1) for part in body)
            header = raw[: _colon(raw) + 1]
            if any("{" in token.value for token in header):
                return inner
            return inner * len(self._listed(self.parser.parse(classified(header))))
        except Fault:
            return 1  # The fault is reported when the statement is read.

    def _listed(self, tree: Any) -> Sequence[Value]:
        """The values of a `for`."""
        numbers = [n for n in tree.children if kind(n) == "INT"]
        if not numbers:
            return [found.value for found in nodes.names(part(tree, "names"))]
        low, high = (nodes.integer(n).value for n in numbers)
        if low > high:
            raise Fault(
                Code.EMPTY_RANGE,
                f"the range {low} .. {high} is empty",
                span(numbers[0])[0],
                span(numbers[1])[1],
                "write the smaller number first",
            )
        if high - low >= sys.maxsize:
            raise Fault(Code.BAD_NUMBER, "a number out of range", *span(numbers[1]))
        return range(low, high + 1)

    # --- events ---

    def _event(self, statement: Statement, raw: list[Lexeme], values: Values) -> None:
        if _colon(raw) < 0:
            raw = [*raw, Lexeme("COLON", ":", raw[-1].end_pos, raw[-1].end_pos)]
            statement = Statement(statement.spans, body=statement.body or [], tokens=raw)
        body = _body(statement, raw)
        header = filled(raw[: _colon(raw) + 1], values)
        tree = self.parser.parse(classified(header), "statement")
        at = self.sink.next("events")
        event: dict[str, Any] = {}
        self.builder.mark(at, *span(tree))
        if (named := part(tree, "name")) is not None:
            self.builder.put_field(event, "id", nodes.name(named), at)
        moment = nodes.time(part(tree, "INT", "TIME", "STRING"))
        self.builder.put_field(event, "at", moment, at, part(tree, "AT"))
        outer = self.sink
        self.sink = Sink({"changes": []}, at)
        self._each(body, self._change, values)
        if self.sink.arrays["changes"]:
            event["changes"] = self.sink.arrays["changes"]
        self.sink = outer
        self.sink.put("events", event)

    def _change(self, statement: Statement, values: Values) -> None:
        """Reads a statement in the body of an event."""
        raw = self._tokens(statement)
        if raw[0].value == "for" and raw[0].type == "WORD":
            self._for(statement, raw, values, self._change)
            return
        at = self.sink.next("changes")
        if len(raw) > 1 and raw[0].value in ("add", "remove") and raw[1].type == "COLON":
            self._block(statement, raw, values, at)
            return
        _no_body(statement, raw)
        tree = self.parser.parse(classified(filled(raw, values), change=True), "change")
        self.sink.put("changes", changes.change(self.builder, tree, at))

    def _block(self, statement: Statement, raw: list[Lexeme], values: Values, at: Pointer) -> None:
        """Reads `add:` or `remove:` with a body: one change of many parts."""
        body, outer = _body(statement, raw), self.sink
        adds = raw[0].value == "add"
        self.builder.mark(at, raw[0].start_pos, raw[0].end_pos)
        self.sink = Sink({}, at)
        before = len(self.faults)
        self._each(body, self._added if adds else self._removed, values)
        inner, self.sink = self.sink, outer
        if len(self.faults) > before and not any(inner.arrays.values()):
            return  # All of its parts are faulty and reported.
        found = (
            changes.addition(inner, raw[0].start_pos, raw[0].end_pos)
            if adds
            else changes.removal(inner)
        )
        self.sink.put("changes", found)

    def _added(self, statement: Statement, values: Values) -> None:
        self._part(
            statement, values, self._added, lambda t: changes.added(self.builder, t, self.sink)
        )

    def _removed(self, statement: Statement, values: Values) -> None:
        def remove(tree: Any) -> None:
            if tree.data != "order":
                raise Fault(
                    Code.DSL_SYNTAX, "only an order can be removed", *span(tree), "write `a -> b`"
                )
            self.builder.order(tree, self.sink, plain=True)

        self._part(statement, values, self._removed, remove)

    def _part(
        self,
        statement: Statement,
        values: Values,
        again: Callable[[Statement, Values], None],
        read: Callable[[Any], None],
    ) -> None:
        raw = self._tokens(statement)
        if raw[0].value == "for" and raw[0].type == "WORD":
            self._for(statement, raw, values, again)
            return
        _no_body(statement, raw)
        read(self.parser.parse(classified(filled(raw, values)), "statement"))


def _of_name(tokens: list[Lexeme], i: int) -> bool:
    """Whether a raw token may be part of a name, or a duration."""
    token = tokens[i]
    if token.type == "WORD":
        if i == 0 and token.value in STATEMENT_WORDS:
            return False
        return token.value not in CLAUSE_WORDS and token.value not in PHRASE_STARTS
    return token.type in ("INT", "TIME", "STRING")


def _colon(raw: list[Lexeme]) -> int:
    return next((i for i, token in enumerate(raw) if token.type == "COLON"), -1)


def _body(statement: Statement, raw: list[Lexeme]) -> list[Statement]:
    """The statements of a block: the lines below it, or the rest of its own line."""
    colon = _colon(raw)
    if colon < 0:
        raise Fault(
            Code.DSL_SYNTAX,
            f"`{raw[0].value}` needs a `:` before its contents",
            raw[-1].end_pos - 1,
            raw[-1].end_pos,
        )
    rest = raw[colon + 1 :]
    if rest:
        inner = Statement(
            [(rest[0].start_pos, rest[-1].end_pos)], rest[0].value, statement.body, tokens=rest
        )
        return [inner]
    if statement.body is None and raw[0].value != "event":
        raise Fault(
            Code.DSL_SYNTAX,
            f"this `{raw[0].value}` is empty",
            raw[colon].start_pos,
            raw[colon].end_pos,
            "indent the lines that belong to it",
        )
    return statement.body or []


def _no_body(statement: Statement, raw: list[Lexeme]) -> None:
    if statement.body:
        raise Fault(
            Code.DSL_SYNTAX,
            "this statement cannot have a body",
            raw[-1].start_pos,
            raw[-1].end_pos,
            "remove the `:`",
        )


_TASK_FIELDS = {
    "task": "name",
    "irc": "irc",
    "description": "description",
    "unit": "time_unit",
    "days": "days_per_month",
    "resolution": "resolution",
    "origin": "origin",
    "task_deadline": "deadline",
    "objective": "objective",
    "include": "",
}
_FIELD_VALUES: dict[str, Callable[[Any], nodes.Placed]] = {
    "task": nodes.name,
    "irc": nodes.text,
    "description": nodes.text,
    "unit": nodes.text,
    "days": nodes.integer,
    "resolution": nodes.time,
    "origin": nodes.text,
    "task_deadline": nodes.time,
}
_ELEMENTS: dict[str, Callable[[Builder, Any, Sink], None]] = {
    "action": Builder.action,
    "order": Builder.order,
    "calendar": Builder.calendar,
    "resource": Builder.resource,
    "pool": Builder.pool,
    "state": Builder.state,
    "group": Builder.group,
    "goal": Builder.goal,
    "tie": rules.tie,
    "implied": rules.implied,
    "selection": rules.selection,
    "consecutive": rules.consecutive,
    "same_order": rules.same_order,
}
