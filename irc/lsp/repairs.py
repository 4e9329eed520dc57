"""Quick fixes: the certain repairs of a report, and the nearest known name for an unknown one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from irc.diagnostics import Code, Diagnostic
from irc.diagnostics.fix import TextEdit
from irc.diagnostics.patching import text_edits
from irc.diagnostics.suggest import closest
from irc.lsp.analysis import Analysis
from irc.lsp.names import Names


@dataclass(frozen=True)
class Repair:
    """Edits of the editor's text that repair one finding, or all findings if `of` is None."""

    title: str
    edits: tuple[TextEdit, ...]
    certain: bool
    of: Diagnostic | None = None


def repairs(analysis: Analysis, names: Names, found: Sequence[Diagnostic]) -> list[Repair]:
    """The repairs of some of a report's findings."""
    offered = []
    for d in found:
        if (d.fix or d.edits) and analysis.source is not None:
            edits = _moved(text_edits([d], analysis.source), analysis.lead)
            if edits:
                offered.append(Repair(f"repair: {d.message}", edits, True, d))
        elif d.code is Code.UNKNOWN_NAME:
            offered += _renamed(d, analysis, names)
    return offered


def all_certain(analysis: Analysis) -> Repair | None:
    """One repair for all findings that have a certain one."""
    if analysis.source is None:
        return None
    edits = _moved(text_edits(analysis.report, analysis.source), analysis.lead)
    return Repair("make all certain repairs", edits, True) if edits else None


def _moved(edits: Sequence[TextEdit], by: int) -> tuple[TextEdit, ...]:
    return tuple(TextEdit(e.start + by, e.end + by, e.text) for e in edits)


def _renamed(d: Diagnostic, analysis: Analysis, names: Names) -> list[Repair]:
    """The repair that writes the nearest known name for an unknown one: likely, not certain."""
    if d.offset is None or d.within is not None:
        return []
    there = names.at(d.offset)
    if there is None or there[1].start != d.offset:
        return []
    unknown = [
        m for m in there[0] if not m.declares and (m.kind, m.name, m.owner) not in names.declared
    ]
    if len({m.name for m in unknown}) != 1 or len(unknown) != len(there[0]):
        return []  # The place is in a repeated statement and stands for several names.
    mention, spot = unknown[0], there[1]
    near = closest(mention.name, names.known(mention.kind, mention.owner))
    if near is None:
        return []
    written = _written(near, analysis)
    edit = TextEdit(spot.start + analysis.lead, spot.end + analysis.lead, written)
    return [Repair(f"change to {written}", (edit,), False, d)]


def _written(name: str, analysis: Analysis) -> str:
    if analysis.language == "dsl":
        from irc.frontends.dsl.written import name as written_name

        return written_name(name)
    import json

    return json.dumps(name, ensure_ascii=False)
