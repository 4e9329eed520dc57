"""Converts the results of the other modules to the protocol's own types."""

from __future__ import annotations

from pathlib import Path

from lsprotocol import types

from irc.diagnostics.fix import TextEdit
from irc.lsp.documents import Document
from irc.lsp.findings import SEVERITIES, Shown
from irc.lsp.mentions import Kind
from irc.lsp.names import Spot
from irc.lsp.outline import OutlineEntry
from irc.lsp.positions import Lines
from irc.lsp.repairs import Repair
from irc.lsp.suggestions import Suggestion

_SYMBOLS = {
    Kind.ACTION: types.SymbolKind.Event,
    Kind.RESOURCE: types.SymbolKind.Object,
    Kind.VARIABLE: types.SymbolKind.Variable,
    Kind.VALUE: types.SymbolKind.EnumMember,
    Kind.GROUP: types.SymbolKind.Package,
}

_ITEMS = {
    Kind.ACTION: types.CompletionItemKind.Event,
    Kind.RESOURCE: types.CompletionItemKind.Module,
    Kind.VARIABLE: types.CompletionItemKind.Variable,
    Kind.VALUE: types.CompletionItemKind.EnumMember,
    Kind.GROUP: types.CompletionItemKind.Folder,
    "pool": types.CompletionItemKind.Class,
    "keyword": types.CompletionItemKind.Keyword,
    "field": types.CompletionItemKind.Property,
    "word": types.CompletionItemKind.Value,
    "file": types.CompletionItemKind.File,
}


def stretch(lines: Lines, start: int, end: int) -> types.Range:
    """The range of a span of a text."""
    return types.Range(
        types.Position(*lines.place(start)), types.Position(*lines.place(max(start, end)))
    )


def edit(lines: Lines, made: TextEdit) -> types.TextEdit:
    """An edit in the protocol's type."""
    return types.TextEdit(stretch(lines, made.start, made.end), made.text)


def location(spot: Spot, document: Document, lead: int) -> types.Location:
    """The location of a place in the document, or in a file that it includes."""
    if spot.within is None:
        place = stretch(document.lines, spot.start + lead, spot.end + lead)
        return types.Location(document.uri, place)
    lines = Lines(spot.within.text, document.lines.encoding)
    uri = Path(spot.within.name).absolute().as_uri()
    return types.Location(uri, stretch(lines, spot.start, spot.end))


def diagnostic(shown: Shown, document: Document) -> types.Diagnostic:
    """A finding in the protocol's type."""
    d = shown.of
    related = None
    if shown.elsewhere is not None and d is not None:
        there = location(shown.elsewhere, document, 0)
        related = [types.DiagnosticRelatedInformation(there, d.message)]
    return types.Diagnostic(
        stretch(document.lines, shown.start, shown.end),
        shown.message,
        types.DiagnosticSeverity(SEVERITIES[d.severity] if d is not None else 3),
        code=None if d is None else d.code.id,
        source="irc",
        related_information=related,
    )


def action(repair: Repair, document: Document, of: list[types.Diagnostic]) -> types.CodeAction:
    """A repair as a code action."""
    edits = [edit(document.lines, made) for made in repair.edits]
    whole = repair.of is None
    return types.CodeAction(
        repair.title,
        types.CodeActionKind.SourceFixAll if whole else types.CodeActionKind.QuickFix,
        diagnostics=of or None,
        is_preferred=None if whole else repair.certain,
        edit=types.WorkspaceEdit(changes={document.uri: edits}),
    )


def item(suggestion: Suggestion, lines: Lines) -> types.CompletionItem:
    """A suggestion as a completion item."""
    kind = suggestion.kind
    return types.CompletionItem(
        suggestion.label,
        kind=_ITEMS[kind],
        detail=kind,
        filter_text=suggestion.typed or suggestion.label,
        # Names before words of the language.
        sort_text=f"{int(kind in ('keyword', 'field', 'word'))}{suggestion.label}",
        text_edit=edit(lines, TextEdit(suggestion.start, suggestion.end, suggestion.text)),
    )


def symbol(entry: OutlineEntry, lines: Lines, lead: int) -> types.DocumentSymbol:
    """A declaration as a document symbol."""
    return types.DocumentSymbol(
        entry.name,
        _SYMBOLS[entry.kind],
        stretch(lines, entry.start + lead, entry.end + lead),
        stretch(lines, entry.name_start + lead, entry.name_end + lead),
        detail=entry.kind.value,
    )


def hover(paragraphs: list[str], place: types.Range, kind: types.MarkupKind) -> types.Hover:
    """The text that is shown over a place."""
    return types.Hover(types.MarkupContent(kind, "\n\n".join(paragraphs)), place)
