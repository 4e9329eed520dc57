"""`irc mcp`: the server for agents, if the extra `mcp` is installed."""

from __future__ import annotations

import gc
from importlib.util import find_spec

from irc.cli.exit_codes import EXIT_ENGINE
from irc.cli.output import Format, fail


def run_server() -> None:
    """Serves an agent over standard input and output until it goes away."""
    if find_spec("mcp") is None:
        message = "the server for agents needs the extra `mcp`: pip install 'irc-compiler[mcp]'"
        fail(EXIT_ENGINE, message, Format.text)
    # Other commands end before garbage matters; this one goes on.
    gc.set_threshold(20_000, 10, 10)
    from irc.mcp.server import serve_standard_streams

    serve_standard_streams()
