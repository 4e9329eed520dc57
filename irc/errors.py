"""The base of all exceptions of irc."""

from __future__ import annotations

from typing import Any, TypeVar

_Error = TypeVar("_Error", bound="IrcError")


class IrcError(Exception):
    """The base of every exception that irc raises for a reason of its own.

    Whatever else an exception carries, it can be pickled, so that it comes back whole from another
    process.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        # Exception's own way calls the class with `args`, which are not those of our classes.
        return _remade, (type(self), self.args, self.__dict__)


def _remade(kind: type[_Error], args: tuple[Any, ...], contents: dict[str, Any]) -> _Error:
    """An exception with these contents, made without its constructor."""
    error = kind.__new__(kind)
    error.args = args
    error.__dict__.update(contents)
    return error


class OptionError(IrcError, ValueError):
    """An option with a value that it cannot have; the text says what to write."""


class NameNotFound(IrcError, KeyError):
    """Nothing goes by this name; the text says which name is close."""

    def __str__(self) -> str:
        # KeyError would put the text into quotes.
        return str(self.args[0])


class LibraryMissing(IrcError, ImportError):
    """A library that irc does not need by itself is not installed; the text says which."""
