"""Solving in the background: a handle, an iterator of better and better schedules, and `async`."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from dataclasses import replace
from threading import Condition
from types import TracebackType
from typing import TYPE_CHECKING, NoReturn, Self, Unpack

from irc.api import calls
from irc.api.calls import AnyTask, ir_of
from irc.driver.running import Running, awaited
from irc.driver.solve import solve_task
from irc.model import Event
from irc.model.built import Built
from irc.model.quantities import Number
from irc.schedule import Schedule
from irc.targets import Cancellation, EngineKeywords, Progress, SolveKeywords, SolveOptions

if TYPE_CHECKING:
    from irc.execution.simulation import Simulation
    from irc.execution.step import Step
    from irc.explanation import Explanation
    from irc.model import Task


class Solving:
    """A task that is being solved in the background: what `irc.start` returns.

    `cancel` ends it with the best schedule so far, and `result` waits for the schedule. Iterating
    gives each better schedule as it is found, the answer last. As a context manager it ends with
    its block. One thread at a time may use it.
    """

    def __init__(self, task: Task, options: SolveOptions) -> None:
        self._changed = Condition()
        self._progress: Progress | None = None
        self._told = options.on_progress
        options = replace(options, on_progress=self._tell)

        def call(cancel: Cancellation) -> Schedule:
            return solve_task(task, replace(options, cancel=cancel)).schedule

        self._running = Running(call, options.cancel)
        self._running.future.add_done_callback(self._end)

    def __repr__(self) -> str:
        return f"<Solving: {'done' if self.done else 'running'}>"

    def _repr_html_(self) -> str:
        """Its answer, or else its progress so far, for notebooks."""
        from irc.display.html import heading

        if self.done and not self._running.future.exception():
            return self.result()._repr_html_()
        found = "" if self._progress is None else self._progress._repr_html_()
        return heading("not solved: an error" if self.done else "being solved") + found

    @property
    def done(self) -> bool:
        """Whether the answer is there."""
        return self._running.future.done()

    @property
    def progress(self) -> Progress | None:
        """The best answer so far, with its value, bound and gap; None before there is any."""
        return self._progress

    def cancel(self) -> None:
        """Ends the search; `result` then has the best schedule so far, within about a second."""
        self._running.cancellation.cancel()

    def result(self, timeout: float | None = None) -> Schedule:
        """Waits for the schedule, at most `timeout` seconds. Raises what `irc.solve` raises.

        Raises `TimeoutError` where it is not there by then; the search goes on.
        """
        return self._running.future.result(timeout)

    def __iter__(self) -> Iterator[Schedule]:
        """Each better schedule as it is found; the last one is the answer, whatever its status."""
        seen: Progress | None = None
        best: Schedule | None = None
        while True:
            with self._changed:
                while self._progress is seen and not self.done:
                    self._changed.wait()
                seen = self._progress
            if self.done:
                break
            if seen is not None:
                found = seen.schedule()
                # (Exact times can make up for what an engine, in whole ticks, finds better.)
                if best is None or _costs(found) < _costs(best):
                    best = found
                    yield found
        answer = self.result()
        if best is None or not answer.answered or _costs(answer) <= _costs(best):
            yield answer

    def __reduce__(self) -> NoReturn:
        raise TypeError("a search that runs cannot be pickled or copied; its result can")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._running.end()

    def _tell(self, progress: Progress) -> None:
        with self._changed:
            self._progress = progress
            self._changed.notify_all()
        if self._told is not None:
            self._told(progress)

    def _end(self, _future: object) -> None:
        with self._changed:
            self._changed.notify_all()


def _costs(schedule: Schedule) -> list[Number]:
    """The objective values in their order, where less is better."""
    return [-o.value if o.name == "reward" else o.value for o in schedule.objective]


def start(
    task: AnyTask,
    target: str | None = None,
    *,
    options: SolveOptions | None = None,
    **more: Unpack[EngineKeywords],
) -> Solving:
    """Begins to solve a task in the background, with the options of `irc.solve`.

    Raises `InputError` for a document or file that cannot be read; all else is raised by
    `Solving.result`.
    """
    return Solving(ir_of(task), SolveOptions.of(options, more, target))


def solve_iter(
    task: AnyTask,
    target: str | None = None,
    *,
    options: SolveOptions | None = None,
    **more: Unpack[EngineKeywords],
) -> Iterator[Schedule]:
    """Gives better and better schedules, validated; the last one is the answer, with its status.

    Schedules that come faster than they are asked for are left out. The search ends with the loop.
    """
    with start(task, target, options=options, **more) as solving:
        yield from solving


async def asolve_iter(
    task: AnyTask,
    target: str | None = None,
    *,
    options: SolveOptions | None = None,
    **more: Unpack[EngineKeywords],
) -> AsyncIterator[Schedule]:
    """Gives what `irc.solve_iter` gives, without blocking the event loop.

    Where a loop may be left early, `contextlib.aclosing` ends the search with the loop.
    """
    with start(task, target, options=options, **more) as solving:
        schedules = iter(solving)

        def following(_cancel: Cancellation) -> Schedule | None:
            return next(schedules, None)

        while (schedule := await awaited(following, cancel=solving.cancel)) is not None:
            yield schedule


async def asolve(
    task: AnyTask,
    target: str | None = None,
    *,
    options: SolveOptions | None = None,
    **more: Unpack[EngineKeywords],
) -> Schedule:
    """`irc.solve` for `async` code; if its task is cancelled, the engine ends, too."""
    known, chosen = ir_of(task), SolveOptions.of(options, more, target)
    return await awaited(
        lambda c: solve_task(known, replace(chosen, cancel=c)).schedule, chosen.cancel
    )


async def aexplain(
    task: AnyTask, *, time_limit: float | None = None, cancel: Cancellation | None = None
) -> Explanation:
    """`irc.explain` for `async` code; if its task is cancelled, the search ends, too."""
    known = ir_of(task)
    return await awaited(lambda c: calls.explain(known, time_limit=time_limit, cancel=c), cancel)


async def areplan(
    task: AnyTask,
    schedule: Schedule,
    at: Number,
    events: Iterable[Event | Built[Event]] = (),
    *,
    options: SolveOptions | None = None,
    **more: Unpack[SolveKeywords],
) -> Step:
    """`irc.replan` for `async` code; if its task is cancelled, the engine ends, too."""
    known, chosen, listed = ir_of(task), SolveOptions.of(options, more), tuple(events)
    return await awaited(
        lambda c: calls.replan(known, schedule, at, listed, options=replace(chosen, cancel=c)),
        chosen.cancel,
    )


async def asimulate(
    task: AnyTask,
    *,
    schedule: Schedule | None = None,
    on_step: Callable[[Step], None] | None = None,
    options: SolveOptions | None = None,
    **more: Unpack[SolveKeywords],
) -> Simulation:
    """`irc.simulate` for `async` code; `on_step` is called in another thread.

    If its task is cancelled, the engine ends, too.
    """
    known, chosen = ir_of(task), SolveOptions.of(options, more)
    return await awaited(
        lambda c: calls.simulate(
            known, schedule=schedule, on_step=on_step, options=replace(chosen, cancel=c)
        ),
        chosen.cancel,
    )
