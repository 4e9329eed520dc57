"""The payload of a report: the plans as JSON, from which the page draws its chart.

Times and levels are exact texts, as `irc.model.times.format_number` writes them. Rows that several
plans share are written once, and so are lists of closed times that several resources share.
"""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Generic, TypeVar

from irc.events.wording import changes_in_words
from irc.execution.step import Step
from irc.model import Task
from irc.model.quantities import Number
from irc.model.times import format_number, unit_seconds
from irc.reporting.analysis import Analysis, analyse
from irc.reporting.closed import Interval, Levels
from irc.reporting.html.clock import axis_of, clock_text
from irc.reporting.html.columns import tables_for
from irc.reporting.html.figures import figures_of, status_text
from irc.reporting.html.tables import Cells, action_cells, other_cells, value_shown
from irc.reporting.names import plain
from irc.reporting.rows import ActionRow, Key
from irc.schedule import Schedule

T = TypeVar("T", bound=Hashable)


@dataclass
class _Pool(Generic[T]):
    """Distinct things, each by its index."""

    things: dict[T, int] = field(default_factory=dict)

    def index(self, thing: T) -> int:
        """The index of a thing, which is added if it is new."""
        return self.things.setdefault(thing, len(self.things))


@dataclass(frozen=True)
class PlanToShow:
    """A plan of a report: a schedule of a task, and what led to it.

    `at` is the time at which a running task was planned again, None for a plan made beforehand.
    `out_of_date`: something has happened since.
    """

    task: Task
    schedule: Schedule
    at: Number | None = None
    events: tuple[str, ...] = ()
    out_of_date: bool = False

    @cached_property
    def analysis(self) -> Analysis:
        """The analysis of its schedule, made once."""
        return analyse(self.task, self.schedule)

    @classmethod
    def of_step(cls, step: Step) -> PlanToShow:
        """The plan of a step of a running task, with its events in words."""
        return cls(step.task, step.schedule, step.at, tuple(_event_lines(step)))


def _event_lines(step: Step) -> Iterable[str]:
    for event in step.events:
        said = "; ".join(changes_in_words(event, step.task))
        yield f"{event.id}: {said}" if event.id is not None else said


