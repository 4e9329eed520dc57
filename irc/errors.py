"""The base of all exceptions of irc."""

from __future__ import annotations

from typing import Any, ClassVar, TypeVar

from irc.outcome import FAULTY, MISSING, MISUSED, Outcome

_Error = TypeVar("_Error", bound="IrcError")


class IrcError(Exception):
    """The base of every exception that irc raises.

    An exception with all its contents can be pickled, so that another process can return it.
    """

    ends_as: ClassVar[str] = FAULTY
    """The status of the outcome of a call that raises this."""

    @property
    def outcome(self) -> Outcome:
        """How the call ended, in the form that every result has."""
        return Outcome.of(self.ends_as, message=str(self))

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
    """An option has a value that is not allowed; the text says what to write."""

    ends_as = MISUSED


class NameNotFound(IrcError, KeyError):
    """There is no element of this name; the text names a close one."""

    def __str__(self) -> str:
        # KeyError would put the text into quotes.
        return str(self.args[0])


class LibraryMissing(IrcError, ImportError):
    """An optional library is not installed; the text names it."""

    ends_as = MISSING
