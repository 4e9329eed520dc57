"""Loads ortools' module of CP-SAT; without pandas, where nobody can notice.

`ortools.sat.python.cp_model` imports pandas for the few of its methods that take or return series
of variables. irc uses none of them, and loading pandas takes longer than to prove many a small task
the best. So where this program has a single thread, which cannot import pandas in the meantime, it
is put off until one of these methods is called. Otherwise everything is loaded as usual.
"""

from __future__ import annotations

import sys
import threading
from importlib import import_module
from types import ModuleType
from typing import Any

CP_MODEL = "ortools.sat.python.cp_model"
PANDAS = "pandas"


def load_cp_model() -> None:
    """Imports CP-SAT's module, if it is not imported already."""
    if CP_MODEL in sys.modules:
        return
    alone = threading.active_count() == 1
    if PANDAS in sys.modules or not alone or not _without_pandas():
        import_module(CP_MODEL)


def _without_pandas() -> bool:
    """Whether the module could be imported so; an ortools that needs pandas at once fails."""
    sys.modules[PANDAS] = _Names(PANDAS)
    try:
        loaded = import_module(CP_MODEL)
    except (AttributeError, TypeError, ImportError):
        return False
    finally:
        del sys.modules[PANDAS]
    loaded.__dict__["pd"] = _Late(PANDAS)
    return True


class _Names(ModuleType):
    """Has an empty class for each name: enough for the annotations of a module."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


class _Late(ModuleType):
    """A module that is loaded when one of its names is looked up."""

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module(self.__name__), name)
