"""^C during a call: the call ends with the best answer so far, instead of losing it.

Python runs signal handlers in the main thread, and only between two steps of its own. So an engine
that computes outside of Python runs in a thread of its own while the caller waits, and all that
plans looks at its budget again and again.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from irc.targets.budget import Cancellation


@contextmanager
def ended_by_interrupt(outer: Cancellation | None) -> Iterator[Cancellation | None]:
    """The cancellation of a call, which ^C cancels too; a second ^C raises `KeyboardInterrupt`.

    `outer` is the one that the caller gave, which alone counts where ^C is not Python's own matter:
    in another thread, or where the program has a handler of its own. A call that ^C has left
    without any answer raises `KeyboardInterrupt` at its end: see `lost`.
    """
    if (
        threading.current_thread() is not threading.main_thread()
        or signal.getsignal(signal.SIGINT) is not signal.default_int_handler
    ):
        yield outer
        return
    own = _Interrupt(outer)
    before = signal.signal(signal.SIGINT, own.arrived)
    try:
        yield own
    finally:
        signal.signal(signal.SIGINT, before)


def lost(cancel: Cancellation | None) -> None:
    """Raises `KeyboardInterrupt` where ^C ended a call that has no answer to give."""
    if isinstance(cancel, _Interrupt) and cancel.has_arrived:
        raise KeyboardInterrupt


class _Interrupt(Cancellation):
    """A cancellation that is the handler of a signal."""

    __slots__ = ("has_arrived",)

    def __init__(self, outer: Cancellation | None) -> None:
        super().__init__(outer)
        self.has_arrived = False

    def arrived(self, _number: int, _frame: FrameType | None) -> None:
        if self.has_arrived:
            raise KeyboardInterrupt
        self.has_arrived = True
        self.cancel()
