"""The exit statuses of the `irc` command, as the README documents them.

A command that a signal ended has 128 + its number: 130 for ^C, 143 for SIGTERM.
"""

from __future__ import annotations

EXIT_DONE = 0
EXIT_INPUT = 1
EXIT_USE = 2
EXIT_NO_ANSWER = 3
EXIT_ENGINE = 4

EXIT_STATUSES = (
    "Exit status: 0 done; 1 the input is at fault, or has no schedule; 2 wrong use; 3 no answer "
    "within the limits; 4 an engine is missing or failed; 130 (^C) or 143 (SIGTERM) interrupted, "
    "with the best answer so far."
)
"""The same in the help of each command."""
