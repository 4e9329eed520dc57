"""`irc lsp`: the language server, if the extra `lsp` is installed."""

from __future__ import annotations

import gc
import os
import signal
from importlib.util import find_spec

from irc.cli.exit_codes import EXIT_ENGINE
from irc.cli.output import Format, fail


def run_server() -> None:
    """Serves an editor over standard input and output until the editor ends."""
    if find_spec("pygls") is None:
        fail(
            EXIT_ENGINE,
            "the language server needs the extra `lsp`: pip install 'irc-compiler[lsp]'",
            Format.text,
        )
    # Other commands end before garbage matters; this one goes on.
    gc.set_threshold(20_000, 10, 10)
    # There is nothing to clean up, and a thread that waits for input cannot be woken.
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, lambda number, _frame: os._exit(128 + number))
    from irc.lsp.server import serve_standard_streams

    serve_standard_streams()
