"""The elements of a task, built in code: actions, modes, resources, state variables, groups.

Each method checks its arguments at once and returns the element itself, so that calls can be
chained. `ir` is the immutable part of the IR that an element stands for.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic, Literal, Self, TypeVar, overload

from irc.api.values import Duration, Length, Moment, duration, length, moment, read_part
from irc.errors import OptionError
from irc.model import Action as IrAction
from irc.model import Calendar as IrCalendar
from irc.model import Group as IrGroup
from irc.model import Resource as IrResource
from irc.model import StateVariable as IrStateVariable
from irc.model.parts import OnFailure, PrecedenceType

if TYPE_CHECKING:
    from irc.api.task import Task

Value = bool | str
"""A value of a state variable."""

Level = int | float | str | Fraction | Decimal
"""A level of a number variable: an exact number; a text such as "1/3" is one, too."""

AnyValue = Value | Level
"""A value of a state variable, or a level of a number variable."""

Day = Literal["mon", "tue", "wed", "thu", "fri", "sat", "sun"]
"""A day of the week."""

_Node = TypeVar("_Node", IrAction, IrCalendar, IrGroup, IrResource, IrStateVariable)


def without_none(**fields: Any) -> dict[str, Any]:
    """The fields that are not None."""
    return {name: value for name, value in fields.items() if value is not None}


class Element(Generic[_Node]):
    """An element with an id, in one section of a task."""

    section: str

    def __init__(self, raw: Mapping[str, Any], task: Task | None = None) -> None:
        self._raw = dict(raw)
        self._ir: _Node = read_part(self.section, self._raw)
        self._task = task

    @property
    def id(self) -> str:
        """Its name."""
        return self._ir.id

    @property
    def ir(self) -> _Node:
        """The immutable part of the IR that it stands for."""
        return self._ir

    def to_dict(self) -> dict[str, Any]:
        """Its object in the JSON document."""
        shown: dict[str, Any] = self._ir.model_dump(mode="json", by_alias=True, exclude_unset=True)
        return shown

    def joined(self, task: Task) -> Self:
        """The element as a part of a task. Raises `OptionError` if it is a part of another."""
        if self._task is not None and self._task is not task:
            raise OptionError(f"{self.id!r} is a part of another task; make a new one")
        self._task = task
        return self

    def _set(self, **fields: Any) -> Self:
        raw = {**self._raw, **fields}
        self._ir = read_part(self.section, raw)
        self._raw = raw
        return self

    def _more(self, field: str, *items: Any) -> Self:
        return self._set(**{field: [*self._raw.get(field, ()), *items]})

    def _moment(self, value: Moment) -> Any:
        return moment(value, None if self._task is None else self._task.ir_head)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Element):
            return NotImplemented
        return type(self) is type(other) and self._ir == other._ir

    def __hash__(self) -> int:
        return hash((self.section, self.id))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.id!r})"


class Calendar(Element[IrCalendar]):
    """Open times that repeat without end: by days of the week, or every day or hour."""

    section = "calendars"

    def __init__(
        self,
        id: str,
        start: Length,
        end: Length,
        *days: Day,
        time_zone: str | None = None,
        every: Length | None = None,
        label: str | None = None,
        description: str | None = None,
    ) -> None:
        """A calendar that is open from `start` to `end`, on these days, or on all.

        They are times of day such as "06:00", or, with `every`, times since a cycle began.
        """
        fields = without_none(
            id=id, time_zone=time_zone, every=None if every is None else length(every)
        )
        opened = [_opening(start, end, days)]
        super().__init__(
            {**fields, "open": opened, **without_none(label=label, description=description)}
        )

    def open(self, start: Length, end: Length, *days: Day) -> Self:
        """Opens it at another time, too."""
        return self._more("open", _opening(start, end, days))

    def closed(self, start: Moment, end: Moment | None = None) -> Self:
        """Closes it on a day, or from `start` to `end`."""
        if end is None:
            return self._more("closed", start)
        return self._more("closed", {"from": self._moment(start), "to": self._moment(end)})


def _opening(start: Length, end: Length, days: Sequence[Day]) -> dict[str, Any]:
    return {**({"days": list(days)} if days else {}), "from": length(start), "to": length(end)}


class Resource(Element[IrResource]):
    """A station, a robot, a crew (renewable), or a stock (reservoir)."""

    section = "resources"

    def __init__(
        self,
        id: str,
        *,
        capacity: int | None = None,
        label: str | None = None,
        description: str | None = None,
    ) -> None:
        """A renewable resource; `Task.reservoir` makes a stock."""
        super().__init__(
            without_none(id=id, capacity=capacity, label=label, description=description)
        )

    @classmethod
    def reservoir(
        cls,
        id: str,
        *,
        initial: int | None = None,
        min: int | None = None,
        max: int | None = None,
        label: str | None = None,
        description: str | None = None,
    ) -> Resource:
        """A stock that actions consume and produce, with its initial level and its bounds."""
        fields = without_none(
            initial=initial, min=min, max=max, label=label, description=description
        )
        return cls(id)._set(kind="reservoir", **fields)

    def available(self, start: Moment, end: Moment, capacity: int) -> Self:
        """Sets another capacity from `start` to `end` (0: not available)."""
        window = {"from": self._moment(start), "to": self._moment(end), "capacity": capacity}
        return self._more("availability", window)

    def setup(self, before: str, after: str, time: Length = 0, *, cost: int | None = None) -> Self:
        """Sets the set-up from uses of one family to those of another; "*" is any other family."""
        row = without_none(**{"from": before, "to": after}, time=length(time), cost=cost)
        setups = self._raw.get("setups") or {}
        return self._set(setups={**setups, "times": [*setups.get("times", ()), row]})

    def no_idle(self) -> Self:
        """Leaves no gap between its first and its last use but set-ups."""
        return self._set(no_idle=True)

    def takes_loads(self) -> Self:
        """Lets it take loads: what is in it at once starts and ends together, of one family."""
        return self._set(kind="batch")

    def initial_family(self, family: str) -> Self:
        """Sets the family that the resource is set up for at t = 0."""
        return self._set(setups={**(self._raw.get("setups") or {}), "initial": family})

    def calendar(self, calendar: Calendar | str) -> Self:
        """Sets the calendar: while that is closed the resource has no capacity."""
        return self._set(calendar=name_of(calendar))


class StateVariable(Element[IrStateVariable]):
    """A state variable: it has one of several values at any time."""

    section = "state"

    def __init__(
        self,
        id: str,
        values: Sequence[Value] | None = None,
        *,
        kind: Literal["values", "number"] | None = None,
        initial: AnyValue | None = None,
        min: Level | None = None,
        max: Level | None = None,
        changes: Mapping[Any, AnyValue] | None = None,
    ) -> None:
        """A state variable; without `values`, a boolean that is false at first.

        Of the kind "number" it is an exact number, 0 at first, that stays between `min` and `max`.
        `changes` are timed changes: the value that the world gives it at each time.
        """
        listed = None if values is None else list(values)
        timed = [{"at": at, "value": value} for at, value in (changes or {}).items()] or None
        bounds = {"kind": kind, "min": min, "max": max}
        super().__init__(
            without_none(id=id, values=listed, initial=initial, changes=timed, **bounds)
        )


def name_of(element: Element[Any] | str) -> str:
    """The id of an element, or the id itself."""
    return element.id if isinstance(element, Element) else element


class _CarriedOut(ABC):
    """The base of what holds resources and changes stock and state: actions, and their modes."""

    @abstractmethod
    def _more(self, field: str, *items: Any) -> Self: ...

    @abstractmethod
    def _set(self, **fields: Any) -> Self: ...

    def uses(self, *resources: Resource | str, amount: int = 1, family: str | None = None) -> Self:
        """Holds `amount` units of each of these resources from its start to its end.

        Set-ups of a resource depend on the `family`.
        """
        return self._more(
            "uses", *(_use("resource", name_of(r), amount, family) for r in resources)
        )

    def one_of(
        self, *resources: Resource | str, amount: int = 1, family: str | None = None
    ) -> Self:
        """Holds `amount` units of one of these resources, which the solver chooses."""
        return self._more("uses", _use("one_of", [name_of(r) for r in resources], amount, family))

    def cost(self, amount: int) -> Self:
        """Sets the cost of each occurrence, for the objective `minimize_cost`."""
        return self._set(cost=amount)

    def consumes(
        self,
        reservoir: Resource | str,
        amount: int = 1,
        *,
        at: Literal["start", "end"] | None = None,
    ) -> Self:
        """Takes an amount from a stock, by default at its start."""
        change = without_none(resource=name_of(reservoir), amount=amount, at=at)
        return self._more("consumes", change)

    def produces(
        self,
        reservoir: Resource | str,
        amount: int = 1,
        *,
        at: Literal["start", "end"] | None = None,
    ) -> Self:
        """Puts an amount into a stock, by default at its end."""
        change = without_none(resource=name_of(reservoir), amount=amount, at=at)
        return self._more("produces", change)

    def condition(
        self,
        variable: StateVariable | str,
        value: Value = True,
        *,
        at: Literal["start", "all", "end"] = "start",
        at_least: Level | None = None,
        at_most: Level | None = None,
        equals: Level | None = None,
    ) -> Self:
        """Demands that `variable` has `value` when it starts, when it ends, or throughout.

        Of a number variable it demands limits instead: `at_least`, `at_most`, or `equals`.
        """
        limits = without_none(at_least=at_least, at_most=at_most, equals=equals)
        wanted = limits or {"value": value}
        return self._more("conditions", {"at": at, "var": name_of(variable), **wanted})

    def effect(
        self,
        variable: StateVariable | str,
        value: Value = True,
        *,
        at: Literal["start", "end"] = "end",
        add: Level | None = None,
        set: Level | None = None,
    ) -> Self:
        """Gives `variable` the `value` at its end (or start).

        A number variable gets `add` added to it, or becomes `set`, instead.
        """
        given = without_none(add=add, set=set) or {"value": value}
        return self._more("effects", {"at": at, "var": name_of(variable), **given})


def _use(key: str, what: Any, amount: int, family: str | None) -> dict[str, Any]:
    use = {key: what} if amount == 1 else {key: what, "amount": amount}
    return use if family is None else {**use, "family": family}


class Mode(_CarriedOut):
    """One way to carry out an action: its duration, and what it adds to the action's own.

    Its uses, stock, conditions, effects and cost come on top of those of the action.
    """

    def __init__(self, action: Action, raw: Mapping[str, Any]) -> None:
        self.action = action
        self._raw = dict(raw)

    @property
    def id(self) -> str:
        """Its name."""
        return str(self._raw["id"])

    def to_dict(self) -> dict[str, Any]:
        """Its object in the JSON document."""
        place = [mode.id for mode in self.action.ir.modes].index(self.id)
        shown: dict[str, Any] = self.action.to_dict()["modes"][place]
        return shown

    def _more(self, field: str, *items: Any) -> Self:
        return self._set(**{field: [*self._raw.get(field, ()), *items]})

    def _set(self, **fields: Any) -> Self:
        old, new = self._raw, {**self._raw, **fields}
        self.action.change_mode(old, new)
        self._raw = new
        return self

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mode) and (self.action, self.id) == (other.action, other.id)

    def __hash__(self) -> int:
        return hash((self.action, self.id))

    def __repr__(self) -> str:
        return f"Mode({self.id!r} of {self.action.id!r})"


class _Wanted(Element[_Node]):
    """The base of elements with deadline, due date and reward: actions and groups."""

    def deadline(self, time: Moment) -> Self:
        """Sets the deadline: it must end by this time."""
        return self._set(deadline=self._moment(time))

    def due(self, time: Moment, *, weight: int | None = None) -> Self:
        """Sets the due date: a later end costs tardiness, `weight` for each unit of time."""
        return self._set(due=self._moment(time), **without_none(weight=weight))

    def reward(self, amount: int) -> Self:
        """Sets the reward for its presence, for the objective `maximize_reward`."""
        return self._set(reward=amount)


class Group(_Wanted[IrGroup]):
    """Actions of which all happen or none: an order, a delivery."""

    section = "groups"

    def __init__(self, id: str, *actions: Action | str, label: str | None = None) -> None:
        """A group that must be present; see `optional`."""
        members = [name_of(action) for action in actions]
        super().__init__(without_none(id=id, label=label, actions=members))

    def optional(self) -> Self:
        """Makes the group optional: a schedule may leave it out as a whole."""
        return self._set(required=False)


class Action(_Wanted[IrAction], _CarriedOut):
    """An action: something that takes time.

    With `a >> b`, b starts after the end of a; `a >> [b, c]` and `[a, b] >> c` work likewise.
    """

    section = "actions"

    def __init__(
        self,
        id: str,
        duration: Duration | None = None,
        *,
        label: str | None = None,
        description: str | None = None,
    ) -> None:
        """An action of a fixed duration, of one in a range (`irc.between`), or with modes."""
        super().__init__(_action_fields(id, duration, label, description))
        self._modes: list[Mode] = []

    @classmethod
    def from_ir(cls, action: IrAction, task: Task | None = None) -> Action:
        """The action of a part of the IR, which can be changed further."""
        made = cls.__new__(cls)
        Element.__init__(made, action.model_dump(by_alias=True, exclude_unset=True), task)
        made._modes = [Mode(made, mode) for mode in made._raw.get("modes", ())]
        return made

    # --- when ---------------------------------------------------------------------------------

    def release(self, time: Moment) -> Self:
        """Sets the release: it does not start before this time."""
        return self._set(release=self._moment(time))

    def start(self, time: Moment) -> Self:
        """Fixes the start at this time."""
        return self._set(start=self._moment(time))

    def latest_start(self, time: Moment) -> Self:
        """Starts no later."""
        return self._set(latest_start=self._moment(time))

    def calendar(self, calendar: Calendar | str) -> Self:
        """Sets the calendar at whose open times it is carried out."""
        return self._set(calendar=name_of(calendar))

    def pauses(self, at_most: Length | None = None) -> Self:
        """Lets its work pause at closed times, for `at_most` so long altogether."""
        limit = {} if at_most is None else {"max_pause": length(at_most)}
        return self._set(breaks="pause", **limit)

    def earliest_end(self, time: Moment) -> Self:
        """Ends no earlier."""
        return self._set(earliest_end=self._moment(time))

    def on_failure(self, how: OnFailure) -> Self:
        """Is done again if a resource breaks that it holds: what is left ("resume"), or all."""
        return self._set(on_failure=how)

    def before(
        self,
        *others: Action | str,
        min_lag: Length = 0,
        max_lag: Length | None = None,
        type: PrecedenceType = "finish-start",
    ) -> Self:
        """Makes others start after its end, at least `min_lag` and at most `max_lag` later.

        `type` binds other ends: "start-start", "finish-finish", "start-finish".
        """
        for other in others:
            self._home().precedence(self, other, min_lag=min_lag, max_lag=max_lag, type=type)
        return self

    def after(
        self,
        *others: Action | str,
        min_lag: Length = 0,
        max_lag: Length | None = None,
        type: PrecedenceType = "finish-start",
    ) -> Self:
        """Makes it start after the ends of others; see `before`."""
        for other in others:
            self._home().precedence(other, self, min_lag=min_lag, max_lag=max_lag, type=type)
        return self

    @overload
    def __rshift__(self, other: Action) -> Action: ...
    @overload
    def __rshift__(self, other: Sequence[Action]) -> Sequence[Action]: ...
    def __rshift__(self, other: Action | Sequence[Action]) -> Action | Sequence[Action]:
        """Makes the other start after the end of this one. Returns the other, for a chain."""
        self.before(*([other] if isinstance(other, Action) else other))
        return other

    def __rrshift__(self, others: Iterable[Action]) -> Action:
        """Makes this one start after the ends of all the others."""
        return self.after(*others)

    # --- whether and how ----------------------------------------------------------------------

    def optional(self) -> Self:
        """Makes the action optional: it happens once or not at all."""
        return self._set(occurs="optional")

    def occurs(self, min: int = 0, max: int | None = None) -> Self:
        """Lets the action occur from `min` to `max` times; without `max`, the solver chooses."""
        return self._set(occurs=without_none(min=min, max=max))

    def mode(self, id: str, duration: Duration, *, label: str | None = None) -> Mode:
        """Adds a mode, and returns it; the solver chooses one of the modes."""
        mode = Mode(self, _action_fields(id, duration, label, None))
        self._set(modes=[*(m._raw for m in self._modes), mode._raw])
        self._modes.append(mode)
        return mode

    def change_mode(self, old: Mapping[str, Any], new: Mapping[str, Any]) -> None:
        """Replaces a mode by another one."""
        self._set(modes=[new if m._raw is old else m._raw for m in self._modes])

    def _home(self) -> Task:
        if self._task is None:
            raise OptionError(
                f"{self.id!r} is not a part of a task yet: make it with `task.action(…)`, or give "
                "it to `task.add(…)` first"
            )
        return self._task


def _action_fields(
    id: str, length_of: Duration | None, label: str | None, description: str | None
) -> dict[str, Any]:
    fields = without_none(id=id, label=label, description=description)
    return fields if length_of is None else {**fields, "duration": duration(length_of)}


def precedence_fields(
    before: Action | str,
    after: Action | str,
    min_lag: Length,
    max_lag: Length | None,
    type: PrecedenceType,
) -> dict[str, Any]:
    """The object of a precedence in the JSON document."""
    fields: dict[str, Any] = {"before": name_of(before), "after": name_of(after)}
    if type != "finish-start":
        fields["type"] = type
    if min_lag != 0:
        fields["min_lag"] = length(min_lag)
    if max_lag is not None:
        fields["max_lag"] = length(max_lag)
    return fields


Goal = (
    Action | Group | StateVariable | str | tuple[StateVariable | str, Value | Mapping[str, Level]]
)
"""A goal: an action or group that must be present, or a variable and its value at the end.

Of a number variable there are limits instead of a value: `(fuel, {"at_least": 10})`.
"""


def goal_fields(goal: Goal) -> Any:
    """A goal in the form of the JSON document."""
    if isinstance(goal, tuple):
        variable, value = goal
        wanted = value if isinstance(value, Mapping) else {"value": value}
        return {"var": name_of(variable), **wanted}
    return {"var": goal.id} if isinstance(goal, StateVariable) else name_of(goal)
