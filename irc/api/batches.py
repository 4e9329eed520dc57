"""`irc.batch`: many tasks for several targets and engines."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from irc.batches.batch import Batch, BatchOptions
from irc.batches.inputs import AnyInput, InputOptions
from irc.batches.trial import AUTO, TrialOptions
from irc.model import Task
from irc.targets import Cancellation


def batch(
    tasks: AnyInput | Iterable[AnyInput],
    targets: Sequence[str] = ("cpsat",),
    engines: Sequence[str] = (AUTO,),
    *,
    source: str = "irc",
    domain: str | None = None,
    output: str | Path | None = None,
    again: Sequence[str] = (),
    processes: int | None = None,
    scheduler: str | None = None,
    finish_locally: bool = True,
    time_limit: float | None = 60.0,
    memory_limit: int | None = None,
    workers: int = 1,
    seed: int = 0,
    shortcut: bool = True,
    schedules: bool = False,
    cancel: Cancellation | None = None,
) -> Batch:
    """The results of every task for each target and each engine that it has, as they come.

    `tasks` are tasks, documents, or names of files, folders, patterns and files of JSON lines in
    the format `source` (as `irc convert --from`). They are solved by `processes` worker processes,
    one for each core by default, or on the Dask cluster of `scheduler`. With `output` each result
    is also a line of that file, and what has a result there is not solved again, but for the
    statuses of `again`. The other options are those of `solve`, for each trial.

    A faulty task is a result, not an exception. Raises `InputError` where a folder or pattern has
    no file, `UnknownTarget`, `EngineMissing`, `OptionError`, and `irc.IrcError` where the file
    cannot be written or the cluster cannot be used.
    """
    single = isinstance(tasks, (str, Path, Mapping, Task)) or hasattr(tasks, "ir")
    options = BatchOptions(
        targets,
        engines,
        InputOptions(source, domain),
        TrialOptions(time_limit, memory_limit, workers, seed, shortcut),
        processes,
        scheduler,
        finish_locally,
        None if output is None else Path(output),
        again,
        schedules,
        cancel,
        lambda text: warnings.warn(text, RuntimeWarning, stacklevel=2),
    )
    return Batch([tasks] if single else tasks, options)  # type: ignore[list-item,arg-type]
