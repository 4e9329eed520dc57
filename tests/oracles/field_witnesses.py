"""For each field of the IR a task where it matters: without it, or changed, the answer is another.

A backend that encodes a field must give both answers; one that gives the same twice has dropped
it. The answers were worked out by hand, and `oracles.state_brute_force` agrees.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from irc.model import Task

Document = dict[str, Any]
Answer = tuple[int, ...] | None
"""The best values of the objectives, in order; None where nothing is valid."""

REMOVED = object()


@dataclass(frozen=True)
class Witness:
    """A task in which `field` ("Action.release") matters.

    `pointer` leads to the field in `document`. The counterpart has `instead` there; `REMOVED`
    leaves the field to its default. An empty pointer replaces the whole document.
    """

    field: str
    document: Document
    pointer: tuple[str | int, ...]
    instead: Any
    answer: Answer
    answer_instead: Answer

    @property
    def task(self) -> Task:
        """The task with the field."""
        return Task.model_validate(self.document)

    @property
    def counterpart(self) -> Task:
        """The task without it, or with another value of it."""
        if not self.pointer:
            return Task.model_validate(self.instead)
        document = copy.deepcopy(self.document)
        part: Any = document
        for key in self.pointer[:-1]:
            part = part[key]
        if self.instead is REMOVED:
            del part[self.pointer[-1]]
        else:
            part[self.pointer[-1]] = self.instead
        return Task.model_validate(document)


_DESCRIPTIVE = "for people; no answer depends on it"
_NAME = "a name; tasks that differ in names alone have the same answers"
_LATER = "a revision that is not seen at t = 0: solving answers the task as it stands"

EXCLUDED: Mapping[str, str] = {
    "Task.irc": "the version of the format; there is one",
    "Task.name": _DESCRIPTIVE,
    "Task.description": _DESCRIPTIVE,
    "Task.metadata": "free-form, carried through untouched",
    "Task.events": _LATER,
    "Task.lapsed": _LATER,
    "Action.on_failure": _LATER,
    "Resource.id": _NAME,
    "Resource.label": _DESCRIPTIVE,
    "Resource.description": _DESCRIPTIVE,
    "Action.id": _NAME,
    "Action.label": _DESCRIPTIVE,
    "Action.description": _DESCRIPTIVE,
    "Mode.id": _NAME,
    "Mode.label": _DESCRIPTIVE,
    "StateVariable.id": _NAME,
    "StateVariable.values": "which values are legal; where two lists are, the answers are equal",
    "StateVariable.kind": "judged by `oracles.small_tasks`; the other kind has no values",
    "StateVariable.changes": "judged by `oracles.timed_changes`",
    "Resource.setups": "judged by `oracles.setups`",
    "Resource.no_idle": "judged by `oracles.setups`",
    "Use.family": "judged by `oracles.setups`",
    **dict.fromkeys(
        [
            *("Task.calendars", "Resource.calendar", "Action.calendar", "Action.breaks"),
            *("Action.max_pause", "Calendar.time_zone", "Calendar.every", "Calendar.open"),
            *("Calendar.closed", "OpenTime.days", "OpenTime.from", "OpenTime.to"),
            *("ClosedTime.from", "ClosedTime.to"),
        ],
        "judged by `oracles.pauses`; see `oracles.pause_witnesses`",
    ),
    "Calendar.id": _NAME,
    "Calendar.label": _DESCRIPTIVE,
    "Calendar.description": _DESCRIPTIVE,
    "Group.id": _NAME,
    "Group.label": _DESCRIPTIVE,
    **dict.fromkeys(
        [
            *("Task.couplings", "Task.select"),
            *(f"Coupling.{f}" for f in ("same", "different", "actions", "if", "then")),
            *(f"CoupledAction.{f}" for f in ("action", "use")),
            *(f"ChoiceMade.{f}" for f in ("action", "mode", "modes", "resource", "use")),
            *(f"Selection.{f}" for f in ("actions", "min", "max", "if", "all_or_none")),
            "Task.sequences",
            *(f"UseOrder.{f}" for f in ("consecutive", "resource", "same_order", "jobs")),
        ],
        "judged by `oracles.small_tasks`",
    ),
    "ObjectiveSum.sum": "judged by `oracles.small_tasks`",
    "ObjectiveTerm.weight": "judged by `oracles.small_tasks`",
    "ObjectiveTerm.objective": "judged by `oracles.small_tasks`",
}
"""Fields that no answer can depend on, with the reason. Those of events are in `EVENT_MODELS`."""

EVENT_MODELS: Mapping[str, str] = dict.fromkeys(
    [
        *("Event", "AddActions", "CancelActions", "SetDuration", "AddPrecedence", "PrecedenceKey"),
        *("RemovePrecedence", "AddResources", "SetCapacity", "SetDeadline", "SetRelease"),
        *("AddGroups", "CancelGroups", "SetGoals", "SetState", "AddState", "SetObjective"),
        *("Observe", "RetryAction", "Lapsed"),
    ],
    _LATER,
) | {
    "TimedChange": "judged by `oracles.timed_changes`",
    "Setups": "judged by `oracles.setups`",
    "SetupTime": "judged by `oracles.setups`",
}
"""Models of which no field is witnessed here, with the reason."""


# --- small words for documents ------------------------------------------------------------------


def _act(name: str, duration: Any = 2, **fields: Any) -> Document:
    return {"id": name, "duration": duration, **fields}


def _task(*actions: Document, **fields: Any) -> Document:
    return {"actions": list(actions), **fields}


def _quick_or_slow(**fields: Any) -> Document:
    """An action of 1 in a mode with these fields, or of 6 without them."""
    quick = {"id": "quick", "duration": 1, **fields}
    return {"id": "a", "modes": [quick, {"id": "slow", "duration": 6}]}


def _at(at: str, var: str, value: Any = True) -> Document:
    return {"at": at, "var": var, "value": value}


def _on(*resources: str) -> list[Document]:
    return [{"resource": name} for name in resources]


def _stock(initial: int, **fields: Any) -> Document:
    return {"id": "egg", "kind": "reservoir", "initial": initial, **fields}


_OVENS = [{"id": "oven"}, {"id": "grill"}]
_EGG = [{"resource": "egg"}]
_DARK = [{"id": "lit"}, {"id": "warm"}]
_REWARD_FIRST = ["maximize_reward", "minimize_makespan"]
_LATE_FIRST = ["minimize_tardiness", "minimize_makespan"]
_COST_FIRST = ["minimize_cost", "minimize_makespan"]
_CLOSED = {"from": 1, "to": 4, "capacity": 0}

_TWO_IN_TURN = _task(_act("a", 2), _act("b", 3), precedence=[{"before": "a", "after": "b"}])
_ONE_AT_A_TIME = _task(
    _act("a", 2, uses=_on("oven")), _act("b", 3, uses=_on("oven")), resources=_OVENS
)
_OPENING_HOURS = _task(
    _act("a", 2, uses=_on("oven")), resources=[{"id": "oven", "availability": [_CLOSED]}]
)
_LIGHT_THEN_SEE = _task(
    _act("light", 3, effects=[_at("end", "lit")]),
    _act("see", 2, conditions=[_at("start", "lit")]),
    state=_DARK,
)
_ORDER = _task(
    _act("a", 2),
    _act("b", 3),
    precedence=[{"before": "a", "after": "b"}],
    groups=[{"id": "order", "actions": ["a", "b"], "required": False, "reward": 5}],
    objective=_REWARD_FIRST,
)


def _lag(**fields: Any) -> Document:
    """Two actions of 4 and 2 with one precedence between them."""
    return _task(_act("a", 4), _act("b", 2), precedence=[{"before": "a", "after": "b", **fields}])


def _group(**fields: Any) -> Document:
    """A required group of a 2 and a 3 that share an oven with a 4."""
    return _task(
        *(_act(name, length, uses=_on("oven")) for name, length in (("a", 2), ("b", 3), ("c", 4))),
        resources=_OVENS,
        groups=[{"id": "order", "actions": ["a", "b"], **fields}],
        objective=_LATE_FIRST,
    )


# --- the table ----------------------------------------------------------------------------------

_TASK = (
    Witness("Task.time_unit", _task(_act("a", "2 min")), ("time_unit",), "min", (120,), (2,)),
    Witness(
        "Task.days_per_month",
        _task(_act("a", "1 month"), time_unit="day", days_per_month=28),
        ("days_per_month",),
        REMOVED,
        (28,),
        (30,),
    ),
    Witness(
        "Task.resolution",
        _task(
            _act("a", "150 s"),
            _act("b", 4),
            time_unit="min",
            resolution="1 min",
            precedence=[["a", "b"]],
        ),
        ("resolution",),
        REMOVED,
        (7,),
        (Fraction(13, 2),),
    ),
    Witness("Task.deadline", {**_ONE_AT_A_TIME, "deadline": 4}, ("deadline",), REMOVED, None, (5,)),
    Witness(
        "Task.origin",
        _task(
            _act("a", 1, release="2026-03-02T08:00:00"),
            time_unit="h",
            origin="2026-03-02T06:00:00",
        ),
        ("origin",),
        "2026-03-02T07:00:00",
        (3,),
        (2,),
    ),
    Witness(
        "Task.resources",
        _ONE_AT_A_TIME,
        ("resources",),
        [{"id": "oven", "capacity": 2}],
        (5,),
        (3,),
    ),
    Witness(
        "Task.state",
        _LIGHT_THEN_SEE,
        ("state",),
        [{"id": "lit", "initial": True}, {"id": "warm"}],
        (5,),
        (3,),
    ),
    Witness("Task.actions", _TWO_IN_TURN, ("actions", 1, "duration"), 7, (5,), (9,)),
    Witness("Task.precedence", _TWO_IN_TURN, ("precedence",), REMOVED, (5,), (3,)),
    Witness("Task.groups", _ORDER, ("groups",), REMOVED, (5, 5), (0, 5)),
    Witness(
        "Task.goals",
        _task(_act("a", 2, occurs="optional"), goals=["a"]),
        ("goals",),
        REMOVED,
        (2,),
        (0,),
    ),
    Witness(
        "Task.objective",
        _task(_act("a", 2, occurs="optional", reward=1), objective=_REWARD_FIRST),
        ("objective",),
        REMOVED,
        (1, 2),
        (0,),
    ),
)

_RESOURCES = (
    Witness(
        "Resource.kind",
        _task(_act("a", 2, consumes=_EGG), _act("b", 2, consumes=_EGG), resources=[_stock(1)]),
        (),
        _task(
            _act("a", 2, uses=_on("egg")), _act("b", 2, uses=_on("egg")), resources=[{"id": "egg"}]
        ),
        None,
        (4,),
    ),
    Witness(
        "Resource.capacity",
        {**_ONE_AT_A_TIME, "resources": [{"id": "oven", "capacity": 2}]},
        ("resources", 0, "capacity"),
        REMOVED,
        (3,),
        (5,),
    ),
    Witness(
        "Resource.availability",
        _OPENING_HOURS,
        ("resources", 0, "availability"),
        REMOVED,
        (6,),
        (2,),
    ),
    Witness(
        "Resource.initial",
        _task(_act("a", 2, consumes=_EGG), _act("b", 3, produces=_EGG), resources=[_stock(1)]),
        ("resources", 0, "initial"),
        REMOVED,
        (3,),
        (5,),
    ),
    Witness(
        "Resource.min",
        _task(
            _act("a", 2, consumes=_EGG), _act("b", 3, produces=_EGG), resources=[_stock(0, min=-1)]
        ),
        ("resources", 0, "min"),
        REMOVED,
        (3,),
        (5,),
    ),
    Witness(
        "Resource.max",
        _task(
            _act("a", 3, produces=_EGG),
            _act("b", 1, consumes=_EGG, release=6),
            _act("c", 4),
            precedence=[["a", "c"]],
            resources=[_stock(1, max=1)],
        ),
        ("resources", 0, "max"),
        REMOVED,
        (10,),
        (7,),
    ),
    Witness(
        "Window.from", _OPENING_HOURS, ("resources", 0, "availability", 0, "from"), 2, (6,), (2,)
    ),
    Witness("Window.to", _OPENING_HOURS, ("resources", 0, "availability", 0, "to"), 3, (6,), (5,)),
    Witness(
        "Window.capacity",
        _OPENING_HOURS,
        ("resources", 0, "availability", 0, "capacity"),
        1,
        (6,),
        (2,),
    ),
    Witness(
        "Use.resource", _ONE_AT_A_TIME, ("actions", 0, "uses", 0, "resource"), "grill", (5,), (3,)
    ),
    Witness(
        "Use.one_of",
        _task(
            _act("a", 2, uses=[{"one_of": ["oven", "grill"]}]),
            _act("b", 3, uses=_on("oven")),
            resources=_OVENS,
        ),
        ("actions", 0, "uses", 0, "one_of"),
        ["oven"],
        (3,),
        (5,),
    ),
    Witness(
        "Use.amount",
        _task(
            _act("a", 2, uses=[{"resource": "oven", "amount": 2}]),
            _act("b", 3, uses=_on("oven")),
            resources=[{"id": "oven", "capacity": 2}],
        ),
        ("actions", 0, "uses", 0, "amount"),
        REMOVED,
        (5,),
        (3,),
    ),
    Witness(
        "StockChange.resource",
        _task(
            _act("a", 2, consumes=_EGG),
            _act("b", 3, produces=_EGG),
            resources=[_stock(0), {"id": "jam", "kind": "reservoir", "initial": 1}],
        ),
        ("actions", 0, "consumes", 0, "resource"),
        "jam",
        (5,),
        (3,),
    ),
    Witness(
        "StockChange.amount",
        _task(
            _act("a", 2, consumes=[{"resource": "egg", "amount": 2}]),
            _act("b", 3, produces=_EGG),
            resources=[_stock(1)],
        ),
        ("actions", 0, "consumes", 0, "amount"),
        REMOVED,
        (5,),
        (3,),
    ),
    Witness(
        "StockChange.at",
        _task(
            _act("a", 2, consumes=_EGG),
            _act("b", 3, produces=[{"resource": "egg", "at": "start"}]),
            resources=[_stock(0)],
        ),
        ("actions", 1, "produces", 0, "at"),
        REMOVED,
        (3,),
        (5,),
    ),
)

_ACTIONS = (
    Witness("Action.duration", _task(_act("a", 2)), ("actions", 0, "duration"), 3, (2,), (3,)),
    Witness(
        "Action.occurs",
        _task(_act("a", 2, occurs="optional")),
        ("actions", 0, "occurs"),
        REMOVED,
        (0,),
        (2,),
    ),
    Witness("Action.uses", _ONE_AT_A_TIME, ("actions", 0, "uses"), REMOVED, (5,), (3,)),
    Witness(
        "Action.modes",
        _task(
            {
                "id": "a",
                "modes": [
                    {"id": "slow", "duration": 5},
                    {"id": "quick", "duration": 1, "uses": _on("oven")},
                ],
            },
            _act("b", 3, uses=_on("oven")),
            resources=_OVENS,
        ),
        ("actions", 0, "modes"),
        [{"id": "slow", "duration": 5}],
        (4,),
        (5,),
    ),
    Witness(
        "Action.consumes",
        _task(_act("a", 2, consumes=_EGG), _act("b", 3, produces=_EGG), resources=[_stock(0)]),
        ("actions", 0, "consumes"),
        REMOVED,
        (5,),
        (3,),
    ),
    Witness(
        "Action.produces",
        _task(_act("a", 2, consumes=_EGG), _act("b", 3, produces=_EGG), resources=[_stock(0)]),
        ("actions", 1, "produces"),
        REMOVED,
        (5,),
        None,
    ),
    Witness(
        "Action.release",
        _task(_act("a", 2, release=3)),
        ("actions", 0, "release"),
        REMOVED,
        (5,),
        (2,),
    ),
    Witness(
        "Action.deadline",
        _task(
            _act("a", 2, uses=_on("oven")),
            _act("b", 3, uses=_on("oven"), deadline=3),
            _act("c", 4),
            precedence=[["a", "c"]],
            resources=_OVENS,
        ),
        ("actions", 1, "deadline"),
        REMOVED,
        (9,),
        (6,),
    ),
    Witness(
        "Action.earliest_end",
        _task(_act("a", {"min": 2, "max": 9}, earliest_end=6)),
        ("actions", 0, "earliest_end"),
        REMOVED,
        (6,),
        (2,),
    ),
    Witness(
        "Action.latest_start",
        _task(
            _act("a", 2, uses=_on("oven")),
            _act("b", 3, uses=_on("oven"), latest_start=1),
            _act("c", 4),
            precedence=[["a", "c"]],
            resources=_OVENS,
        ),
        ("actions", 1, "latest_start"),
        REMOVED,
        (9,),
        (6,),
    ),
    Witness(
        "Action.due",
        _task(_act("a", 4, due=1), objective=_LATE_FIRST),
        ("actions", 0, "due"),
        REMOVED,
        (3, 4),
        (0, 4),
    ),
    Witness(
        "Action.weight",
        _task(
            _act("a", 2, uses=_on("oven"), due=2),
            _act("b", 3, uses=_on("oven"), due=2, weight=4),
            resources=_OVENS,
            objective=_LATE_FIRST,
        ),
        ("actions", 1, "weight"),
        REMOVED,
        (7, 5),
        (3, 5),
    ),
    Witness(
        "Action.start", _task(_act("a", 2, start=3)), ("actions", 0, "start"), REMOVED, (5,), (2,)
    ),
    Witness(
        "Action.conditions", _LIGHT_THEN_SEE, ("actions", 1, "conditions"), REMOVED, (5,), (3,)
    ),
    Witness("Action.effects", _LIGHT_THEN_SEE, ("actions", 0, "effects"), REMOVED, (5,), None),
    Witness(
        "Action.reward",
        _task(_act("a", 2, occurs="optional", reward=3), objective=_REWARD_FIRST),
        ("actions", 0, "reward"),
        REMOVED,
        (3, 2),
        (0, 0),
    ),
    Witness(
        "Action.cost",
        _task(
            _act("a", 2, occurs="optional", cost=3, effects=[_at("end", "lit")]),
            _act("b", 4, occurs="optional", cost=1, effects=[_at("end", "lit")]),
            state=_DARK,
            goals=[{"var": "lit"}],
            objective=_COST_FIRST,
        ),
        ("actions", 0, "cost"),
        REMOVED,
        (1, 4),
        (0, 2),
    ),
    Witness(
        "DurationRange.min",
        _task(_act("a", {"min": 2, "max": 5})),
        ("actions", 0, "duration", "min"),
        1,
        (2,),
        (1,),
    ),
    Witness(
        "DurationRange.max",
        _task(
            _act("a", {"min": 1, "max": 4}, start=0),
            _act("b", 1, release=4),
            precedence=[{"before": "a", "after": "b", "max_lag": 0}],
        ),
        ("actions", 0, "duration", "max"),
        3,
        (5,),
        None,
    ),
    Witness(
        "OccurrenceRange.min",
        _task(_act("a", 2, occurs={"min": 2, "max": 3})),
        ("actions", 0, "occurs", "min"),
        1,
        (4,),
        (2,),
    ),
    Witness(
        "OccurrenceRange.max",
        _task(_act("a", 2, occurs={"max": 3}, reward=1), objective=_REWARD_FIRST),
        ("actions", 0, "occurs", "max"),
        2,
        (3, 6),
        (2, 4),
    ),
    Witness(
        "Mode.duration",
        _task(
            {"id": "a", "modes": [{"id": "slow", "duration": 5}, {"id": "quick", "duration": 3}]}
        ),
        ("actions", 0, "modes", 1, "duration"),
        4,
        (3,),
        (4,),
    ),
    Witness(
        "Mode.uses",
        _task(
            {"id": "a", "modes": [{"id": "only", "duration": 2, "uses": _on("oven")}]},
            _act("b", 3, uses=_on("oven")),
            resources=_OVENS,
        ),
        ("actions", 0, "modes", 0, "uses"),
        REMOVED,
        (5,),
        (3,),
    ),
    Witness(
        "Mode.consumes",
        _task(_quick_or_slow(consumes=_EGG), _act("b", 3, produces=_EGG), resources=[_stock(0)]),
        ("actions", 0, "modes", 0, "consumes"),
        REMOVED,
        (4,),
        (3,),
    ),
    Witness(
        "Mode.produces",
        _task(
            _quick_or_slow(produces=_EGG), _act("b", 3, produces=_EGG), resources=[_stock(0, max=1)]
        ),
        ("actions", 0, "modes", 0, "produces"),
        REMOVED,
        (6,),
        (3,),
    ),
    Witness(
        "Mode.conditions",
        _task(
            _quick_or_slow(conditions=[_at("start", "lit")]),
            _act("b", 3, effects=[_at("end", "lit")]),
            state=[{"id": "lit"}],
        ),
        ("actions", 0, "modes", 0, "conditions"),
        REMOVED,
        (4,),
        (3,),
    ),
    Witness(
        "Mode.effects",
        _task(
            _quick_or_slow(effects=[_at("end", "lit")]),
            _act("b", 3, conditions=[_at("start", "lit")]),
            state=[{"id": "lit"}],
        ),
        ("actions", 0, "modes", 0, "effects"),
        REMOVED,
        (4,),
        None,
    ),
    Witness(
        "Mode.cost",
        _task(_quick_or_slow(cost=5), objective=["minimize_cost", "minimize_makespan"]),
        ("actions", 0, "modes", 0, "cost"),
        REMOVED,
        (0, 6),
        (0, 1),
    ),
)

_PRECEDENCE = (
    Witness(
        "Precedence.before",
        _task(_act("a", 2), _act("b", 3), _act("c", 6), precedence=[{"before": "a", "after": "c"}]),
        ("precedence", 0, "before"),
        "b",
        (8,),
        (9,),
    ),
    Witness(
        "Precedence.after",
        _task(_act("a", 2), _act("b", 3), _act("c", 6), precedence=[{"before": "a", "after": "c"}]),
        ("precedence", 0, "after"),
        "b",
        (8,),
        (6,),
    ),
    Witness(
        "Precedence.type", _lag(type="start-start"), ("precedence", 0, "type"), REMOVED, (4,), (6,)
    ),
    Witness(
        "Precedence.min_lag", _lag(min_lag=3), ("precedence", 0, "min_lag"), REMOVED, (9,), (6,)
    ),
    Witness(
        "Precedence.max_lag",
        _task(
            _act("a", 4, deadline=4),
            _act("b", 2, release=9),
            precedence=[{"before": "a", "after": "b", "max_lag": 1}],
        ),
        ("precedence", 0, "max_lag"),
        REMOVED,
        None,
        (11,),
    ),
)

_STATE = (
    Witness(
        "Condition.at", _LIGHT_THEN_SEE, ("actions", 1, "conditions", 0, "at"), "end", (5,), (3,)
    ),
    Witness(
        "Condition.var", _LIGHT_THEN_SEE, ("actions", 1, "conditions", 0, "var"), "warm", (5,), None
    ),
    Witness(
        "Condition.value",
        _LIGHT_THEN_SEE,
        ("actions", 1, "conditions", 0, "value"),
        False,
        (5,),
        (3,),
    ),
    Witness("Effect.at", _LIGHT_THEN_SEE, ("actions", 0, "effects", 0, "at"), "start", (5,), (3,)),
    Witness("Effect.var", _LIGHT_THEN_SEE, ("actions", 0, "effects", 0, "var"), "warm", (5,), None),
    Witness(
        "Effect.value", _LIGHT_THEN_SEE, ("actions", 0, "effects", 0, "value"), False, (5,), None
    ),
    Witness(
        "StateVariable.initial",
        {**_LIGHT_THEN_SEE, "state": [{"id": "lit", "initial": True}]},
        ("state", 0, "initial"),
        REMOVED,
        (3,),
        (5,),
    ),
    Witness(
        "StateGoal.var",
        _task(
            _act("light", 3, occurs="optional", effects=[_at("end", "lit")]),
            _act("heat", 4, occurs="optional", effects=[_at("end", "warm")]),
            state=_DARK,
            goals=[{"var": "lit"}],
        ),
        ("goals", 0, "var"),
        "warm",
        (3,),
        (4,),
    ),
    Witness(
        "StateGoal.value",
        _task(
            _act("light", 3, occurs="optional", effects=[_at("end", "lit")]),
            state=_DARK,
            goals=[{"var": "lit", "value": False}],
        ),
        ("goals", 0, "value"),
        REMOVED,
        (0,),
        (3,),
    ),
)


def _tank(change: Document, *, asks: Document | None = None, **fields: Any) -> Document:
    """Filling for 3 changes a tank with 1 in it; a drive of 2 perhaps asks for a level."""
    drive = {} if asks is None else {"conditions": [{"at": "start", "var": "tank", **asks}]}
    return _task(
        _act("fill", 3, effects=[{"at": "end", "var": "tank", **change}]),
        _act("drive", 2, **drive),
        state=[{"id": "tank", "kind": "number", "initial": 1, **fields}],
    )


def _burning(change: int, burnt: int, **fields: Any) -> Document:
    """Filling for 3 changes a tank with 1 in it; a drive of 2 changes it at its start."""
    document = _tank({"add": change}, **fields)
    document["actions"][1]["effects"] = [{"at": "start", "var": "tank", "add": burnt}]
    return document


def _filled(**asks: int) -> Document:
    """A goal on a tank with 1 in it, to which filling for 3 may add 4."""
    return _task(
        _act("fill", 3, occurs="optional", effects=[{"at": "end", "var": "tank", "add": 4}]),
        state=[{"id": "tank", "kind": "number", "initial": 1}],
        goals=[{"var": "tank", **asks}],
    )


_NUMBERS = (
    Witness(
        "Condition.at_least",
        _tank({"add": 4}, asks={"at_least": 3}),
        ("actions", 1, "conditions", 0, "at_least"),
        1,
        (5,),
        (3,),
    ),
    Witness(
        "Condition.at_most",
        _tank({"add": -1}, asks={"at_most": 0}),
        ("actions", 1, "conditions", 0, "at_most"),
        1,
        (5,),
        (3,),
    ),
    Witness(
        "Condition.equals",
        _tank({"add": 4}, asks={"equals": 5}),
        ("actions", 1, "conditions", 0, "equals"),
        1,
        (5,),
        (3,),
    ),
    Witness(
        "Effect.add",
        _tank({"add": 4}, asks={"at_least": 3}),
        ("actions", 0, "effects", 0, "add"),
        1,
        (5,),
        None,
    ),
    Witness(
        "Effect.set",
        _tank({"set": 3}, asks={"at_least": 3}),
        ("actions", 0, "effects", 0, "set"),
        "5/2",
        (5,),
        None,
    ),
    Witness("StateVariable.min", _burning(4, -2, min=0), ("state", 0, "min"), REMOVED, (5,), (3,)),
    Witness("StateVariable.max", _burning(-1, 1, max=1), ("state", 0, "max"), REMOVED, (5,), (3,)),
    Witness("StateGoal.at_least", _filled(at_least=2), ("goals", 0, "at_least"), 1, (3,), (0,)),
    Witness("StateGoal.at_most", _filled(at_most=4), ("goals", 0, "at_most"), 0, (0,), None),
    Witness("StateGoal.equals", _filled(equals=5), ("goals", 0, "equals"), 1, (3,), (0,)),
)

_GROUPS = (
    Witness(
        "Group.actions",
        _task(
            _act("a", 2, occurs="optional"),
            _act("b", 3, occurs="optional"),
            groups=[{"id": "order", "actions": ["a"]}],
        ),
        ("groups", 0, "actions"),
        ["a", "b"],
        (2,),
        (3,),
    ),
    Witness(
        "Group.required",
        {**_ORDER, "objective": "minimize_makespan"},
        ("groups", 0, "required"),
        REMOVED,
        (0,),
        (5,),
    ),
    Witness("Group.reward", _ORDER, ("groups", 0, "reward"), REMOVED, (5, 5), (0, 0)),
    Witness("Group.deadline", _group(deadline=5), ("groups", 0, "deadline"), 4, (0, 9), None),
    Witness("Group.due", _group(due=3), ("groups", 0, "due"), REMOVED, (2, 9), (0, 9)),
    Witness(
        "Group.weight", _group(due=3, weight=4), ("groups", 0, "weight"), REMOVED, (8, 9), (2, 9)
    ),
)

WITNESSES: tuple[Witness, ...] = (
    *_TASK,
    *_RESOURCES,
    *_ACTIONS,
    *_PRECEDENCE,
    *_STATE,
    *_NUMBERS,
    *_GROUPS,
)
