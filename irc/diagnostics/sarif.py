"""Reports as SARIF 2.1.0, which editors, code hosts and CI systems show beside the source lines.

Source: "Static Analysis Results Interchange Format (SARIF) Version 2.1.0", OASIS Standard, 2020.
Section numbers below are those of the standard.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from irc._version import __version__
from irc.diagnostics.catalogue import CatalogueEntry, load_catalogue
from irc.diagnostics.finding import Code, Diagnostic, Severity
from irc.diagnostics.fix import TextEdit
from irc.diagnostics.patching import text_edits
from irc.diagnostics.report import Report
from irc.diagnostics.source import Source, pointer_text

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)

_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "note"}


def sarif_log(reports: Sequence[tuple[str, Report]]) -> dict[str, Any]:
    """The SARIF log of one run of irc over some files, each given with its report."""
    located = [(file, report.located()) for file, report in reports]
    names = dict.fromkeys(
        name
        for file, report in located
        for name in (file, *(d.within.name for d in report if d.within is not None))
    )
    codes = sorted({d.code for _, report in located for d in report}, key=lambda code: code.id)
    entries = load_catalogue()
    index = {code: k for k, code in enumerate(codes)}
    results = [_result(d, file, report.source, index) for file, report in located for d in report]
    return {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {
                        "name": "irc",
                        "version": __version__,
                        "semanticVersion": __version__,
                        "informationUri": "https://pypi.org/project/irc-compiler/",
                        "rules": [_rule(entries[code.id], code) for code in codes],
                    }
                },
                # Python counts characters, not UTF-16 code units (3.14.17).
                "columnKind": "unicodeCodePoints",
                "artifacts": [{"location": {"uri": _uri(file)}} for file in names],
                "results": results,
            }
        ],
    }


def _rule(entry: CatalogueEntry, code: Code) -> dict[str, Any]:
    """The catalogue's entry of a code as a reporting descriptor (3.49)."""
    return {
        "id": code.id,
        "name": "".join(word.capitalize() for word in code.name.split("_")),
        "shortDescription": {"text": f"{code.summary[0].upper()}{code.summary[1:]}."},
        "fullDescription": {"text": entry.explanation},
        "help": {"text": f"What to do: {entry.remedy}."},
        "defaultConfiguration": {"level": _LEVELS[code.severity]},
    }


def _result(
    d: Diagnostic, file: str, source: Source | None, index: dict[Code, int]
) -> dict[str, Any]:
    if d.within is not None:
        file, source = d.within.name, d.within
    text = d.message if d.hint is None else f"{d.message}\n{d.hint}"
    result: dict[str, Any] = {
        "ruleId": d.code.id,
        "ruleIndex": index[d.code],
        "level": _LEVELS[d.severity],
        "message": {"text": text},
        "locations": [_location(d, file, source)],
    }
    edits = [] if source is None else text_edits([d], source)
    if source is not None and edits:
        result["fixes"] = [_fix(d, edits, file, source)]
    return result


def _location(d: Diagnostic, file: str, source: Source | None) -> dict[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(file)}}
    if source is not None and d.offset is not None:
        # A place at the very end of the text has no character of its own.
        end = d.end if d.end is not None and d.end > d.offset else d.offset + 1
        end = min(end, len(source.text))
        if "\n" in source.text[d.offset : end]:
            end = d.offset
        physical["region"] = _region(source, d.offset, end)
    location: dict[str, Any] = {"physicalLocation": physical}
    if d.pointer:
        path = pointer_text(d.pointer)
        location["logicalLocations"] = [{"fullyQualifiedName": path, "kind": "value"}]
    return location


def _region(source: Source, start: int, end: int) -> dict[str, int]:
    """Lines and columns from 1; the end column is that behind the last character (3.30)."""
    line, column = source.line_and_column(start)
    end_line, end_column = source.line_and_column(end)
    return {
        "startLine": line,
        "startColumn": column,
        "endLine": end_line,
        "endColumn": end_column,
    }


def _fix(d: Diagnostic, edits: list[TextEdit], file: str, source: Source) -> dict[str, Any]:
    return {
        "description": {"text": d.hint or d.message},
        "artifactChanges": [
            {
                "artifactLocation": {"uri": _uri(file)},
                "replacements": [
                    {
                        "deletedRegion": _region(source, edit.start, edit.end),
                        "insertedContent": {"text": edit.text},
                    }
                    for edit in edits
                ],
            }
        ],
    }


def _uri(file: str) -> str:
    """A relative path as a relative URI, an absolute one as a file URI (3.4.3)."""
    if file == "-":
        return "stdin"
    path = Path(file)
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())
