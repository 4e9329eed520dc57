"""Solves one task on a cluster."""

from __future__ import annotations

from dataclasses import replace

from irc.cluster.race import ClusterEngine
from irc.driver.judge import Answer
from irc.driver.solve import solve_by
from irc.errors import OptionError
from irc.model import Task
from irc.schedule import Status
from irc.targets import Budget, SolveOptions, get_backend
from irc.targets.interrupt import ended_by_interrupt, lost


def solve_on_cluster(
    task: Task, scheduler: str, options: SolveOptions, budget: Budget | None = None
) -> Answer:
    """The best answer of a race on the workers of a Dask scheduler, such as "tcp://10.0.0.5:8786".

    Checks, compiling, re-timing and validation are done in this process. `workers` is the most
    threads of a racer. Raises `OptionError` for a deterministic call, `LibraryMissing` without the
    extra `cluster`, `irc.cluster.connecting.ClusterError` where the cluster cannot be used, and
    what `irc.driver.solve.solve_task` raises.
    """
    if options.deterministic:
        raise OptionError("a race on a cluster cannot be deterministic: it depends on the clock")
    backend = get_backend(options.target)
    engine = ClusterEngine(scheduler, backend.engine(options.engine))
    with ended_by_interrupt(options.cancel) as cancel:
        own = budget or replace(options, cancel=cancel).budget()
        answer = solve_by(task, backend, engine, replace(options, cancel=own.cancel), own)
        if answer.schedule.status is Status.UNKNOWN:
            lost(cancel)
    return answer
