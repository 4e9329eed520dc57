"""Ends a competitor when it has had its processor time, whatever the clock on the wall says."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

_LOOK_SECONDS = 0.02


def when_spent(processor_seconds: float, end: Callable[[], object]) -> None:
    """Calls `end` once this process has used that much; 0: never. It returns at once."""

    def watch() -> None:
        while time.process_time() < processor_seconds:
            time.sleep(_LOOK_SECONDS)
        end()

    if processor_seconds > 0:
        threading.Thread(target=watch, name="processor time", daemon=True).start()
