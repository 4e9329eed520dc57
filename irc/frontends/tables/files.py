"""Sheets from and to files: workbooks (`.xlsx`), a CSV file, or a folder of CSV files."""

from __future__ import annotations

import csv
import io
import re
import zipfile
from collections.abc import Iterator, Sequence
from datetime import date, datetime, time
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from irc.diagnostics import Code, Diagnostic, InputError, Report
from irc.errors import LibraryMissing
from irc.frontends.tables.cells import Sheet, Value
from irc.frontends.texts import read_bytes, read_text

_MOST_BYTES = 256 * 1024 * 1024
"""A workbook that is larger than this when it is unpacked is refused."""

_MOST_CELLS = 5_000_000
_FORMULA = ("=", "+", "-", "@", "\t", "\r")
_MERGED = re.compile(rb'<mergeCell\s[^>]*ref="([A-Z0-9:]{1,20})"')


def read_sheets(file: str) -> list[Sheet]:
    """The sheets of a workbook, of a folder of CSV files, or of one CSV file.

    A single CSV file is the sheet `actions`. Raises `InputError`, or `LibraryMissing` without
    openpyxl (`pip install 'irc-compiler[files]'`).
    """
    path = Path(file)
    if path.is_dir():
        files = sorted(p for p in path.iterdir() if p.suffix.lower() == ".csv")
        if not files:
            raise _refused(f"the folder {file!r} has no .csv files")
        return [Sheet(p.stem, _csv_rows(str(p))) for p in files]
    if path.suffix.lower() == ".csv":
        return [Sheet("actions", _csv_rows(file))]
    return list(_workbook(file))


def _refused(message: str) -> InputError:
    return InputError(Report((Diagnostic(Code.NOT_AN_IMPORT, message),)))


def _csv_rows(file: str) -> list[list[Value]]:
    """The rows of a CSV file with commas, semicolons or tabs between the cells."""
    text, name = read_text(file)
    text = text.removeprefix("\ufeff")
    first = text.lstrip().partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
        return [[_unescaped(cell) for cell in row] for row in reader]
    except csv.Error as error:
        raise _refused(f"{name}: {error}") from None


def _unescaped(cell: str) -> str:
    """A cell without the apostrophe that keeps a text from being taken for a formula."""
    return cell[1:] if cell[:1] == "'" and cell[1:2] in (*_FORMULA, "'") else cell


def _workbook(file: str) -> Iterator[Sheet]:
    openpyxl = _openpyxl()
    data, name = read_bytes(file)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            size = sum(one.file_size for one in packed.infolist())
            if size > _MOST_BYTES:
                raise _refused(f"{name}: {size:,} bytes when unpacked; at most {_MOST_BYTES:,}")
            merged = _merged(packed)
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - openpyxl raises what its many parts raise
        raise _refused(f"{name} is not a workbook (.xlsx): {error}") from None
    if merged:
        message = f"{name}: cells {merged} are merged, so that a row has no value of its own"
        hint = "unmerge them, and write the value into each row"
        raise InputError(Report((Diagnostic(Code.NOT_AN_IMPORT, message, hint=hint),)))
    left = _MOST_CELLS
    for sheet in book.worksheets:
        rows = []
        for row in sheet.iter_rows(values_only=True):
            left -= len(row)
            if left < 0:
                raise _refused(f"{name}: more than {_MOST_CELLS:,} cells")
            rows.append(row)
        yield Sheet(sheet.title, rows)


def _merged(packed: zipfile.ZipFile) -> str | None:
    """The first merged cells of a workbook; they stand behind the rows of a sheet."""
    for one in packed.infolist():
        if one.filename.startswith("xl/worksheets/sheet"):
            found = _MERGED.search(packed.read(one))
            if found:
                return found[1].decode()
    return None


def _openpyxl() -> Any:
    if find_spec("openpyxl") is None:
        raise LibraryMissing("workbooks need openpyxl: pip install 'irc-compiler[files]'")
    import openpyxl

    return openpyxl


def workbook_bytes(sheets: Sequence[Sheet]) -> bytes:
    """The sheets as a workbook. No text becomes a formula."""
    openpyxl = _openpyxl()
    from openpyxl.styles import Font

    book = openpyxl.Workbook()
    book.remove(book.active)
    for sheet in sheets:
        page = book.create_sheet(sheet.name)
        page.freeze_panes = "A2"
        for r, row in enumerate(sheet.rows, 1):
            for c, value in enumerate(row, 1):
                if value is None:
                    continue
                cell = page.cell(r, c)
                cell.value = _storable(value)
                if isinstance(value, str):
                    cell.data_type = "s"
                if r == 1:
                    cell.font = Font(bold=True)
        for c, name in enumerate(sheet.rows[0], 1):
            width = max(len(str(name)), *(len(str(row[c - 1] or "")) for row in sheet.rows[:200]))
            page.column_dimensions[page.cell(1, c).column_letter].width = min(width + 2, 40)
    buffer = io.BytesIO()
    book.save(buffer)
    return buffer.getvalue()


_ILLEGAL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f]")


def _storable(value: Value) -> Value:
    """A value that a workbook can hold: no control characters, no time zone."""
    if isinstance(value, str):
        return _ILLEGAL.sub("\ufffd", value)
    return value.replace(tzinfo=None) if isinstance(value, datetime) else value


def csv_text(sheet: Sheet) -> str:
    """A sheet as CSV. A text that begins like a formula gets an apostrophe in front."""
    buffer = io.StringIO(newline="")
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerows([[_escaped(value) for value in row] for row in sheet.rows])
    return buffer.getvalue()


def _escaped(value: Value) -> str:
    if value is None:
        return ""
    if isinstance(value, (datetime, date, time)):
        return value.isoformat()
    if isinstance(value, str):
        return f"'{value}" if value.startswith((*_FORMULA, "'")) else value
    return str(value)
