"""The board of a session: the plans of its execution as they follow one another, and what happened.

The session's thread publishes; threads of a server read. What is published is immutable, and the
page and its data are made only when somebody asks for them.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace

from irc.events.wording import changes_in_words
from irc.execution.execution import Execution
from irc.model import Event
from irc.model.times import format_number
from irc.reporting.html.page import data, page
from irc.reporting.html.payload import Payload, PlanToShow

MOST_PLANS = 30
"""A board shows at most this many plans; then the earliest ones go."""

Listener = Callable[[], None]


class Board:
    """The plans that a board shows. `version` counts their changes; `ended` is set by `end`."""

    def __init__(self, execution: Execution) -> None:
        self._lock = threading.Lock()
        self._plans: tuple[PlanToShow, ...] = (_plan(execution, ()),)
        self._listeners: list[Listener] = []
        self._made: tuple[int, str, str] | None = None
        self.version = 1
        self.ended = False

    def publish(self, execution: Execution, events: Sequence[Event] = ()) -> None:
        """Shows the present state of an execution, after events that have come in.

        A changed schedule is another plan; what only passes time or waits to be planned stays with
        the plan in force.
        """
        last = self._plans[-1]
        said = tuple(_in_words(execution, events))
        shown = _plan(execution, said)
        if shown.schedule == last.schedule and shown.task is last.task:
            if shown.at == last.at and shown.out_of_date == last.out_of_date and not said:
                return
            shown = replace(last, at=shown.at, out_of_date=shown.out_of_date)
            shown = replace(shown, events=(*last.events, *said))
            plans = (*self._plans[:-1], shown)
        elif last.out_of_date:
            # (A plan that was waiting to be made anew is replaced; its events led to the new one.)
            plans = (*self._plans[:-1], replace(shown, events=(*last.events, *said)))
        else:
            plans = (*self._plans, shown)
        self._change(plans[-MOST_PLANS:])

    def end(self) -> None:
        """Says to all who listen that the run has ended."""
        self.ended = True
        self._change(self._plans)

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Calls a function at every change, from the session's thread; returns what ends that."""
        with self._lock:
            self._listeners.append(listener)

        def stop() -> None:
            with self._lock:
                self._listeners.remove(listener)

        return stop

    def page(self) -> str:
        """The page, with what is shown at present."""
        return self._texts()[1]

    def payload(self) -> str:
        """The data of the page at present, as JSON."""
        return self._texts()[2]

    def _change(self, plans: tuple[PlanToShow, ...]) -> None:
        with self._lock:
            self._plans = plans
            self.version += 1
            listeners = tuple(self._listeners)
        for listener in listeners:
            listener()

    def _texts(self) -> tuple[int, str, str]:
        """(the version, its page, its payload), made once for each version."""
        with self._lock:
            version, plans, made = self.version, self._plans, self._made
        if made is None or made[0] != version:
            payload = Payload(plans, None)
            document = {**payload.document(live=True), "board": version}
            made = version, page(payload, document, live=True), data(document)
            with self._lock:
                self._made = made
        return made


def _plan(execution: Execution, events: tuple[str, ...]) -> PlanToShow:
    return PlanToShow(
        execution.task,
        execution.schedule,
        execution.now,
        events,
        out_of_date=execution.replan_needed,
    )


def _in_words(execution: Execution, events: Sequence[Event]) -> list[str]:
    task = execution.task
    said = []
    for event in events:
        at = f"{format_number(task.number(event.at))} {task.time_unit}"
        what = "; ".join(changes_in_words(event, task))
        said.append(f"at {at}: {what}" if event.id is None else f"at {at}, {event.id}: {what}")
    return said
