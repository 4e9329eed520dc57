"""Tests in several processes of which some need the machine for themselves."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from paths import TESTS

if sys.platform != "win32":
    import fcntl

# Files that are there anyway; nothing is written into them.
GATE, ROOM = TESTS / "exclusive.py", TESTS / "conftest.py"


@contextmanager
def machine(*, alone: bool) -> Iterator[None]:
    """Holds the machine together with other processes of the test run, or alone.

    Each waits for its turn at the gate first. Who is to be alone waits there until the others have
    left the room, and keeps those that come later outside: so nobody waits for ever.
    """
    if "PYTEST_XDIST_WORKER" not in os.environ or sys.platform == "win32":
        yield
        return
    with GATE.open() as gate, ROOM.open() as room:
        fcntl.flock(gate, fcntl.LOCK_EX)
        fcntl.flock(room, fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
        fcntl.flock(gate, fcntl.LOCK_UN)
        try:
            yield
        finally:
            # Said aloud: a process that was forked meanwhile has the file open too.
            fcntl.flock(room, fcntl.LOCK_UN)
