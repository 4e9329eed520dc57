"""Turns rows into a data frame of an installed library; none is required."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from fractions import Fraction
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from irc.errors import LibraryMissing, OptionError

LIBRARIES = ("pandas", "polars")


def to_frame(
    columns: Sequence[str], rows: Sequence[Mapping[str, Any]], library: str | None = None
) -> Any:
    """A `DataFrame` with these columns.

    `library` is "pandas" or "polars"; without it, the one that is already imported, else the first
    one that is installed. A column with fractions becomes one of floats. Raises `LibraryMissing`
    where there is none, and `OptionError` for another library.
    """
    frames = import_module(_chosen(library))
    return frames.DataFrame({name: _column([row[name] for row in rows]) for name in columns})


def _chosen(library: str | None) -> str:
    if library is None:
        known = [*(name for name in LIBRARIES if name in sys.modules), *LIBRARIES]
        library = next((name for name in known if _is_installed(name)), None)
        if library is None:
            raise LibraryMissing(
                "a data frame needs pandas or polars: `pip install pandas` or `pip install polars`;"
                " `to_rows()` needs neither"
            )
        return library
    if library not in LIBRARIES:
        raise OptionError(f"library must be one of {', '.join(LIBRARIES)}, not {library!r}")
    if not _is_installed(library):
        raise LibraryMissing(f"{library} is not installed: `pip install {library}`")
    return library


def _is_installed(library: str) -> bool:
    return library in sys.modules or find_spec(library) is not None


def _column(values: list[Any]) -> list[Any]:
    """The values of a column, with one type for all its numbers."""
    if any(isinstance(value, Fraction) for value in values):
        return [float(value) if isinstance(value, (int, Fraction)) else value for value in values]
    return values
