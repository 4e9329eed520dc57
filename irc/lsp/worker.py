"""The analysis worker: one thread that reads and checks texts, so that the protocol never waits.

Each state of a text is analysed once for all requests. A state that is outdated before its turn is
not analysed. Only the worker runs the compiler's code.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from typing import TypeVar

from irc.lsp.analysis import Analysis, analyse
from irc.lsp.documents import Document, Documents
from irc.lsp.hover import Descriptions
from irc.lsp.names import Names, names_of

T = TypeVar("T")


class AnalysedDocument:
    """A state of a text with its analysis, which the worker makes on the first request."""

    def __init__(self, document: Document) -> None:
        self.document = document

    @cached_property
    def analysis(self) -> Analysis:
        """The analysis of the text."""
        document = self.document
        return analyse(document.text, document.name, document.path)

    @cached_property
    def names(self) -> Names:
        """The names in the text, with their places."""
        return names_of(self.analysis)

    @cached_property
    def descriptions(self) -> Descriptions:
        """The descriptions of the names."""
        return Descriptions(self.analysis, self.names)


class AnalysisWorker:
    """Answers questions about documents, one at a time."""

    def __init__(self, documents: Documents) -> None:
        self.documents = documents
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="irc-check")
        self._analysed: dict[str, AnalysedDocument] = {}

    async def ask(self, uri: str, question: Callable[[AnalysedDocument], T]) -> T | None:
        """The answer about the present state of a document; None if it is not open, or if it was
        changed or closed before its turn."""
        document = self.documents.get(uri)
        if document is None:
            return None
        analysed = self._analysed.get(uri)
        if analysed is None or analysed.document is not document:
            analysed = self._analysed[uri] = AnalysedDocument(document)

        def work(of: AnalysedDocument = analysed) -> T | None:
            return question(of) if self.documents.is_current(of.document) else None

        # A request that is cancelled leaves the queue if it is still in it.
        return await asyncio.get_running_loop().run_in_executor(self._worker, work)

    def forget(self, uri: str) -> None:
        """Drops the analysis of a text that was closed, or that may include a changed file."""
        self._analysed.pop(uri, None)
