"""Reports: all findings about one input, placed in its text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from irc.diagnostics.source import Pointer, Source
from irc.errors import IrcError
from irc.outcome import FAULTY, FEASIBLE, INFEASIBLE, REFUSED, Outcome

if TYPE_CHECKING:
    from irc.diagnostics.fix import Fix, TextEdit
    from irc.diagnostics.source import Range
from irc.diagnostics.finding import DIAGNOSTICS_VERSION, Code, Diagnostic, Severity, _row

_ORDER = {Severity.ERROR: 0, Severity.WARNING: 1, Severity.NOTE: 2}


@dataclass(frozen=True)
class Report:
    """All findings about one input, in the order of the text."""

    diagnostics: tuple[Diagnostic, ...] = ()
    source: Source | None = None

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The findings that stop a compilation."""
        return tuple(d for d in self.diagnostics if d.severity is Severity.ERROR)

    @property
    def ok(self) -> bool:
        """Whether nothing stops a compilation."""
        return not any(d.severity is Severity.ERROR for d in self.diagnostics)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.diagnostics)

    def __add__(self, more: Iterable[Diagnostic]) -> Report:
        return Report((*self.diagnostics, *more), self.source)

    def located(self) -> Report:
        """The same report in reading order, with lines, columns, and pointers as the text has them.

        The checks know an element by the IR's own field names. A text may write an alias or a
        pair instead, and pointers and fixes must match the author's text.
        """
        if self.source is None:
            return self
        wanted = {d.pointer for d in self.diagnostics if d.offset is None}
        wanted |= {o.target for d in self.diagnostics for o in d.fix}
        places = self.source.locate(wanted) if wanted else {}
        placed = [_placed(d, self.source, places.get(d.pointer)) for d in self.diagnostics]
        placed.sort(key=_reading_order)
        return Report(tuple(placed), self.source)

    def __str__(self) -> str:
        """The findings as text, or that there are none."""
        return self.render() or "no problems found"

    def _repr_html_(self) -> str:
        """The findings as a table, for notebooks."""
        from irc.display.html import heading, table

        if not self.diagnostics:
            return heading("no problems found")
        columns = ("", "code", "message", "place", "hint")
        return table(columns, [_row(d) for d in self.located()])

    @property
    def contradicts(self) -> bool:
        """Whether its errors prove that the task, which has no other fault, has no schedule."""
        return not self.ok and all(d.code.proves_infeasible for d in self.errors)

    @property
    def outcome(self) -> Outcome:
        """How a call with this input ends: "infeasible", "refused" or "faulty" if it has errors.

        Without errors it is "feasible", as far as checks can tell.
        """
        errors = Report(self.errors, self.source).located().diagnostics
        if self.ok:
            return Outcome.of(FEASIBLE, message="no error was found")
        if self.contradicts:
            return Outcome.of(INFEASIBLE, errors)
        refused = all(d.code in (Code.UNSUPPORTED, Code.OUT_OF_RANGE) for d in errors)
        return Outcome.of(REFUSED if refused else FAULTY, errors)

    def to_dict(self) -> dict[str, Any]:
        """The document that `irc check --format json` prints."""
        return {
            "irc_diagnostics": DIAGNOSTICS_VERSION,
            "ok": self.ok,
            "diagnostics": self.to_list(),
            **({} if self.ok else {"outcome": self.outcome.to_dict()}),
        }

    def to_list(self) -> list[dict[str, Any]]:
        """Every diagnostic, located."""
        return [d.to_dict() for d in self.located()]

    def render(self, *, notes: bool = True) -> str:
        """The text for people: each finding with its source line and a caret under it."""
        from irc.diagnostics.text import render

        located = self.located()
        return render(located.diagnostics, located.source, notes=notes)


def _reading_order(d: Diagnostic) -> tuple[str, int, int, int]:
    """A sort key by place; findings in included files come after the text's own, file by file."""
    file = "" if d.within is None else d.within.name
    return file, d.line or 0, d.column or 0, _ORDER[d.severity]


def _placed(d: Diagnostic, source: Source, place: Range | None) -> Diagnostic:
    """A diagnostic with its place in the text, if it has one."""
    if d.fix:
        from irc.diagnostics.patching import as_written

        d = replace(d, fix=as_written(d.fix, source))
    offset, end, within = d.offset, d.end, d.within
    if offset is None and place is not None:
        offset, within = place.start, place.within
        if d.at_key and place.key_start is not None:
            offset = place.key_start
        elif place.written is None or len(place.written) == len(d.pointer):
            end = place.end
        if place.written is not None:
            pointer = (*place.written, *d.pointer[len(place.written) :])
            d = replace(d, pointer=pointer)
    if offset is None:
        return d
    text = within or source
    line, column = text.line_and_column(offset)
    if end is not None and "\n" in text.text[offset:end]:
        end = None
    return replace(d, line=line, column=column, offset=offset, end=end, within=within)


class InputError(IrcError):
    """The input is faulty; `report` has each finding with its place."""

    def __init__(self, report: Report) -> None:
        self.report = report
        super().__init__(report.render(notes=False))

    @property
    def outcome(self) -> Outcome:
        """How the call ended, with the errors of the report."""
        return self.report.outcome


@dataclass
class Findings:
    """Collects diagnostics while a check runs."""

    items: list[Diagnostic] = field(default_factory=list)

    @property
    def has_errors(self) -> bool:
        """Whether one of them stops a compilation."""
        return any(d.severity is Severity.ERROR for d in self.items)

    def add(
        self,
        code: Code,
        message: str,
        pointer: Pointer = (),
        *,
        hint: str | None = None,
        at_key: bool = False,
        offset: int | None = None,
        fix: Fix = (),
        edits: tuple[TextEdit, ...] = (),
    ) -> None:
        """Records one finding."""
        self.items.append(
            Diagnostic(code, message, pointer, hint, at_key, offset, fix=fix, edits=edits)
        )
