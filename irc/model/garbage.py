"""Leaves Python's search for garbage for later, while many objects are made that all stay."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_garbage() -> Iterator[None]:
    """A context in which Python does not search for garbage.

    The search goes through all objects made so far, again and again; for a task of many thousand
    actions it takes more than half of the time. Where several threads are in such a context, the
    first that leaves it switches the search on again: that costs time and nothing else.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()
