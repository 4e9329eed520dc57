"""The ledger: the features of the IR that a task uses, with places, so that a target can refuse.

A backend encodes each element of a task, or it refuses the compilation; it never drops an element
silently. Events are not part of the ledger: they revise the task while it runs, and a backend gets
the task in force.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

from irc.diagnostics.source import Pointer
from irc.model import Action, DurationRange, Resource, Task
from irc.model.parts import OF_MODES

if TYPE_CHECKING:
    from irc.model import Group


class Feature(Enum):
    """A feature that a backend supports or refuses. Its value is the phrase in messages."""

    DURATION_RANGE = "durations the solver chooses"
    ZERO_DURATION = "zero durations"
    MODES = "modes"
    MODE_ELEMENTS = "cost, stock and state of modes"
    OPTIONAL_ACTIONS = "optional actions"
    REPEATED_ACTIONS = "actions that may occur more than once"
    PRECEDENCE = "precedence"
    PRECEDENCE_TYPES = "precedence other than finish-start"
    MIN_LAG = "minimum lags"
    NEGATIVE_LAG = "negative minimum lags"
    MAX_LAG = "maximum lags"
    RELEASE = "releases"
    DEADLINE = "deadlines"
    FIXED_START = "fixed starts"
    LATEST_START = "latest starts"
    EARLIEST_END = "earliest ends"
    DUE_DATE = "due dates"
    RESOURCES = "renewable resources"
    AMOUNTS = "amounts above 1"
    ALTERNATIVES = "a choice of resources (one_of)"
    SETUPS = "set-ups"
    CALENDARS = "availability windows and calendars"
    ACTION_CALENDARS = "calendars of actions"
    PAUSES = "work that pauses"
    NO_IDLE = "resources without idle time"
    BATCHES = "batch resources"
    RESERVOIRS = "reservoirs"
    STATE = "state variables"
    NUMBERS = "number variables"
    TIMED_CHANGES = "timed changes of state"
    TIMED_LEVELS = "timed changes of number variables"
    CONDITIONS = "conditions"
    EFFECTS = "effects"
    STATE_GOALS = "goals on state variables"
    PRESENCE_GOALS = "goals that an action is present"
    GROUPS = "groups"
    COUPLINGS = "coupled choices"
    SELECTIONS = "selections"
    SEQUENCES = "orders of uses (sequences)"
    REWARD = "rewards"
    COST = "costs"
    TARDINESS = "the objective minimize_tardiness"
    TARDY = "the objective minimize_tardy"
    MAX_TARDINESS = "the objective minimize_max_tardiness"
    EARLINESS = "the objective minimize_earliness"
    FLOW_TIME = "the objective minimize_flow_time"
    OBJECTIVE_SUM = "weighted sums of objectives"
    MAXIMIZE_REWARD = "the objective maximize_reward"
    MINIMIZE_COST = "the objective minimize_cost"
    MINIMIZE_CHANGES = "the objective minimize_changes"
    SETUP_TIME = "the objective minimize_setup_time"
    SETUP_COST = "the objective minimize_setup_cost"
    SEVERAL_OBJECTIVES = "several objectives"
    MAKESPAN = "the objective minimize_makespan"


class FeatureUse(NamedTuple):
    """One place where a task uses a feature, and the element's name for messages."""

    feature: Feature
    pointer: Pointer
    element: str


def features_of(task: Task) -> Iterator[FeatureUse]:
    """Every use of every feature, in the order of the document."""
    if task.deadline is not None:
        yield FeatureUse(Feature.DEADLINE, ("deadline",), "the task")
    for i, resource in enumerate(task.resources):
        yield from _of_resource(resource, ("resources", i))
    for i, variable in enumerate(task.state):
        name = f"state variable {variable.id!r}"
        feature = Feature.NUMBERS if variable.is_number else Feature.STATE
        yield FeatureUse(feature, ("state", i), name)
        if variable.changes:
            timed = Feature.TIMED_LEVELS if variable.is_number else Feature.TIMED_CHANGES
            yield FeatureUse(timed, ("state", i, "changes"), name)
    for i, action in enumerate(task.actions):
        if not action.is_simple:
            yield from _of_action(action, i)
    yield from _of_precedence(task)
    for i, group in enumerate(task.groups):
        yield from _of_group(group, ("groups", i))
    for i, _ in enumerate(task.couplings):
        yield FeatureUse(Feature.COUPLINGS, ("couplings", i), f"coupling {i + 1}")
    for i, _ in enumerate(task.select):
        yield FeatureUse(Feature.SELECTIONS, ("select", i), f"selection {i + 1}")
    for i, _ in enumerate(task.sequences):
        yield FeatureUse(Feature.SEQUENCES, ("sequences", i), f"sequence {i + 1}")
    yield from _of_goals(task)
    yield from _of_objective(task)


def _of_resource(resource: Resource, at: Pointer) -> Iterator[FeatureUse]:
    name = f"resource {resource.id!r}"
    if resource.kind == "reservoir":
        yield FeatureUse(Feature.RESERVOIRS, at, name)
    else:
        yield FeatureUse(Feature.RESOURCES, at, name)
    if resource.kind == "batch":
        yield FeatureUse(Feature.BATCHES, (*at, "kind"), name)
    if resource.availability:
        yield FeatureUse(Feature.CALENDARS, (*at, "availability"), name)
    if resource.setups is not None:
        yield FeatureUse(Feature.SETUPS, (*at, "setups"), name)
    if resource.calendar is not None:
        yield FeatureUse(Feature.CALENDARS, (*at, "calendar"), name)
    if resource.no_idle:
        yield FeatureUse(Feature.NO_IDLE, (*at, "no_idle"), name)


