"""Sheets of cells, and what the cells of one say as values of the IR, every fault placed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date, datetime, time, timedelta
from decimal import Decimal
from typing import Any

from irc.diagnostics import Code, Findings, InputError, Report, did_you_mean
from irc.frontends.tables.layout import SHEETS, Column, Kind, plain

Value = str | int | float | Decimal | bool | datetime | date | time | timedelta | None
"""The content of a cell of a spreadsheet or a CSV file."""

_LOCAL_DATE = re.compile(r"\d{1,2}[./]\d{1,2}[./]\d{2,4}")
_YES, _NO = ("yes", "true", "1", "x"), ("no", "false", "0")


@dataclass(frozen=True)
class Sheet:
    """A sheet: its name and its rows, the line of headings among them."""

    name: str
    rows: Sequence[Sequence[Value]]


@dataclass
class Faults:
    """The faults of the tables of a file, in the order in which they are found."""

    file: str
    findings: Findings = field(default_factory=Findings)

    def add(self, place: str, message: str, hint: str | None = None) -> None:
        """Records a fault."""
        self.findings.add(Code.NOT_AN_IMPORT, f"{self.file}, {place}: {message}", hint=hint)

    def raise_any(self) -> None:
        """Raises `InputError` with all faults, if there are any."""
        if self.findings.items:
            raise InputError(Report(tuple(self.findings.items)))


@dataclass(frozen=True)
class Row:
    """A row of a sheet: its cells by the names of the columns, without the empty ones."""

    sheet: str
    number: int
    cells: Mapping[str, Value]
    letters: Mapping[str, str]
    faults: Faults

    def place(self, column: str | None = None) -> str:
        """The place of a cell, or of the row, in words."""
        where = f"sheet '{self.sheet}', "
        if column is None or column not in self.letters:
            return where + f"row {self.number}"
        return where + f"{self.letters[column]}{self.number} ({column})"

    def fault(self, column: str | None, message: str, hint: str | None = None) -> None:
        """Records a fault of a cell, or of the row."""
        self.faults.add(self.place(column), message, hint)

    def fields(self, *names: str) -> dict[str, Any]:
        """The cells of some columns as values of the IR; empty ones are left out."""
        found = {name: self.value(name) for name in names if name in self.cells}
        return {name: value for name, value in found.items() if value is not None}

    def text(self, name: str) -> str:
        """The text of a cell; empty where the cell is."""
        return str(self.value(name) or "")

    def value(self, name: str) -> Any:
        """The cell of a column as a value of the IR; None where it is empty or faulty."""
        written = self.cells.get(name)
        if written is None:
            return None
        return self._read(SHEETS[self.sheet][name].kind, name, written)

    def _read(self, kind: Kind, name: str, written: Value) -> Any:
        if kind is Kind.NUMBER:
            return self._number(name, written)
        if kind is Kind.FLAG:
            return self._flag(name, written)
        if kind in (Kind.TEXT, Kind.NAMES):
            text = _as_text(written)
            parts = [part.strip() for part in text.split(";")]
            return text if kind is Kind.TEXT else [part for part in parts if part]
        return self._time(kind, name, written)

    def _number(self, name: str, written: Value) -> int | None:
        number = _numeric(written)
        if isinstance(number, int) and not isinstance(number, bool):
            return number
        self.fault(name, f"expected a whole number, found {_shown(written)}")
        return None

    def _flag(self, name: str, written: Value) -> bool | None:
        said = str(written).strip().lower()
        if said in _YES or said in _NO:
            return said in _YES
        self.fault(name, f"expected yes or no, found {_shown(written)}")
        return None

    def _time(self, kind: Kind, name: str, written: Value) -> Any:
        if isinstance(written, timedelta):
            seconds = Decimal(written // timedelta(microseconds=1)).scaleb(-6).normalize()
            return f"{seconds:f} s"
        if isinstance(written, time):
            if kind is Kind.CLOCK:
                return written.isoformat("minutes" if not written.second else "seconds")
            message = f"expected a length of time, found the time of day {written}"
            self.fault(name, message, "write the number of hours, or a text such as 1 h 30 min")
            return None
        if isinstance(written, (datetime, date)):
            if kind in (Kind.INSTANT, Kind.DAY):
                return written.isoformat()
            self.fault(name, f"expected a length of time, found the date {written}")
            return None
        return self._written_time(name, written)

    def _written_time(self, name: str, written: Value) -> Any:
        number = _numeric(written)
        if number is not None:
            return number
        text = str(written).strip()
        if _LOCAL_DATE.search(text):
            message = f"the date {_shown(text)} could be read in several ways"
            hint = "make the cell a real date, or write 2026-03-02T14:00:00"
            self.fault(name, message, hint)
            return None
        return re.sub(r"\A(\d{4}-\d\d-\d\d)\s+(\d)", r"\1T\2", text)


def rows_of(sheet: Sheet, faults: Faults) -> Iterator[Row]:
    """The rows of a sheet below its line of headings, without empty ones."""
    name = plain(sheet.name)
    columns = SHEETS[name]
    heading, first = _headings(sheet)
    if heading is None:
        return
    positions = _positions(name, heading, columns, faults)
    if positions is None:
        return
    letters = {column: _letters(at) for column, at in positions.items()}
    for number, cells in enumerate(sheet.rows[first:], first + 1):
        held = {
            column: cells[at]
            for column, at in positions.items()
            if at < len(cells) and not _is_empty(cells[at])
        }
        if not held:
            continue
        row = Row(name, number, held, letters, faults)
        missing = [c for c, spec in columns.items() if spec.required and c not in held]
        if missing:
            row.fault(missing[0], f"the cell of '{missing[0]}' is empty")
        else:
            yield row


def _headings(sheet: Sheet) -> tuple[Sequence[Value] | None, int]:
    """The first row that is not empty, and the number of rows up to it."""
    for number, row in enumerate(sheet.rows):
        if not all(_is_empty(cell) for cell in row):
            return row, number + 1
    return None, 0


def _positions(
    name: str, heading: Sequence[Value], columns: Mapping[str, Column], faults: Faults
) -> dict[str, int] | None:
    """Where each column stands; None if a column that must be there is missing."""
    known = {alias: c for c, spec in columns.items() for alias in (c, *spec.aliases)}
    found: dict[str, int] = {}
    for at, cell in enumerate(heading):
        if _is_empty(cell):
            continue
        column = known.get(plain(str(cell)))
        place = f"sheet '{name}', {_letters(at)}"
        if column is None:
            hint = did_you_mean(plain(str(cell)), known) or f"columns are {', '.join(columns)}"
            faults.add(place, f"there is no column {_shown(cell)}", hint)
        elif column in found:
            faults.add(place, f"the column '{column}' is there twice")
        else:
            found[column] = at
    missing = [c for c, spec in columns.items() if spec.required and c not in found]
    for column in missing:
        faults.add(f"sheet '{name}'", f"the column '{column}' is missing")
    return None if missing else found


def _letters(position: int) -> str:
    """The letters of a column: A, B, …, Z, AA, …"""
    text = ""
    position += 1
    while position:
        position, digit = divmod(position - 1, 26)
        text = chr(ord("A") + digit) + text
    return text


def _is_empty(cell: Value) -> bool:
    return cell is None or (isinstance(cell, str) and not cell.strip())


def _numeric(written: Value) -> int | Decimal | None:
    """A number in a cell, also one that is written as text; None where there is none."""
    if isinstance(written, bool):
        return None
    if isinstance(written, str):
        text = written.strip()
        if not re.fullmatch(r"[+-]?\d{1,30}(\.\d{1,30})?", text, re.ASCII):
            return None
        number = Decimal(text)
    elif isinstance(written, (int, float, Decimal)):
        number = Decimal(repr(written)) if isinstance(written, float) else Decimal(written)
        if not number.is_finite():
            return None
    else:
        return None
    return int(number) if number == number.to_integral_value() else number.normalize()


def _as_text(written: Value) -> str:
    """The text of a cell. A number is written as a whole number where it is one."""
    number = None if isinstance(written, str) else _numeric(written)
    if number is None:
        return str(written).strip()
    return str(number) if isinstance(number, int) else f"{number:f}"


def _shown(value: object) -> str:
    text = str(value)
    return repr(text if len(text) <= 40 else text[:39] + "…")
