"""The one worker that reads and checks texts, so that the protocol is never kept waiting.

A text is analysed once for each of its states, whoever asks; what is outdated before its turn
comes is not analysed at all. Only the worker runs the compiler's code.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from typing import TypeVar

from irc.lsp.analysis import Analysis, analyse
from irc.lsp.documents import Document, Documents
from irc.lsp.hover import Facts
from irc.lsp.names import Names, names_of

T = TypeVar("T")


class Known:
    """A state of a text and what is known of it: made by the worker, when first asked for."""

    def __init__(self, document: Document) -> None:
        self.document = document

    @cached_property
    def analysis(self) -> Analysis:
        """What was read and found."""
        document = self.document
        return analyse(document.text, document.name, document.path)

    @cached_property
    def names(self) -> Names:
        """Its names and where they stand."""
        return names_of(self.analysis)

    @cached_property
    def facts(self) -> Facts:
        """What there is to say about them."""
        return Facts(self.analysis, self.names)


class Desk:
    """Answers questions about documents, one at a time."""

    def __init__(self, documents: Documents) -> None:
        self.documents = documents
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="irc-check")
        self._known: dict[str, Known] = {}

    async def ask(self, uri: str, question: Callable[[Known], T]) -> T | None:
        """The answer about a document as it is now; None if it is not open, or changed or was
        closed before its turn came."""
        document = self.documents.get(uri)
        if document is None:
            return None
        known = self._known.get(uri)
        if known is None or known.document is not document:
            known = self._known[uri] = Known(document)

        def work(known: Known = known) -> T | None:
            return question(known) if self.documents.is_current(known.document) else None

        # A request that is cancelled leaves the queue if it is still in it.
        return await asyncio.get_running_loop().run_in_executor(self._worker, work)

    def forget(self, uri: str) -> None:
        """Lets go of what is known: the text was closed, or a file it includes was changed."""
        self._known.pop(uri, None)