_ACTION_FIELDS = (
    ("modes", Feature.MODES),
    ("consumes", Feature.RESERVOIRS),
    ("produces", Feature.RESERVOIRS),
    ("deadline", Feature.DEADLINE),
    ("due", Feature.DUE_DATE),
    ("start", Feature.FIXED_START),
    ("latest_start", Feature.LATEST_START),
    ("calendar", Feature.ACTION_CALENDARS),
    ("earliest_end", Feature.EARLIEST_END),
    ("conditions", Feature.CONDITIONS),
    ("effects", Feature.EFFECTS),
    ("reward", Feature.REWARD),
    ("cost", Feature.COST),
)

_FEATURES = dict(_ACTION_FIELDS)


def _of_action(action: Action, index: int) -> Iterator[FeatureUse]:
    name = f"action {action.id!r}"
    if isinstance(action.duration, DurationRange):
        yield FeatureUse(Feature.DURATION_RANGE, ("actions", index, "duration"), name)
    elif action.duration == 0:
        yield FeatureUse(Feature.ZERO_DURATION, ("actions", index, "duration"), name)
    if action.release != 0:
        yield FeatureUse(Feature.RELEASE, ("actions", index, "release"), name)
    for use in action.uses:
        if use.one_of is not None:
            yield FeatureUse(Feature.ALTERNATIVES, ("actions", index, "uses"), name)
        if use.amount > 1:
            yield FeatureUse(Feature.AMOUNTS, ("actions", index, "uses"), name)
    fields = action.__dict__
    for field, feature in _ACTION_FIELDS:
        if fields[field] not in (None, ()):
            yield FeatureUse(feature, ("actions", index, field), name)
    for m, mode in enumerate(action.modes):
        for field in OF_MODES:
            if getattr(mode, field) not in (None, ()):
                pointer: Pointer = ("actions", index, "modes", m, field)
                its = f"mode {mode.id!r} of {name}"
                yield FeatureUse(Feature.MODE_ELEMENTS, pointer, its)
                yield FeatureUse(_FEATURES[field], pointer, its)
    if action.breaks == "pause":
        yield FeatureUse(Feature.PAUSES, ("actions", index, "breaks"), name)
    if action.occurrence_bounds != (1, 1):
        greatest = action.occurrence_bounds[1]
        repeated = greatest is None or greatest > 1
        feature = Feature.REPEATED_ACTIONS if repeated else Feature.OPTIONAL_ACTIONS
        yield FeatureUse(feature, ("actions", index, "occurs"), name)


def _of_precedence(task: Task) -> Iterator[FeatureUse]:
    for k, edge in enumerate(task.precedence):
        if edge.type == "finish-start" and edge.min_lag == 0 and edge.max_lag is None:
            if k == 0:
                yield FeatureUse(Feature.PRECEDENCE, ("precedence", k), "precedence 1")
            continue
        name = f"precedence {k + 1} ({edge.before!r} before {edge.after!r})"
        if edge.type != "finish-start":
            yield FeatureUse(Feature.PRECEDENCE_TYPES, ("precedence", k, "type"), name)
        if edge.min_lag != 0:
            negative = task.number(edge.min_lag) < 0
            feature = Feature.NEGATIVE_LAG if negative else Feature.MIN_LAG
            yield FeatureUse(feature, ("precedence", k, "min_lag"), name)
        if edge.max_lag is not None:
            yield FeatureUse(Feature.MAX_LAG, ("precedence", k, "max_lag"), name)


def _of_group(group: Group, at: Pointer) -> Iterator[FeatureUse]:
    name = f"group {group.id!r}"
    yield FeatureUse(Feature.GROUPS, at, name)
    for field, feature in (
        ("reward", Feature.REWARD),
        ("deadline", Feature.DEADLINE),
        ("due", Feature.DUE_DATE),
    ):
        if getattr(group, field) is not None:
            yield FeatureUse(feature, (*at, field), name)


def _of_goals(task: Task) -> Iterator[FeatureUse]:
    for i, goal in enumerate(task.goals):
        if isinstance(goal, str):
            yield FeatureUse(Feature.PRESENCE_GOALS, ("goals", i), f"the goal {goal!r}")
        else:
            yield FeatureUse(Feature.STATE_GOALS, ("goals", i), f"the goal on {goal.var!r}")


_OBJECTIVES = {
    "minimize_makespan": Feature.MAKESPAN,
    "minimize_tardiness": Feature.TARDINESS,
    "minimize_tardy": Feature.TARDY,
    "minimize_max_tardiness": Feature.MAX_TARDINESS,
    "minimize_earliness": Feature.EARLINESS,
    "minimize_flow_time": Feature.FLOW_TIME,
    "maximize_reward": Feature.MAXIMIZE_REWARD,
    "minimize_cost": Feature.MINIMIZE_COST,
    "minimize_changes": Feature.MINIMIZE_CHANGES,
    "minimize_setup_time": Feature.SETUP_TIME,
    "minimize_setup_cost": Feature.SETUP_COST,
}


def _of_objective(task: Task) -> Iterator[FeatureUse]:
    distinct = tuple(dict.fromkeys(task.objective))
    if len(distinct) > 1:
        yield FeatureUse(Feature.SEVERAL_OBJECTIVES, ("objective",), "the objective")
    for objective in distinct:
        if isinstance(objective, str):
            yield FeatureUse(_OBJECTIVES[objective], ("objective",), "the objective")
            continue
        yield FeatureUse(Feature.OBJECTIVE_SUM, ("objective",), "the objective")
        for term in objective.sum:
            yield FeatureUse(_OBJECTIVES[term.objective], ("objective",), "the objective")
