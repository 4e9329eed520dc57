"""Lowers the elements that most tasks do not have: choices, state, stock, groups, goals, rewards.

Loaded only for tasks that have one of these.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from math import lcm

from irc.lowering.elements import (
    ToTicks,
    due_ticks,
    natural_order,
    open_demands_of,
    requirements,
    span,
    ticks_or_none,
)
from irc.model import Action, StateGoal, StateVariable, Task
from irc.model import Group as GroupNode
from irc.model import Mode as ModeNode
from irc.model.base import AnyValue
from irc.model.details import ChoiceMade
from irc.model.objectives import short_name
from irc.model.quantities import Number
from irc.problem import (
    IMPOSSIBLE_DEADLINE,
    PLAIN,
    Activity,
    Condition,
    CoupledChoice,
    Coupling,
    Details,
    Effect,
    Group,
    GroupDeadline,
    Mode,
    NumberCondition,
    NumberEffect,
    NumberGoal,
    NumberVariable,
    Problem,
    Requirement,
    Reservoir,
    Selection,
    StockChange,
    TimedChange,
    Variable,
    together,
)


def add_choices(problem: Problem, task: Task, index: dict[str, int], to_ticks: ToTicks) -> Problem:
    """The problem with all elements of `task` besides times, resources and precedence."""
    lowering = _Lowering(problem, task, index, to_ticks)
    activities = tuple(lowering.activity(a) for a in problem.activities)
    couplings = tuple(lowering.couplings())
    return replace(
        problem,
        activities=tuple(_with_coupled_choices(activities, couplings)),
        reservoirs=lowering.reservoirs,
        variables=lowering.variables,
        numbers=lowering.numbers,
        groups=tuple(
            lowering.group(group, i)
            for i, group in sorted(enumerate(task.groups), key=lambda g: natural_order(g[1].id))
            if group.actions
        ),
        couplings=couplings,
        selections=tuple(lowering.selections()),
        goals=lowering.goals(),
        number_goals=lowering.number_goals(),
        required=tuple(
            sorted({index[goal] for goal in task.goals if isinstance(goal, str) and goal in index})
        ),
        objectives=tuple(dict.fromkeys(map(short_name, task.objective))),
    )


def _with_coupled_choices(
    activities: Sequence[Activity], couplings: Sequence[Coupling]
) -> Iterator[Activity]:
    """The activities; coupled ones have to decide on a resource even where they take no time."""
    coupled = {m.activity for c in couplings if c.is_about_resources for m in c.members}
    for i, activity in enumerate(activities):
        demands = open_demands_of(activity.uses)
        known = {demand.use for demand in activity.open_demands}
        kept = tuple(d for d in demands if d.use in known or len(d.alternatives) > 1)
        if i in coupled and len(kept) > len(known):
            activity = replace(activity, open_demands=kept)
        yield activity


class _Lowering:
    def __init__(
        self, problem: Problem, task: Task, index: dict[str, int], to_ticks: ToTicks
    ) -> None:
        self.task, self.index, self.to_ticks = task, index, to_ticks
        self.resource_index = {r.id: k for k, r in enumerate(problem.resources)}
        self.families = {name: k for k, name in enumerate(problem.families)}
        self.reservoirs = _reservoirs(task)
        self.reservoir_index = {r.id: k for k, r in enumerate(self.reservoirs)}
        self.variables = _variables(task, to_ticks)
        self.variable_index = {v.id: k for k, v in enumerate(self.variables)}
        self.value_index = [
            {_key(value): k for k, value in enumerate(v.values)} for v in self.variables
        ]
        self.numbers = _numbers(task, to_ticks)
        self.number_index = {n.id: k for k, n in enumerate(self.numbers)}
        self.chosen_by_group = {
            name for group in task.groups if not group.required for name in group.actions
        }
        self.forced = {name for group in task.groups if group.required for name in group.actions}
        self.deadlines = self._group_deadlines()
        self.counts_flow_time = any("flow_time" in short_name(o) for o in task.objective)

    def _group_deadlines(self) -> dict[str, tuple[int, GroupDeadline]]:
        """The earliest deadline among the groups of each action, and whose it is."""
        deadlines: dict[str, tuple[int, GroupDeadline]] = {}
        for g, group in enumerate(self.task.groups):
            if group.deadline is None:
                continue
            deadline = ticks_or_none(group.deadline, self.to_ticks)
            if deadline is not None:
                by = GroupDeadline(group.id, ("groups", g, "deadline"))
                for name in group.actions:
                    if name not in deadlines or deadline < deadlines[name][0]:
                        deadlines[name] = deadline, by
        return deadlines

    def activity(self, activity: Activity) -> Activity:
        action = self.task.actions[int(activity.origin[1])]
        details = self._details(action)
        activity = replace(activity, details=PLAIN if details == PLAIN else details)
        deadline, by = self.deadlines.get(action.id, (None, None))
        if deadline is not None and (activity.deadline is None or deadline < activity.deadline):
            activity = replace(activity, deadline=deadline, deadline_by=by)
        if action.occurrence_bounds[1] == 0:
            activity = replace(activity, deadline=IMPOSSIBLE_DEADLINE, deadline_by=None)
        return self._with_modes(activity, action) if action.modes else activity

    def _details(self, action: Action) -> Details:
        least, greatest = action.occurrence_bounds
        if action.id in self.chosen_by_group:
            least = 0
        if action.id in self.forced:
            least = max(least, 1)
        repeats = (least, greatest) if greatest is None or greatest > 1 else None
        return Details(
            optional=repeats is None and least == 0,
            repeats=repeats,
            stock=self._stock(action),
            conditions=self._conditions(action),
            effects=self._effects(action),
            number_conditions=self._number_conditions(action),
            number_effects=self._number_effects(action),
            due=due_ticks(action.due, self.to_ticks),
            weight=1 if action.weight is None else action.weight,
            reward=action.reward or 0,
            cost=action.cost or 0,
            entered=self._entered(action),
        )

    def _entered(self, action: Action) -> int | None:
        if not self.counts_flow_time:
            return None
        return max(0, ticks_or_none(action.release, self.to_ticks) or 0)

    def _with_modes(self, activity: Activity, action: Action) -> Activity:
        uses: list[Requirement] = list(activity.uses)
        use_modes: list[int | None] = [None] * len(uses)
        modes: list[Mode] = []
        for node in sorted({m.id: m for m in action.modes}.values(), key=lambda m: m.id):
            mode = Mode(
                node.id,
                *span(node.duration, self.to_ticks),
                stock=self._stock(node),
                conditions=self._conditions(node),
                effects=self._effects(node),
                number_conditions=self._number_conditions(node),
                number_effects=self._number_effects(node),
                cost=node.cost or 0,
            )
            own = requirements(node.uses, self.resource_index, self.families)
            uses += own
            use_modes += [len(modes)] * len(own)
            modes.append(mode)
        demands = open_demands_of(tuple(uses)) if activity.duration_max else ()
        return replace(
            activity,
            uses=tuple(uses),
            open_demands=tuple(d for d in demands if _takes_time(use_modes[d.use], modes)),
            details=replace(activity.details, modes=tuple(modes), use_modes=tuple(use_modes)),
        )

    def _stock(self, action: Action | ModeNode) -> tuple[StockChange, ...]:
        changes = [
            StockChange(self.reservoir_index[c.resource], sign * c.amount, (c.at or usual) == "end")
            for part, sign, usual in ((action.consumes, -1, "start"), (action.produces, 1, "end"))
            for c in part
            if c.resource in self.reservoir_index
        ]
        return tuple(sorted(changes))

    def _conditions(self, action: Action | ModeNode) -> tuple[Condition, ...]:
        return tuple(
            sorted(
                {
                    Condition(place[0], place[1], c.at)
                    for c in action.conditions
                    if (place := self._place(c.var, c.value))
                }
            )
        )

    def _effects(self, action: Action | ModeNode) -> tuple[Effect, ...]:
        return tuple(
            sorted(
                {
                    Effect(place[0], place[1], e.at == "end")
                    for e in action.effects
                    if (place := self._place(e.var, e.value))
                }
            )
        )

    def _number_conditions(self, action: Action | ModeNode) -> tuple[NumberCondition, ...]:
        found = {
            NumberCondition(k, *self._levels(k, c.limits), c.at)
            for c in action.conditions
            if (k := self.number_index.get(c.var)) is not None and c.asks_for_a_level
        }
        return tuple(sorted(found, key=lambda c: (c.number, c.at, repr(c))))

    def _number_effects(self, action: Action | ModeNode) -> tuple[NumberEffect, ...]:
        found = []
        for e in action.effects:
            k = self.number_index.get(e.var)
            if k is not None:
                scale = self.numbers[k].scale
                for amount, sets in ((e.set, True), (e.add, False)):
                    if amount is not None:
                        found.append(NumberEffect(k, int(amount * scale), sets, e.at == "end"))
        return together(found)

    def _levels(
        self, k: int, limits: tuple[Number | None, Number | None]
    ) -> tuple[int | None, int | None]:
        """The least and the greatest whole level within limits."""
        least, greatest = limits
        scale = self.numbers[k].scale
        return (
            None if least is None else int(least * scale),
            None if greatest is None else int(greatest * scale),
        )

    def number_goals(self) -> tuple[NumberGoal, ...]:
        found = {
            NumberGoal(k, *self._levels(k, goal.limits))
            for goal in self.task.goals
            if isinstance(goal, StateGoal)
            and goal.asks_for_a_level
            and (k := self.number_index.get(goal.var)) is not None
        }
        return tuple(sorted(found, key=repr))

    def _place(self, var: str, value: bool | str) -> tuple[int, int] | None:
        v = self.variable_index.get(var)
        k = None if v is None else self.value_index[v].get(_key(value))
        return None if v is None or k is None else (v, k)

    def group(self, group: GroupNode, i: int) -> Group:
        return Group(
            id=group.id,
            members=tuple(
                sorted({self.index[name] for name in group.actions if name in self.index})
            ),
            required=group.required,
            reward=group.reward or 0,
            due=due_ticks(group.due, self.to_ticks),
            weight=1 if group.weight is None else group.weight,
            origin=("groups", i),
        )

    def couplings(self) -> Iterator[Coupling]:
        """The couplings whose actions there are; the checks report the others."""
        for k, node in enumerate(self.task.couplings):
            if node.if_ is not None and node.then is not None:
                made = [self._choice(node.if_), self._choice(node.then)]
                if None not in made:
                    yield Coupling("if", "", tuple(m for m in made if m is not None), k)
                continue
            kind, what = ("same", node.same) if node.same else ("different", node.different)
            members = tuple(
                CoupledChoice(self.index[a.action], a.use)
                for a in node.actions
                if a.action in self.index
            )
            if len(members) > 1:
                yield Coupling(kind, what or "resource", members, k)

    def _choice(self, made: ChoiceMade) -> CoupledChoice | None:
        if made.action not in self.index:
            return None
        resource = None if made.resource is None else self.resource_index.get(made.resource)
        if made.resource is not None and resource is None:
            return None
        return CoupledChoice(
            self.index[made.action], made.use, tuple(sorted(made.in_modes)), resource
        )

    def selections(self) -> Iterator[Selection]:
        """The selections of what there is."""
        groups = {group.id: group.actions for group in self.task.groups}

        def item(name: str) -> tuple[int, ...] | None:
            names = groups.get(name, (name,))
            if not all(n in self.index for n in names):
                return None
            return tuple(sorted({self.index[n] for n in names}))

        for k, node in enumerate(self.task.select):
            items = tuple(found for name in node.actions if (found := item(name)))
            condition = None if node.if_ is None else item(node.if_)
            if node.if_ is None or condition is not None:
                yield Selection(items, node.min, node.max, condition, k, node.all_or_none)

    def goals(self) -> tuple[tuple[int, int], ...]:
        places = (
            self._place(goal.var, goal.value)
            for goal in self.task.goals
            if not isinstance(goal, str)
        )
        return tuple(sorted({place for place in places if place}))


def _key(value: AnyValue) -> Hashable:
    """A key under which true and "true" differ, as do false and 0."""
    return type(value), value


def _takes_time(mode: int | None, modes: list[Mode]) -> bool:
    return mode is None or modes[mode].duration_max > 0


def _reservoirs(task: Task) -> tuple[Reservoir, ...]:
    found = _first_of_each((r.id, i) for i, r in enumerate(task.resources) if r.kind == "reservoir")
    return tuple(
        Reservoir(r.id, r.initial, r.min, r.max, ("resources", i))
        for i, r in ((i, task.resources[i]) for i in found)
    )


def _variables(task: Task, to_ticks: ToTicks) -> tuple[Variable, ...]:
    variables = []
    for i in _first_of_each((v.id, i) for i, v in enumerate(task.state) if not v.is_number):
        node = task.state[i]
        keys = [_key(value) for value in node.values]
        start = node.start_value
        if start is not None and _key(start) in keys:
            changes = {
                at: keys.index(_key(change.value))
                for change in node.changes
                if _key(change.value) in keys
                and (at := ticks_or_none(change.at, to_ticks)) is not None
                and at >= 0
            }
            variables.append(
                Variable(
                    node.id,
                    node.values,
                    keys.index(_key(start)),
                    ("state", i),
                    tuple(TimedChange(*change) for change in sorted(changes.items())),
                )
            )
    return tuple(variables)


def _numbers(task: Task, to_ticks: ToTicks) -> tuple[NumberVariable, ...]:
    found = _first_of_each((v.id, i) for i, v in enumerate(task.state) if v.is_number)
    scales = _scales(task) if found else {}
    numbers = []
    for i in found:
        node = task.state[i]
        start = node.start_value
        if isinstance(start, (bool, str)) or start is None:
            continue
        scale = scales[node.id]
        changes = {
            at: int(change.value * scale)
            for change in node.changes
            if not isinstance(change.value, (bool, str))
            and (at := ticks_or_none(change.at, to_ticks)) is not None
            and at >= 0
        }
        numbers.append(
            NumberVariable(
                node.id,
                int(start * scale),
                None if node.min is None else int(node.min * scale),
                None if node.max is None else int(node.max * scale),
                scale,
                ("state", i),
                tuple(TimedChange(*change) for change in sorted(changes.items())),
            )
        )
    return tuple(numbers)


def _scales(task: Task) -> dict[str, int]:
    """For each number variable the least number by which all of its levels become whole."""
    scales = {v.id: lcm(*map(_denominator, _own_levels(v))) for v in task.state if v.is_number}

    def note(name: str, *levels: object) -> None:
        if name in scales:
            scales[name] = lcm(scales[name], *map(_denominator, levels))

    parts: tuple[Action | ModeNode, ...] = task.actions
    for part in (*parts, *(mode for action in task.actions for mode in action.modes)):
        for c in part.conditions:
            note(c.var, *c.limits)
        for e in part.effects:
            note(e.var, e.add, e.set)
    for goal in task.goals:
        if isinstance(goal, StateGoal):
            note(goal.var, *goal.limits)
    return scales


def _own_levels(variable: StateVariable) -> list[object]:
    changes = [change.value for change in variable.changes]
    return [variable.start_value, variable.min, variable.max, *changes]


def _denominator(level: object) -> int:
    return level.denominator if isinstance(level, Fraction) else 1


def _first_of_each(named: Iterable[tuple[str, int]]) -> list[int]:
    """The first index of each name, ordered by name."""
    places: dict[str, int] = {}
    for name, i in named:
        places.setdefault(name, i)
    return [places[name] for name in sorted(places, key=natural_order)]
