"""The exit statuses of the `irc` command, as the README documents them.

A command that a signal ended has 128 + its number: 130 for ^C, 143 for SIGTERM.
"""

from __future__ import annotations

EXIT_DONE = 0
EXIT_INPUT = 1
EXIT_USE = 2
EXIT_NO_ANSWER = 3
EXIT_ENGINE = 4
