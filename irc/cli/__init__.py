"""The command line: one module for each command's body; `irc.cli.app` declares them."""

from __future__ import annotations

import gc
import os
import signal
import sys
from types import FrameType

from irc.cli.exit_codes import EXIT_INPUT


def main() -> None:
    """Entry point of the `irc` script. Exits with one of the `EXIT_*` codes."""
    # A compiler builds large structures without cycles and ends: collecting garbage is useless.
    gc.set_threshold(10_000_000, 50, 100)
    # pydantic would search every installed distribution for plugins before the first model.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from irc.cli.app import build_app

    # If another process ends irc, irc still ends the planners that it started.
    signal.signal(signal.SIGTERM, _terminated)
    try:
        build_app(sys.argv[1] if len(sys.argv) > 1 else None)()
    except BrokenPipeError:
        # The reader of the output has ended (`irc … | head`): there is no more to print.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(EXIT_INPUT)


def _terminated(number: int, _frame: FrameType | None) -> None:
    sys.exit(128 + number)
