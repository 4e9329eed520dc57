"""`irc check --fix`: applies the certain repairs to a file and reports the rest."""

from __future__ import annotations

from pathlib import Path

from irc.diagnostics import Diagnostic, InputError, Report
from irc.diagnostics.patching import apply_fixes, text_edits
from irc.driver.compile import check_task
from irc.driver.files import write_whole
from irc.frontends.files import parse_task
from irc.frontends.json.document import decode_bytes
from irc.frontends.texts import read_bytes

MOST_ROUNDS = 8
"""Limit on rounds: a repair can reveal another fault, which the next round repairs."""

_MARKS = {
    b"\xff\xfe\x00\x00": "utf-32-le",
    b"\x00\x00\xfe\xff": "utf-32-be",
    b"\xff\xfe": "utf-16-le",
    b"\xfe\xff": "utf-16-be",
}


def repair_file(file: str, report: Report) -> tuple[Report, Report]:
    """(the report of the repaired file, the repaired findings with their places before).

    `report` is the located report of the file before. The file is written only if something was
    repaired: as a whole, in its own encoding, with its own line ends, and changed nowhere else.
    Raises `InputError` or `irc.driver.files.WriteError`.
    """
    if report.source is None or not text_edits(report, report.source):
        return report, Report()
    data, name = read_bytes(file)
    text = decode_bytes(data, name)
    repaired, report, fixed = repair_text(text, name)
    if repaired != text:
        # Follow links to the file itself, and keep its permissions.
        path = Path(file).resolve()
        write_whole(path, _encoded(repaired, data), mode=path.stat().st_mode & 0o7777)
    return report, fixed


def repair_text(text: str, name: str) -> tuple[str, Report, Report]:
    """(the repaired text, its report, the repaired findings)."""
    fixed: list[Diagnostic] = []
    report = _report(text, name)
    for _ in range(MOST_ROUNDS):
        if report.source is None or not text_edits(report, report.source):
            break
        in_text = any(d.edits for d in report)
        fixed += [d for d in report if (d.edits if in_text else d.fix)]
        # Keep a byte-order mark, which is not part of the source.
        lead = text[: len(text) - len(report.source.text)]
        text = lead + apply_fixes(report, report.source)
        report = _report(text, name)
    return text, report, Report(tuple(fixed))


def _report(text: str, name: str) -> Report:
    try:
        reading = parse_task(text, name)
        return check_task(reading.task, reading.notes).located()
    except InputError as error:
        return error.report.located()


def _encoded(text: str, original: bytes) -> bytes:
    for mark, encoding in _MARKS.items():
        if original.startswith(mark):
            return mark + text.encode(encoding)
    return text.encode()
