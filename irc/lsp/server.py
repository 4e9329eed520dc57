"""`irc lsp`: the protocol over standard input and output, by pygls."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol
from pygls.protocol.language_server import lsp_method
from pygls.uris import to_fs_path

from irc._version import __version__
from irc.lsp.documents import Change, Documents
from irc.lsp.positions import Encoding
from irc.lsp.service import Service
from irc.lsp.worker import AnalysisWorker

PAUSE_SECONDS = 0.02
"""The pause after a change before a text is checked, because keys may come in bursts."""


class Protocol(LanguageServerProtocol):
    """The protocol of pygls, but `Documents` keeps the texts instead of its own workspace.

    (The workspace splits lines at characters that are no line ends in the protocol.)
    """

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: types.DidOpenTextDocumentParams) -> Any:
        """Passes an opened text to irc's feature."""
        yield from self._to_ours(types.TEXT_DOCUMENT_DID_OPEN, params)

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: types.DidChangeTextDocumentParams) -> Any:
        """Passes changes to irc's feature."""
        yield from self._to_ours(types.TEXT_DOCUMENT_DID_CHANGE, params)

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: types.DidCloseTextDocumentParams) -> Any:
        """Passes the closing of a text to irc's feature."""
        yield from self._to_ours(types.TEXT_DOCUMENT_DID_CLOSE, params)

    def _to_ours(self, method: str, params: Any) -> Iterator[Any]:
        yield self.fm.features[method], (params,), None

    def structure_message(self, data: dict[str, Any]) -> Any:
        """A message in its type; a request without a known type is answered with an error."""
        try:
            return super().structure_message(data)
        except JsonRpcException as error:
            id = data.get("id")
            if isinstance(id, (int, str)) and "method" in data:
                self._send_response(id, error=error.to_response_error())
            raise


class Publisher:
    """Checks changed texts after a short pause and publishes the findings, unless outdated."""

    def __init__(self, server: LanguageServer, service: Service) -> None:
        self.server = server
        self.service = service
        self._due: set[str] = set()
        self._tasks: set[asyncio.Task[None]] = set()

    def changed(self, uri: str) -> None:
        """Plans a check of a text that was opened or changed. Changes within the pause are checked
        together; they do not delay the check, so it comes regularly while the user types."""
        if uri in self._due:
            return
        self._due.add(uri)
        task = asyncio.get_running_loop().create_task(self._publish(uri))
        self._tasks.add(task)
        task.add_done_callback(self._ended)

    async def _publish(self, uri: str) -> None:
        await asyncio.sleep(PAUSE_SECONDS)
        self._due.discard(uri)
        found = await self.service.diagnostics(uri)
        document = self.service.worker.documents.get(uri)
        if found is not None and document is not None and document.version == found.version:
            self.server.text_document_publish_diagnostics(found)

    def _ended(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        error = None if task.cancelled() else task.exception()
        if isinstance(error, Exception):
            self.server.report_server_error(error, JsonRpcException)


class Ending:
    """The end of the session, and whether the client announced it."""

    def __init__(self) -> None:
        self.status = 0
        self.announced = False


def build_server(ending: Ending) -> LanguageServer:
    """The server with all of its features."""
    documents = Documents()
    service = Service(AnalysisWorker(documents))
    server = LanguageServer("irc", __version__, protocol_cls=Protocol)
    publisher = Publisher(server, service)
    _follow_the_session(server, service, ending)
    _follow_texts(server, documents, service, publisher)
    _answer(server, service)
    return server


def _follow_the_session(server: LanguageServer, service: Service, ending: Ending) -> None:
    @server.feature(types.INITIALIZE)
    def initialize(params: types.InitializeParams) -> None:
        encoding = server.workspace.position_encoding or types.PositionEncodingKind.Utf16
        service.worker.documents.encoding = Encoding(
            encoding.value if isinstance(encoding, types.PositionEncodingKind) else encoding
        )
        text = params.capabilities.text_document
        formats = text.hover.content_format if text is not None and text.hover is not None else None
        service.markdown = types.MarkupKind.Markdown in (formats or ())

    @server.feature(types.SHUTDOWN)
    def shutdown(_params: Any) -> None:
        ending.announced = True

    @server.feature(types.EXIT)
    def exit_(_params: Any) -> None:
        ending.status = 0 if ending.announced else 1


def _follow_texts(
    server: LanguageServer, documents: Documents, service: Service, publisher: Publisher
) -> None:
    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: types.DidOpenTextDocumentParams) -> None:
        text = params.text_document
        documents.open(text.uri, text.version, text.text, _path(text.uri), text.language_id)
        publisher.changed(text.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(params: types.DidChangeTextDocumentParams) -> None:
        text = params.text_document
        if documents.change(text.uri, text.version, map(_change, params.content_changes)):
            publisher.changed(text.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: types.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        documents.close(uri)
        service.worker.forget(uri)
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def saved(params: types.DidSaveTextDocumentParams) -> None:
        # Included files are read from disk, so every other text may have other findings now.
        for document in documents:
            if document.uri != params.text_document.uri:
                service.worker.forget(document.uri)
                publisher.changed(document.uri)


def _answer(server: LanguageServer, service: Service) -> None:
    triggers = types.CompletionOptions(trigger_characters=[" ", '"', ",", "=", ":"])

    @server.feature(types.TEXT_DOCUMENT_COMPLETION, triggers)
    async def completion(params: types.CompletionParams) -> types.CompletionList | None:
        return await service.completion(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    async def hover(params: types.HoverParams) -> types.Hover | None:
        return await service.hover(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    async def definition(params: types.DefinitionParams) -> list[types.Location] | None:
        return await service.definition(params.text_document.uri, params.position)

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    async def symbols(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol] | None:
        return await service.symbols(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    async def formatting(params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
        return await service.formatting(params.text_document.uri)

    kinds = [types.CodeActionKind.QuickFix, types.CodeActionKind.SourceFixAll]

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions(kinds))
    async def code_actions(params: types.CodeActionParams) -> list[types.CodeAction] | None:
        only = None if params.context.only is None else [_kind(k) for k in params.context.only]
        return await service.code_actions(params.text_document.uri, params.range, only)


def _kind(kind: types.CodeActionKind | str) -> str:
    return kind.value if isinstance(kind, types.CodeActionKind) else kind


def _path(uri: str) -> Path | None:
    """The file of a URI, if it is one."""
    try:
        found = to_fs_path(uri) if uri.startswith("file:") else None
    except ValueError:
        return None
    return None if not found or "\x00" in found else Path(found)


def _change(event: types.TextDocumentContentChangeEvent) -> Change:
    if isinstance(event, types.TextDocumentContentChangePartial):
        start, end = event.range.start, event.range.end
        return Change(event.text, (start.line, start.character), (end.line, end.character))
    return Change(event.text)


def serve(stdin: BinaryIO, stdout: BinaryIO) -> int:
    """Serves until the client ends the session; returns the exit status of the protocol."""
    ending = Ending()
    build_server(ending).start_io(stdin, stdout)
    return ending.status


def serve_standard_streams() -> None:
    """Serves over standard input and output, and ends the process.

    Standard output is only for the protocol, so all other output goes to standard error. When the
    client has ended the session, a check that still runs is dropped.
    """
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    status = serve(sys.stdin.buffer, out)
    sys.stderr.flush()
    os._exit(status)
