"""`irc check`: every diagnostic of one or more files, for people, programs and CI, and repairs."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

from irc.cli.exit_codes import EXIT_INPUT, EXIT_USE
from irc.cli.output import (
    CheckFormat,
    Format,
    fail,
    put,
    put_json,
    reporting_errors,
    summary,
)
from irc.diagnostics import DIAGNOSTICS_VERSION, InputError, Report
from irc.diagnostics.fix import change_text


def check_files(files: Sequence[str], format: CheckFormat, fix: bool) -> None:
    """Checks the files, prints their diagnostics, and exits with 1 for any error."""
    plain = Format.text if format is CheckFormat.text else Format.json
    if files.count("-") > 1 or (fix and "-" in files):
        reason = "be rewritten" if fix else "be read twice"
        fail(EXIT_USE, f"standard input cannot {reason}; name a file", plain)
    with reporting_errors(plain):
        checked = [(file, *_checked(file, fix)) for file in files]
    if format is CheckFormat.sarif:
        from irc.diagnostics.sarif import sarif_log

        put_json(sarif_log([(file, report) for file, report, _ in checked]))
    elif format is CheckFormat.json:
        put_json(_as_json(checked))
    else:
        for file, report, fixed in checked:
            _print(file, report, fixed, many=len(checked) > 1)
    if not all(report.ok for _, report, _ in checked):
        sys.exit(EXIT_INPUT)


def _checked(file: str, fix: bool) -> tuple[Report, Report | None]:
    """(the report of a file, None); with `fix`, (the report after repairs, the repaired ones)."""
    from irc.driver.compile import check_task
    from irc.frontends.files import read_task

    try:
        reading = read_task(file)
        report = check_task(reading.task, reading.notes)
    except InputError as error:
        report = error.report
    if not fix:
        return report, None
    from irc.cli.repair import repair_file

    return repair_file(file, report.located())


def _as_json(checked: Sequence[tuple[str, Report, Report | None]]) -> dict[str, Any]:
    if len(checked) == 1:
        ((_, report, fixed),) = checked
        return _one_as_json(report, fixed)
    return {
        "irc_diagnostics": DIAGNOSTICS_VERSION,
        "ok": all(report.ok for _, report, _ in checked),
        "files": [{"file": file, **_one_as_json(report, fixed)} for file, report, fixed in checked],
    }


def _one_as_json(report: Report, fixed: Report | None) -> dict[str, Any]:
    shown = report.to_dict()
    return shown if fixed is None else {**shown, "fixed": fixed.to_list()}


def _print(file: str, report: Report, fixed: Report | None, *, many: bool) -> None:
    text = report.render()
    if text:
        put(text)
    for d in fixed or ():
        changed = change_text(d.fix, d.edits)
        put(f"fixed[{d.code.id}]: {file}:{d.line}:{d.column}: {d.message}; {changed}")
    said = summary(report) or "no problems found"
    put(f"{file}: {said}" if many else said)
