"""The answers to the editor's requests, without the protocol's transport."""

from __future__ import annotations

from collections.abc import Sequence

from lsprotocol import types

from irc.lsp import convert
from irc.lsp.complete_dsl import complete_dsl
from irc.lsp.complete_json import complete_json
from irc.lsp.definition import definitions, pool_at
from irc.lsp.findings import Shown, shown
from irc.lsp.hover import Mark, about_code, about_pool, code, plain
from irc.lsp.layout import layout_edit
from irc.lsp.outline import outline
from irc.lsp.repairs import all_certain, repairs
from irc.lsp.worker import AnalysedDocument, AnalysisWorker


class Service:
    """The answers about open documents; the worker makes them."""

    def __init__(self, worker: AnalysisWorker) -> None:
        self.worker = worker
        self.markdown = False
        """Whether the editor shows Markdown."""

    async def diagnostics(self, uri: str) -> types.PublishDiagnosticsParams | None:
        """All findings of the present state of a document; None if it has changed meanwhile."""

        def find(analysed: AnalysedDocument) -> types.PublishDiagnosticsParams:
            document = analysed.document
            found = [
                convert.diagnostic(one, document) for one in shown(analysed.analysis, document.text)
            ]
            return types.PublishDiagnosticsParams(document.uri, found, document.version)

        return await self.worker.ask(uri, find)

    async def completion(self, uri: str, at: types.Position) -> types.CompletionList | None:
        """The suggestions at a position."""

        def find(analysed: AnalysedDocument) -> types.CompletionList:
            document = analysed.document
            lines, path = document.lines, document.path
            offset = lines.offset(at.line, at.character)
            language = analysed.analysis.language
            if language == "json":
                offered = complete_json(lines.text, offset)
            elif language == "dsl":
                offered = complete_dsl(lines.text, offset, analysed.names, path)
            else:
                offered = []
            items = [convert.item(one, lines) for one in offered]
            return types.CompletionList(is_incomplete=False, items=items)

        return await self.worker.ask(uri, find)

    async def hover(self, uri: str, at: types.Position) -> types.Hover | None:
        """The description of a position: the name there, and the findings there."""
        mark: Mark = code if self.markdown else plain
        kind = types.MarkupKind.Markdown if self.markdown else types.MarkupKind.PlainText

        def find(analysed: AnalysedDocument) -> types.Hover | None:
            document = analysed.document
            offset = document.lines.offset(at.line, at.character)
            lead = analysed.analysis.lead
            found = _named(analysed, offset - lead, mark)
            findings = {d.of.code: d for d in _at(analysed, offset, offset) if d.of is not None}
            paragraphs, place = found if found is not None else ([], None)
            for code_ in findings:
                paragraphs += ["---"] * bool(paragraphs) + about_code(code_)
            if not paragraphs:
                return None
            if place is None:
                first = next(iter(findings.values()))
                place = (first.start - lead, first.end - lead)
            start, end = (edge + lead for edge in place)
            return convert.hover(paragraphs, convert.stretch(document.lines, start, end), kind)

        return await self.worker.ask(uri, find)

    async def definition(self, uri: str, at: types.Position) -> list[types.Location] | None:
        """The declarations of the name at a position."""

        def find(analysed: AnalysedDocument) -> list[types.Location]:
            document, lead = analysed.document, analysed.analysis.lead
            offset = document.lines.offset(at.line, at.character) - lead
            spots = definitions(analysed.analysis, analysed.names, offset, document.path)
            return [convert.location(spot, document, lead) for spot in spots]

        return await self.worker.ask(uri, find)

    async def symbols(self, uri: str) -> list[types.DocumentSymbol] | None:
        """The declarations of a document."""

        def find(analysed: AnalysedDocument) -> list[types.DocumentSymbol]:
            lines, lead = analysed.document.lines, analysed.analysis.lead
            entries = outline(analysed.analysis, analysed.names)
            return [convert.symbol(entry, lines, lead) for entry in entries]

        return await self.worker.ask(uri, find)

    async def formatting(self, uri: str) -> list[types.TextEdit] | None:
        """The edits that format a document."""

        def find(analysed: AnalysedDocument) -> list[types.TextEdit]:
            document = analysed.document
            made = layout_edit(document.text, document.name)
            return [] if made is None else [convert.edit(document.lines, made)]

        return await self.worker.ask(uri, find)

    async def code_actions(
        self, uri: str, around: types.Range, only: Sequence[str] | None
    ) -> list[types.CodeAction] | None:
        """The repairs of the findings in a range, and of all at once."""

        def find(analysed: AnalysedDocument) -> list[types.CodeAction]:
            document, analysis = analysed.document, analysed.analysis
            lines = document.lines
            start = lines.offset(around.start.line, around.start.character)
            end = lines.offset(around.end.line, around.end.character)
            found = []
            if _wanted(types.CodeActionKind.QuickFix, only):
                for one in _at(analysed, start, end):
                    offered = repairs(analysis, analysed.names, [one.of] if one.of else [])
                    of = [convert.diagnostic(one, document)]
                    found += [convert.action(repair, document, of) for repair in offered]
            if _wanted(types.CodeActionKind.SourceFixAll, only):
                whole = all_certain(analysis)
                found += [] if whole is None else [convert.action(whole, document, [])]
            return found

        return await self.worker.ask(uri, find)


def _at(analysed: AnalysedDocument, start: int, end: int) -> list[Shown]:
    """The findings that touch a span of the text."""
    found = shown(analysed.analysis, analysed.document.text)
    return [one for one in found if one.start <= end and start <= one.end]


def _wanted(kind: types.CodeActionKind, only: Sequence[str] | None) -> bool:
    """Whether the editor wants actions of a kind: "source" includes "source.fixAll"."""
    return only is None or any(f"{kind.value}.".startswith(f"{one}.") for one in only)


def _named(
    analysed: AnalysedDocument, offset: int, mark: Mark
) -> tuple[list[str], tuple[int, int]] | None:
    """(the paragraphs about the name at an offset of the source, its place)."""
    source = analysed.analysis.source
    if source is None:
        return None
    there = analysed.names.at(offset)
    if analysed.analysis.language == "dsl" and not (there and any(m.declares for m in there[0])):
        found = pool_at(source, offset, analysed.document.path)
        named = None if there is None else source.text[there[1].start : there[1].end]
        if found is not None and (named is None or named.strip('"') == found[0].pool.name):
            pool = found[0]
            place = there[1][:2] if there is not None else (pool.pool.start, pool.pool.end)
            if there is None and not pool.pool.start <= offset <= pool.pool.end:
                return None
            return about_pool(pool.pool.name, [m.name for m in pool.members], mark), place
    if there is None:
        return None
    mentioned, spot = there
    paragraphs = analysed.descriptions.about(mentioned[0], mark)
    if len({m.name for m in mentioned}) > 1:
        paragraphs.append(f"and {len({m.name for m in mentioned}) - 1} more of this statement")
    return paragraphs, (spot.start, spot.end)