class Payload:
    """Collects the plans of a report; `document` is the payload."""

    def __init__(self, plans: Sequence[PlanToShow], previous: PlanToShow | None) -> None:
        self.shown = tuple(plans)
        self.previous = previous
        self.rows: _Pool[str] = _Pool()
        self.spans: _Pool[str] = _Pool()
        self.resources = _resources(plan.task for plan in self._all())
        self.names = {name: entry["name"] for name, entry in self.resources.items()}
        self.index = {name: k for k, name in enumerate(self.resources)}
        self.orders = _orders(plan.task for plan in self._all())
        self.order_index = {name: k for k, name in enumerate(self.orders)}
        self.analyses = [plan.analysis for plan in self.shown]
        self.before = None if previous is None else previous.analysis

    def _all(self) -> tuple[PlanToShow, ...]:
        return self.shown if self.previous is None else (self.previous, *self.shown)

    def document(self, *, live: bool = False) -> dict[str, Any]:
        """The payload as a JSON document."""
        last = self.analyses[-1]
        before = None if self.before is None else self._rows(self.before)
        plans = [self._plan(k) for k in range(len(self.shown))]
        rows = [json.loads(row) for row in self.rows.things]
        unit = last.time_unit
        return {
            "version": 1,
            "live": live,
            "title": last.name,
            "unit": unit,
            "unit_seconds": format_number(unit_seconds(unit, self.shown[-1].task.days_per_month)),
            "origin": axis_of(last.dates, max(a.span for a in self.analyses)),
            "tables": self._tables(unit, plans, rows),
            "resources": list(self.resources.values()),
            "orders": list(self.orders.values()),
            "spans": [json.loads(spans) for spans in self.spans.things],
            "rows": rows,
            "previous": before,
            "plans": plans,
        }

    def _tables(
        self, unit: str, plans: Sequence[dict[str, Any]], rows: Sequence[dict[str, Any]]
    ) -> dict[str, Any]:
        """Each table with its columns: title, kind, by which to sort, whether any plan has it."""
        shown = {}
        for name, table in tables_for(unit).items():
            cells = (
                [row["c"] for row in rows]
                if name == "actions"
                else [row for plan in plans for row in plan["tables"][name]]
            )
            used = [any(row[k] for row in cells) for k in range(len(table.columns))]
            columns = [[*column, used[k]] for k, column in enumerate(table.columns)]
            shown[name] = {"title": table.title, "note": table.note, "columns": columns}
        return shown

    def _plan(self, k: int) -> dict[str, Any]:
        plan, analysis = self.shown[k], self.analyses[k]
        before = self.analyses[k - 1] if k else self.before
        dues = [
            [self.order_index[row.order], format_number(row.due)]
            for row in analysis.orders
            if row.kind == "group" and row.due is not None
        ]
        loads = {load.resource: load for load in analysis.loads}
        capacity = {name: load.capacity for name, load in loads.items()}
        closed = {name: load.closed for name, load in loads.items()}
        return {
            "label": self._label(plan, analysis),
            "at": None if plan.at is None else format_number(plan.at),
            "events": list(plan.events),
            "status": str(plan.schedule.status),
            "status_text": status_text(plan.schedule),
            "figures": figures_of(plan.schedule, analysis, before),
            "rows": self._rows(analysis),
            "chain": list(map(_key_text, analysis.critical)),
            "setups": [
                [
                    self.index[setup.resource],
                    format_number(setup.start),
                    format_number(setup.end),
                    "" if setup.before is None else _named(setup.before),
                    _named(setup.after),
                ]
                for setup in analysis.setups
            ],
            "closed": [self._spans(closed.get(name, ())) for name in self.resources],
            "capacity": [self._spans(capacity.get(name, ())) for name in self.resources],
            "dues": dues,
            "stock": [
                {
                    "name": self.names[stock.resource],
                    "min": str(stock.least),
                    "max": None if stock.greatest is None else str(stock.greatest),
                    "points": [[format_number(t), str(level)] for t, level in stock.levels],
                }
                for stock in analysis.stocks
            ],
            "state": [
                {
                    "name": state.variable,
                    "numeric": state.is_number,
                    "points": [[format_number(t), value_shown(v)] for t, v in state.values],
                }
                for state in analysis.states
                if state.values
            ],
            "tables": {
                name: [list(cells) for cells in rows]
                for name, rows in other_cells(analysis, before, self.names).items()
            },
        }

    def _label(self, plan: PlanToShow, analysis: Analysis) -> str:
        if plan.at is None:
            return "the plan"
        clock = clock_text(analysis.dates, plan.at)
        exact = f"{format_number(plan.at)} {analysis.time_unit}"
        said = f"at {clock} ({exact})" if clock else f"at {exact}"
        return f"{said}, out of date: to be planned again" if plan.out_of_date else said

    def _spans(self, pairs: Sequence[Interval] | Levels) -> int:
        return self.spans.index(
            json.dumps([[format_number(a), format_number(b)] for a, b in pairs])
        )

    def _rows(self, analysis: Analysis) -> list[int]:
        paused = {(p.action, p.occurrence): p.spans for p in analysis.pauses}
        return [
            self.rows.index(
                json.dumps(self._row(analysis, row, paused.get(row.key, ())), ensure_ascii=False)
            )
            for row in analysis.actions
        ]

    def _row(
        self, analysis: Analysis, row: ActionRow, paused: Sequence[Interval]
    ) -> dict[str, Any]:
        cells: Cells = action_cells(analysis, row, self.names)
        shown: dict[str, Any] = {
            "c": cells,
            "u": [[self.index[name], amount] for name, amount in sorted(row.resources.items())],
            "o": self.order_index[row.orders[0]] if row.orders else -1,
        }
        if row.label != row.action:
            shown["n"] = plain(row.label)
        if row.critical:
            shown["k"] = 1
        if paused:
            shown["p"] = [[format_number(a), format_number(b)] for a, b in paused]
        if row.why:
            shown["w"] = [
                [reason.text] if reason.after is None else [reason.text, _key_text(reason.after)]
                for reason in row.why
            ]
        return shown


def _named(key: Key) -> str:
    return key[0] if key[1] == 1 else f"{key[0]} ({key[1]})"


def _key_text(key: Key) -> str:
    """An occurrence as the page names it: the cells of its action and number."""
    return f"{key[0]}\0{'' if key[1] == 1 else key[1]}"


def _resources(tasks: Iterable[Task]) -> dict[str, dict[str, Any]]:
    """The resources of all tasks, in their order; a later task's word on one counts."""
    found: dict[str, dict[str, Any]] = {}
    for task in tasks:
        for resource in task.resources:
            found[resource.id] = {
                "name": plain(resource.label or resource.id),
                "capacity": resource.capacity,
                "stock": resource.kind == "reservoir",
            }
    return found


def _orders(tasks: Iterable[Task]) -> dict[str, str]:
    found: dict[str, str] = {}
    for task in tasks:
        for group in task.groups:
            found[group.id] = plain(group.label or group.id)
    return found
