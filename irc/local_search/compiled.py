"""Compiles the inner loops of searches just in time, where numba is installed.

The same functions run without numba, some hundred times slower. They work on `Ints`, use only
indexes and whole numbers, and draw random numbers by themselves, so that both give the same.

numba keeps what it has compiled beside the module, or in the user's cache folder
(`NUMBA_CACHE_DIR`); where neither can be written it compiles in every process anew. It notices a
change of the module that a function is in, but not of others: so no compiled function calls one of
another module.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from irc.local_search.arrays import Ints as Ints
from irc.local_search.arrays import constant as constant
from irc.local_search.arrays import ints as ints
from irc.local_search.arrays import table as table

Function = TypeVar("Function", bound=Callable[..., Any])


def _numba() -> Any:
    try:
        import numba
    except ImportError:  # Not installed, or not for the installed numpy.
        return None
    return None if getattr(numba.config, "DISABLE_JIT", False) else numba


_NUMBA = _numba()

IS_COMPILED: bool = _NUMBA is not None
"""Whether loops are compiled."""


def compiled(function: Function) -> Function:
    """The function, compiled when it is first called, if numba is installed."""
    if _NUMBA is None:
        return function
    try:
        return _NUMBA.njit(nogil=True, cache=True)(function)  # type: ignore[no-any-return]
    except RuntimeError:  # There is no folder to keep it in.
        return _NUMBA.njit(nogil=True)(function)  # type: ignore[no-any-return]


MOST_LOOPS = 60
"""More than there are compiled functions in a module."""


def kept_or_not(call: Callable[..., Any], *args: Any) -> Any:
    """The result of a compiled function, also where what it compiles cannot be kept.

    numba has compiled a function, and will not do so again, when it fails to write it to a file: on
    a full disk, or where the folder is gone. So each try gets at least one function further.
    """
    for _ in range(MOST_LOOPS):
        try:
            return call(*args)
        except OSError:
            continue
    return call(*args)
