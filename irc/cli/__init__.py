"""The command line: one module for each command's body; `irc.cli.app` declares them."""

from __future__ import annotations

import gc
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from irc.cli.exit_codes import EXIT_INPUT, EXIT_USE
from irc.cli.interruption import INTERRUPTION, Interrupted


def main() -> None:
    """Entry point of the `irc` script. Exits with one of the `EXIT_*` codes."""
    # A compiler builds large structures without cycles and ends: collecting garbage is useless.
    gc.set_threshold(10_000_000, 50, 100)
    # pydantic would search every installed distribution for plugins before the first model.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    INTERRUPTION.install()
    try:
        from irc.cli.app import build_app

        build_app(sys.argv[1] if len(sys.argv) > 1 else None)(default_map=_defaults())
    except Interrupted as interrupted:
        _leave(_interrupted(interrupted.status))
    except SystemExit as left:
        _leave(left.code if INTERRUPTION.status is None else INTERRUPTION.status)
    except BrokenPipeError:
        # The reader of the output has ended (`irc … | head`): there is no more to print.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        _leave(EXIT_INPUT)
    except Exception:
        if not INTERRUPTION.has_ended:
            raise
        _leave(_interrupted(INTERRUPTION.status or 0))


def _defaults() -> dict[str, dict[str, Any]] | None:
    """The defaults of options that a file of settings gives; None without one."""
    from irc.cli.defaults import defaults_for, settings_file
    from irc.errors import IrcError

    try:
        found = settings_file(Path.cwd())
        if found is None:
            return None
        from irc.cli.app import options_of_commands

        return defaults_for(found[1], options_of_commands(), found[0])
    except (IrcError, FileNotFoundError) as error:  # (The folder may be gone.)
        print(f"error: {error}", file=sys.stderr)
        sys.exit(EXIT_USE)


def _interrupted(status: int) -> int:
    print("interrupted", file=sys.stderr)
    return status


def _leave(status: object) -> NoReturn:
    """Exits; after planning at once, since Python takes its time to take solvers apart."""
    INTERRUPTION.end()
    if INTERRUPTION.has_planned and isinstance(status, int):
        with suppress(OSError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(status)
    sys.exit(status)  # type: ignore[arg-type]
