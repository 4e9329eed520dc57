"""^C and SIGTERM: the first ends a command with the best answer so far, the second at once.

While a command plans, the first signal cancels the planning, and the command shows and writes what
it has. At any other time (reading, checking, waiting for input) there is nothing to save, and the
command ends where it is. Either way its exit status is 128 + the number of the signal, or 0 where
that signal is the usual end of the command.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from irc.targets import Cancellation

PATIENCE_SECONDS = 0.6
"""Planning that has not noticed by then that it is to end has no answer yet, and ends without."""


AGAIN_SECONDS = 0.5
"""A command that still has not ended by then is ended once more."""


class Interrupted(BaseException):
    """The command ends here. (Not an `Exception`: nothing on the way is to catch it.)"""

    def __init__(self, status: int) -> None:
        super().__init__(status)
        self.status = status


class Interruption:
    """The signals that this process has got, and what they are to do."""

    def __init__(self) -> None:
        self.number: int | None = None
        self.usual: int | None = None
        self.has_ended = False
        self.has_planned = False
        self.cancellation: Cancellation | None = None
        self._is_installed = False
        self._is_planning = False

    def install(self) -> None:
        """Handles ^C and SIGTERM from now on, until the process ends."""
        self._is_installed = True
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._arrived)
        if hasattr(signal, "SIGALRM"):
            signal.signal(signal.SIGALRM, self._waited)

    def end(self) -> None:
        """Nothing is left to interrupt: a signal that comes now must not change how it ended."""
        if self._is_installed:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
        self._wait(0)

    def _wait(self, seconds: float) -> None:
        if hasattr(signal, "setitimer") and self._is_installed:
            signal.setitimer(signal.ITIMER_REAL, seconds)

    @property
    def status(self) -> int | None:
        """The exit status of a command that was interrupted; None if it was not."""
        if self.number is None:
            return None
        return 0 if self.number == self.usual else 128 + self.number

    def spent(self, *inputs: str | None) -> float:
        """The seconds that the command has taken so far; 0 where it is not a process of its own.

        Where standard input is one of the inputs, the wait for it does not count.
        """
        from irc.targets.budget import seconds_since_start

        return seconds_since_start(waited="-" in inputs) if self._is_installed else 0.0

    @contextmanager
    def planning(self, cancellation: Cancellation | None = None) -> Iterator[Cancellation]:
        """Planning and showing, which the first signal ends with the best answer so far."""
        from irc.targets import Cancellation

        self.cancellation = cancellation or Cancellation()
        self._is_planning = self.has_planned = True
        try:
            yield self.cancellation
        finally:
            self._is_planning = False

    def _arrived(self, number: int, _frame: FrameType | None) -> None:
        first, self.number = self.number is None, self.number or number
        if not (first and self._is_planning) or self.cancellation is None:
            self._end_here()
        self.cancellation.cancel()
        self._wait(PATIENCE_SECONDS)

    def _waited(self, _number: int, _frame: FrameType | None) -> None:
        cancellation = self.cancellation
        noticed = self._is_planning and cancellation is not None and cancellation.will_answer
        if self.has_ended or not noticed:
            self._end_here()

    def _end_here(self) -> NoReturn:
        # (Code that Python runs on its own account swallows what is raised in it, and a library
        # that is being loaded may turn it into another error: so it is raised until it arrives.)
        self.has_ended = True
        self._wait(AGAIN_SECONDS)
        raise Interrupted(self.status or 0)


INTERRUPTION = Interruption()
"""The signals of this process."""
