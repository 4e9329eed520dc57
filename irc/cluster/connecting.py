"""Connects to a Dask cluster whose workers have the same irc."""

from __future__ import annotations

import concurrent.futures
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from threading import Thread
from typing import TYPE_CHECKING, NoReturn

from irc._version import __version__
from irc.errors import IrcError, LibraryMissing
from irc.outcome import MISSING
from irc.targets import Budget, Cancellation

if TYPE_CHECKING:
    from distributed import Client

CONNECT_SECONDS = 10.0
"""How long the scheduler may take to answer, and its first worker to be there."""

POLL_SECONDS = 0.05
"""Between two looks at a cancellation."""

_WAITS = 3
"""To connect, to wait for a worker, and to ask the workers for their version."""

SOLVERS = ("ortools", "llvmlite")
"""Libraries that must be of the same version where processes exchange what they find."""


class ClusterError(IrcError):
    """The cluster cannot be used; the message says why."""

    ends_as = MISSING


def connected(
    scheduler: str, cancel: Cancellation, name: str, *, solvers: bool = False
) -> Client | None:
    """The connection to a scheduler that answers in time; None once cancelled.

    With `solvers` the workers must also have the same Python and solvers. Raises `LibraryMissing`
    without the extra `cluster`, and `ClusterError` where the scheduler cannot be reached, it has no
    worker, or one has no or another irc. The connection is made in a thread of its own: a scheduler
    that takes connections and then says nothing would keep this one waiting for ever.
    """
    try:
        import distributed  # noqa: F401 - here and not in the thread, because it is slow to load
    except ImportError:
        raise LibraryMissing(
            "a cluster needs dask.distributed: pip install 'irc-compiler[cluster]'"
        ) from None
    found: concurrent.futures.Future[Client] = concurrent.futures.Future()
    connect = (scheduler, name, _all_versions if solvers else _own_version, found)
    Thread(target=_connect, args=connect, name="irc-cluster", daemon=True).start()
    patience = Budget(CONNECT_SECONDS * _WAITS)
    while not cancel.is_cancelled:
        with suppress(concurrent.futures.TimeoutError):
            return found.result(POLL_SECONDS)
        if patience.is_over:
            found.add_done_callback(_close_late)
            _unreachable(scheduler, "it does not answer")
    found.add_done_callback(_close_late)
    return None


def close(client: Client, seconds: float = 1.0) -> None:
    """Closes a connection, which may be broken already."""
    with suppress(TimeoutError, OSError, RuntimeError):
        client.close(timeout=seconds)


def _unreachable(scheduler: str, reason: str) -> NoReturn:
    raise ClusterError(f"cannot reach the scheduler {scheduler!r}: {reason}")


Versions = Callable[[], Mapping[str, str]]


def _connect(
    scheduler: str, name: str, versions: Versions, found: concurrent.futures.Future[Client]
) -> None:
    try:
        found.set_result(_connected(scheduler, name, versions))
    except BaseException as error:  # noqa: BLE001 - it is raised where the connection is waited for
        found.set_exception(error)


def _close_late(found: concurrent.futures.Future[Client]) -> None:
    if found.exception() is None:
        close(found.result())


def _connected(scheduler: str, name: str, versions: Versions) -> Client:
    from distributed import Client

    try:
        client = Client(scheduler, timeout=CONNECT_SECONDS, set_as_default=False, name=name)
    except (OSError, ValueError, TypeError) as error:
        _unreachable(scheduler, str(error) or type(error).__name__)
    try:
        _require_workers(client, scheduler, versions)
    except BaseException:
        close(client)
        raise
    return client


def _require_workers(client: Client, scheduler: str, versions: Versions) -> None:
    """Raises `ClusterError` where there is no worker, or one without these versions."""
    try:
        client.wait_for_workers(1, timeout=CONNECT_SECONDS)
    except TimeoutError:
        message = f"the scheduler {scheduler!r} has no workers: start some with `dask worker`"
        raise ClusterError(message) from None
    ours = versions()
    try:
        found = client.run(versions, on_error="return")
    except Exception as error:  # noqa: BLE001 - whatever a worker raises that cannot load irc
        raise ClusterError(f"the workers of {scheduler!r} cannot load irc: {error}") from None
    for worker, theirs in found.items():
        if not isinstance(theirs, Mapping):
            raise ClusterError(f"worker {worker} cannot load irc: {theirs}")
        for what, own in ours.items():
            if (other := theirs.get(what)) != own:
                differs = f"worker {worker} has {what} {other}, and this is {own}"
                raise ClusterError(f"{differs}: install the same version")


def _own_version() -> Mapping[str, str]:
    return {"irc": __version__}


def _all_versions() -> Mapping[str, str]:
    """The versions of all that decides what a process finds."""
    python = ".".join(map(str, sys.version_info[:2]))
    return {"irc": __version__, "Python": python, **{name: _installed(name) for name in SOLVERS}}


def _installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "(none)"
