"""`irc.Task`: a task that is built in code, or read from a file and then built further."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Never, Self, TypeVar, Unpack

from irc.api import calls
from irc.api.calls import AnyEvent
from irc.api.elements import (
    Action,
    Calendar,
    Day,
    Element,
    Goal,
    Group,
    Level,
    Resource,
    StateVariable,
    Value,
    goal_fields,
    precedence_fields,
)
from irc.api.event import Event
from irc.api.values import Duration, Length, Moment, is_time_of_day, length, moment, read, read_part
from irc.diagnostics import Report, did_you_mean
from irc.errors import NameNotFound
from irc.frontends.files import parse_task, read_task
from irc.model import Task as IrTask
from irc.model.parts import ObjectiveName, ObjectiveSum, PrecedenceType
from irc.model.quantities import Number
from irc.model.times import Instant, parse_instant
from irc.schedule import Schedule
from irc.targets import EngineKeywords, Program, SolveKeywords, SolveOptions

if TYPE_CHECKING:
    from irc.api.running import Solving
    from irc.execution.simulation import Simulation
    from irc.execution.step import Step
    from irc.explanation import Explanation
    from irc.validation import Verdict

Object = Mapping[str, Any]
"""An element as the JSON document has it."""

_Element = TypeVar("_Element", bound=Element[Any])
_PARTS = ("calendars", "resources", "state", "actions", "precedence", "groups", "goals", "events")


def load(path: str | Path) -> Task:
    """The task in a file ("-": standard input).

    Raises `InputError`, whose `report` names every fault of syntax and shape with its place.
    """
    return Task.from_ir(read_task(path).task)


def loads(text: str) -> Task:
    """The task in a text; the whole answer of a language model can be given."""
    return Task.from_ir(parse_task(text).task)


Aim = ObjectiveName | Mapping[str, Any] | ObjectiveSum
"""An objective, or a sum of several: `{"sum": [[2, "minimize_makespan"], …]}`."""


class Task:
    """A task: actions, resources, precedence, state, goals and objective.

    It is built element by element, or from the lists of the JSON document, or both. `ir` is the
    immutable task that it stands for, which is compiled, solved and hashed.

    >>> task = Task("tea", time_unit="min")
    >>> boil, brew = task.action("boil", 4), task.action("brew", between(3, 5))
    >>> boil >> brew
    Action('brew')
    >>> task.solve().makespan
    7
    """

    def __init__(
        self,
        name: str | None = None,
        *,
        time_unit: str | None = None,
        origin: datetime | str | None = None,
        deadline: Moment | None = None,
        objective: Aim | Sequence[Aim] | None = None,
        description: str | None = None,
        days_per_month: int | None = None,
        resolution: Length | None = None,
        metadata: Mapping[str, Any] | None = None,
        calendars: Iterable[Calendar | Object] = (),
        resources: Iterable[Resource | Object] = (),
        state: Iterable[StateVariable | Object] = (),
        actions: Iterable[Action | Object] = (),
        precedence: Iterable[Object | Sequence[str]] = (),
        groups: Iterable[Group | Object] = (),
        goals: Iterable[Goal | Object] = (),
        events: Iterable[Event | Object] = (),
        couplings: Iterable[Object] = (),
        select: Iterable[Object] = (),
        sequences: Iterable[Object] = (),
        lapsed: Iterable[Object] = (),
        irc: Literal["1"] | None = None,
        **unknown: Never,
    ) -> None:
        """Raises `InputError` with every fault, and a hint for a field that does not exist."""
        head = {
            "irc": irc,
            "name": name,
            "description": description,
            "time_unit": time_unit,
            "days_per_month": days_per_month,
            "resolution": None if resolution is None else length(resolution),
            "origin": origin,
            "metadata": None if metadata is None else dict(metadata),
            "objective": objective,
            "couplings": list(couplings) or None,
            "select": list(select) or None,
            "sequences": list(sequences) or None,
            "lapsed": list(lapsed) or None,
        }
        given: dict[str, list[Any]] = {
            "calendars": list(calendars),
            "resources": list(resources),
            "state": list(state),
            "actions": list(actions),
            "precedence": list(precedence),
            "groups": list(groups),
            "goals": [_goal(goal) for goal in goals],
            "events": list(events),
        }
        raw = {key: value for key, value in head.items() if value is not None}
        raw |= {key: [_part(item) for item in items] for key, items in given.items() if items}
        raw = {**raw, "actions": raw.get("actions", []), **unknown}
        if deadline is not None:
            clock = read({"actions": (), "origin": origin}) if is_time_of_day(deadline) else None
            raw["deadline"] = moment(deadline, clock)
        self._stand_for(read(raw))
        built = {key: items for key, items in given.items() if any(map(_is_built, items))}
        for key, items in built.items():
            self._adopt(key, items)

    @classmethod
    def from_ir(cls, task: IrTask) -> Task:
        """The task of an immutable one, which can be built further."""
        made = cls.__new__(cls)
        made._stand_for(task)
        return made

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Task:
        """The task of a JSON document. Raises `InputError` with every fault of shape."""
        return cls.from_ir(read(document))

    def _stand_for(self, task: IrTask) -> None:
        self._ir = task
        self._head: IrTask | None = None
        self._parts: dict[str, list[Any]] | None = None
        self._made_of: tuple[Any, ...] = ()

    # --- what it stands for -------------------------------------------------------------------

    @property
    def ir(self) -> IrTask:
        """The immutable task; the same object until something is changed."""
        if self._parts is None:
            return self._ir
        parts = {key: tuple(map(_part, items)) for key, items in self._parts.items()}
        made_of = (self._head, *parts.values())
        if made_of != self._made_of or self._made_of == ():
            head = self._fields()
            listed = {key: part for key, part in parts.items() if part or key == "actions"}
            self._ir, self._made_of = IrTask.model_validate({**head, **listed}), made_of
        return self._ir

    @property
    def ir_head(self) -> IrTask:
        """The task without its elements: its unit, its origin and its deadline."""
        return self._ir if self._head is None else self._head

    def to_dict(self) -> dict[str, Any]:
        """The JSON document."""
        return self.ir.model_dump(mode="json", by_alias=True, exclude_unset=True)

    def copy(self) -> Task:
        """A copy of the task; later changes of one do not affect the other."""
        return Task.from_ir(self.ir)

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, Any]) -> Task:
        made = Task.from_ir(copy.deepcopy(self.ir, memo))
        memo[id(self)] = made
        return made

    def __reduce__(self) -> tuple[Callable[[IrTask], Task], tuple[IrTask]]:
        return Task.from_ir, (self.ir,)

    def __eq__(self, other: object) -> bool:
        """Whether the contents are equal, however they were made."""
        if isinstance(other, Task):
            return self.ir == other.ir
        return self.ir == other if isinstance(other, IrTask) else NotImplemented

    # --- the task as a whole ------------------------------------------------------------------

    @property
    def name(self) -> str | None:
        """The name of the task."""
        return self.ir_head.name

    @name.setter
    def name(self, name: str | None) -> None:
        self._change(name=name)

    @property
    def description(self) -> str | None:
        """The description of the task."""
        return self.ir_head.description

    @description.setter
    def description(self, text: str | None) -> None:
        self._change(description=text)

    @property
    def time_unit(self) -> str:
        """The unit of all times that are numbers; the default is "s"."""
        return self.ir_head.time_unit

    @property
    def origin(self) -> datetime | None:
        """The date-time of t = 0, if there is one."""
        return self.ir_head.origin

    @property
    def deadline(self) -> Instant | None:
        """The time by which all actions must end; set it to a time, or to None for no deadline."""
        return self.ir_head.deadline

    @deadline.setter
    def deadline(self, time: Moment | None) -> None:
        self._change(deadline=None if time is None else moment(time, self.ir_head))

    @property
    def objective(self) -> tuple[ObjectiveName | ObjectiveSum, ...]:
        """The objectives in order of importance; set it to one objective or to several."""
        return self.ir_head.objective

    @objective.setter
    def objective(self, names: Aim | Sequence[Aim]) -> None:
        self._change(objective=names)

    @property
    def metadata(self) -> dict[str, Any]:
        """Your own data, which irc keeps unchanged."""
        return self.ir_head.metadata

    @metadata.setter
    def metadata(self, data: Mapping[str, Any]) -> None:
        self._change(metadata=dict(data))

    def number(self, time: Moment) -> Number:
        """A time of this task in its time unit, exactly. Raises `TimeError`."""
        return self.ir_head.number(parse_instant(moment(time, self.ir_head)))

    # --- elements -----------------------------------------------------------------------------

    def action(
        self,
        id: str,
        duration: Duration | None = None,
        *,
        label: str | None = None,
        description: str | None = None,
    ) -> Action:
        """A new action; its duration is in the task's unit, or has its own units, or is a range."""
        return self._joined(Action(id, duration, label=label, description=description))

    def calendar(
        self,
        id: str,
        start: Length,
        end: Length,
        *days: Day,
        time_zone: str | None = None,
        every: Length | None = None,
        label: str | None = None,
        description: str | None = None,
    ) -> Calendar:
        """A new calendar, open from `start` to `end` on these days (on all if none is named).

        They are times of day such as "06:00", or, with `every`, times since a cycle began.
        """
        made = Calendar(
            id,
            start,
            end,
            *days,
            time_zone=time_zone,
            every=every,
            label=label,
            description=description,
        )
        return self._joined(made)

    def resource(
        self,
        id: str,
        *,
        capacity: int | None = None,
        label: str | None = None,
        description: str | None = None,
    ) -> Resource:
        """A new renewable resource: a station, a robot, a crew."""
        made = Resource(id, capacity=capacity, label=label, description=description)
        return self._joined(made)

    def resources(self, *ids: str, capacity: int | None = None) -> tuple[Resource, ...]:
        """Several new renewable resources."""
        return tuple(self.resource(id, capacity=capacity) for id in ids)

    def reservoir(
        self,
        id: str,
        *,
        initial: int | None = None,
        min: int | None = None,
        max: int | None = None,
        label: str | None = None,
        description: str | None = None,
    ) -> Resource:
        """A new stock, with its initial level and its bounds."""
        made = Resource.reservoir(
            id, initial=initial, min=min, max=max, label=label, description=description
        )
        return self._joined(made)

    def state(
        self,
        id: str,
        values: Sequence[Value] | None = None,
        *,
        initial: Value | None = None,
        changes: Mapping[Any, Value] | None = None,
    ) -> StateVariable:
        """A new state variable; without `values` a boolean that is false at first.

        `changes` are timed changes: the value that the world gives it at each time.
        """
        return self._joined(StateVariable(id, values, initial=initial, changes=changes))

    def number_variable(
        self,
        id: str,
        *,
        initial: Level = 0,
        min: Level | None = None,
        max: Level | None = None,
        changes: Mapping[Any, Level] | None = None,
    ) -> StateVariable:
        """A new number variable, which stays between `min` and `max`.

        `changes` are timed changes: the level that the world gives it at each time.
        """
        made = StateVariable(id, kind="number", initial=initial, min=min, max=max, changes=changes)
        return self._joined(made)

    def precedence(
        self,
        before: Action | str,
        after: Action | str,
        *,
        min_lag: Length = 0,
        max_lag: Length | None = None,
        type: PrecedenceType = "finish-start",
    ) -> Self:
        """Adds a precedence from `before` to `after`, as `before >> after` does."""
        fields = precedence_fields(before, after, min_lag, max_lag, type)
        self._listed()["precedence"].append(read_part("precedence", fields))
        return self

    def group(self, id: str, *actions: Action | str, label: str | None = None) -> Group:
        """A new group: all of its actions happen or, if it is `optional()`, none."""
        return self._joined(Group(id, *actions, label=label))

    def goal(self, *goals: Goal) -> Self:
        """Adds goals: actions or groups that must be present, or `(variable, value)` at the end."""
        found = [read_part_of_goals(goal_fields(goal)) for goal in goals]
        self._listed()["goals"] += found
        return self

    def event(self, at: Moment, *, id: str | None = None) -> Event:
        """A new event, which becomes known at a time; `simulate` runs through them."""
        event = Event(at, id=id, task=self)
        self._listed()["events"].append(event)
        return event

    def add(self, *elements: Action | Resource | StateVariable | Group | Event) -> Self:
        """Adds elements that were made without a task, such as `irc.Action(…)`."""
        for element in elements:
            if isinstance(element, Event):
                self._listed()["events"].append(element)
            else:
                self._joined(element)
        return self

    def __getitem__(self, id: str) -> Action:
        """The action of this name. Raises `irc.NameNotFound` (a `KeyError`) where there is none."""
        actions = self._listed()["actions"]
        for k, action in enumerate(actions):
            if action.id == id:
                if not isinstance(action, Action):
                    actions[k] = action = Action.from_ir(action, self)
                return action
        hint = did_you_mean(id, [action.id for action in actions])
        raise NameNotFound(f"there is no action {id!r}" + (f"; {hint}" if hint else ""))

    def __contains__(self, id: object) -> bool:
        """Whether there is an action of this name."""
        actions = self._ir.actions if self._parts is None else self._parts["actions"]
        return any(action.id == id for action in actions)

    # --- what to do with it -------------------------------------------------------------------

    def check(self) -> Report:
        """All diagnostics: see `irc.check`."""
        return calls.check(self)

    def compile(self, target: str = "cpsat") -> Program:
        """The program of a target: see `irc.compile`."""
        return calls.compile(self, target)

    def solve(
        self,
        target: str | None = None,
        *,
        options: SolveOptions | None = None,
        **more: Unpack[EngineKeywords],
    ) -> Schedule:
        """The best schedule found: see `irc.solve`."""
        return calls.solve(self, target, options=options, **more)

    def start(
        self,
        target: str | None = None,
        *,
        options: SolveOptions | None = None,
        **more: Unpack[EngineKeywords],
    ) -> Solving:
        """Begins to solve it in the background: see `irc.start`."""
        from irc.api.running import start

        return start(self, target, options=options, **more)

    def solve_iter(
        self,
        target: str | None = None,
        *,
        options: SolveOptions | None = None,
        **more: Unpack[EngineKeywords],
    ) -> Iterator[Schedule]:
        """Better and better schedules: see `irc.solve_iter`."""
        from irc.api.running import solve_iter

        return solve_iter(self, target, options=options, **more)

    async def asolve(
        self,
        target: str | None = None,
        *,
        options: SolveOptions | None = None,
        **more: Unpack[EngineKeywords],
    ) -> Schedule:
        """`solve` for `async` code: see `irc.asolve`."""
        from irc.api.running import asolve

        return await asolve(self, target, options=options, **more)

    def explain(self, *, time_limit: float | None = None) -> Explanation:
        """Explains why there is no schedule, or none that is shorter: see `irc.explain`."""
        return calls.explain(self, time_limit=time_limit)

    def validate(self, schedule: Schedule, at: Number | str | None = None) -> Verdict:
        """The verdict on a schedule: see `irc.validate`."""
        return calls.validate(self, schedule, at)

    def replan(
        self,
        schedule: Schedule,
        at: Number | str,
        events: Iterable[AnyEvent] = (),
        *,
        options: SolveOptions | None = None,
        **more: Unpack[SolveKeywords],
    ) -> Step:
        """Repairs the schedule of the running task: see `irc.replan`."""
        return calls.replan(self, schedule, at, events, options=options, **more)

    def simulate(
        self,
        *,
        schedule: Schedule | None = None,
        on_step: Callable[[Step], None] | None = None,
        options: SolveOptions | None = None,
        **more: Unpack[SolveKeywords],
    ) -> Simulation:
        """Simulates the task through all of its events: see `irc.simulate`."""
        return calls.simulate(self, schedule=schedule, on_step=on_step, options=options, **more)

    # --- showing ------------------------------------------------------------------------------

    def __repr__(self) -> str:
        called = "" if self.name is None else f"{self.name!r}, "
        return f"Task({called}{_count(len(self.ir.actions), 'action')})"

    def __str__(self) -> str:
        """The task in the DSL."""
        from irc.frontends.dsl.printer import print_task

        return print_task(self.ir)

    def _repr_html_(self) -> str:
        """Its actions as a table, and the whole in the DSL, for notebooks."""
        from irc.api.task_table import COLUMNS, action_rows
        from irc.display.html import folded, heading, preformatted, table

        shown = f"{self.name or 'task'}: {_count(len(self.ir.actions), 'action')}"
        rows = list(action_rows(self.ir))
        listed = table(COLUMNS, rows) if rows else ""
        return heading(shown) + listed + folded("the task as text", preformatted(str(self)))

    # --- inside -------------------------------------------------------------------------------

    def _listed(self) -> dict[str, list[Any]]:
        """The elements by section, to be changed."""
        if self._parts is None:
            self._parts = {key: list(getattr(self._ir, key)) for key in _PARTS}
        return self._parts

    def _joined(self, element: _Element) -> _Element:
        self._listed()[element.section].append(element.joined(self))
        return element

    def _adopt(self, key: str, items: Sequence[Any]) -> None:
        """Replaces parts of the IR by the elements built in code that they were made from."""
        parts = self._listed()[key]
        for k, item in enumerate(items):
            if isinstance(item, Element):
                parts[k] = item.joined(self)
            elif isinstance(item, Event):
                parts[k] = item

    def _fields(self) -> dict[str, Any]:
        """The fields of the task that are not lists of elements."""
        head = self.ir_head
        return {key: getattr(head, key) for key in head.model_fields_set if key not in _PARTS}

    def _change(self, **fields: Any) -> None:
        """Sets fields of the task as a whole; None removes one."""
        given = {**self._fields(), **fields}
        self._listed()
        self._head = read({k: v for k, v in given.items() if v is not None} | {"actions": ()})


def read_part_of_goals(raw: Any) -> Any:
    """A typed goal."""
    (goal,) = read({"actions": (), "goals": [raw]}).goals
    return goal


def _is_built(item: Any) -> bool:
    return isinstance(item, (Element, Event))


def _part(item: Any) -> Any:
    """The part of the IR that an element stands for; a part of the IR stays as it is."""
    return item.ir if isinstance(item, (Element, Event)) else item


def _goal(goal: Any) -> Any:
    return goal_fields(goal) if isinstance(goal, (Action, Group, StateVariable, tuple)) else goal


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
