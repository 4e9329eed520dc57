"""A problem with only some of its elements, and the way back to the whole problem.

Elements of a problem are known by their index. When some of them go, the numbers of the others
close up, everywhere: in arcs, groups, demands, choices, the previous plan. `restricted` is the one
place that does this. It returns a `Projection` with the smaller problem: which element is which,
decisions about the whole as decisions about the part, and places in the part as places in the
whole. (Compare the inverse data of cvxpy's reductions.)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

from irc.problem.activity import PLAIN, Activity, Details
from irc.problem.contention import Bounds, ContendedPool, Contention
from irc.problem.decisions import ABSENT_PLACE, Decision, Placed
from irc.problem.needs import (
    Condition,
    Effect,
    NumberCondition,
    NumberEffect,
    Protected,
    ProtectedLimits,
    StockChange,
)
from irc.problem.problem import Arc, PreviousPlace, PreviousPlan, Problem
from irc.problem.rules import NOBODY, Coupling, Group, Selection, UseOrder

T = TypeVar("T")


@dataclass(frozen=True)
class Kept:
    """The elements of one kind in a smaller problem: `old[k]` is the index that element k had.

    An element that occurs several times has copies; references to it lead to the first.
    """

    old: Sequence[int]
    size: int

    @staticmethod
    def of(size: int, kept: Iterable[int] | None = None) -> Kept:
        """The kept ones of `size` elements; None: all."""
        if kept is None:
            return Kept(range(size), size)
        old = tuple(kept)
        return Kept(range(size) if old == tuple(range(size)) else old, size)

    @property
    def is_all(self) -> bool:
        """Whether every element stays, with the number that it had."""
        return isinstance(self.old, range)

    @cached_property
    def new(self) -> Mapping[int, int]:
        """The new index of each element that is kept, by its old one."""
        places: dict[int, int] = {}
        for k, i in enumerate(self.old):
            places.setdefault(i, k)
        return places

    def of_each(self, elements: Sequence[T]) -> tuple[T, ...]:
        """The kept elements of a list; nothing if the list is empty."""
        if self.is_all or not elements:
            return tuple(elements)
        return tuple(elements[i] for i in self.old)

    def moved(self, indexes: Sequence[int]) -> tuple[int, ...]:
        """The new indexes of the elements that are kept."""
        if self.is_all:
            return tuple(indexes)
        return tuple(self.new[i] for i in indexes if i in self.new)


@dataclass(frozen=True)
class Projection:
    """The way between a whole problem and a smaller one: which element is which.

    `uses` has those of the whole problem's activities (by index) that lost some of their uses, with
    the indexes of the uses that stay.
    """

    activities: Kept
    arcs: Kept
    groups: Kept
    resources: Kept
    pools: Kept
    reservoirs: Kept
    variables: Kept
    numbers: Kept
    uses: Mapping[int, tuple[int, ...]]

    @property
    def keeps_the_world(self) -> bool:
        """Whether every reservoir, variable and number stays."""
        return self.reservoirs.is_all and self.variables.is_all and self.numbers.is_all

    @staticmethod
    def identity(problem: Problem) -> Projection:
        """The projection of a problem to itself."""
        return Projection(
            activities=Kept.of(len(problem.activities)),
            arcs=Kept.of(len(problem.arcs)),
            groups=Kept.of(len(problem.groups)),
            resources=Kept.of(len(problem.resources)),
            pools=Kept.of(len(problem.contention.pools)),
            reservoirs=Kept.of(len(problem.reservoirs)),
            variables=Kept.of(len(problem.variables)),
            numbers=Kept.of(len(problem.numbers)),
            uses={},
        )

    def decisions(self, decisions: Sequence[Decision]) -> tuple[Decision, ...]:
        """Converts decisions about the whole problem to decisions about the smaller one."""
        return tuple(self._decision(i, decisions[i]) for i in self.activities.old)

    def _decision(self, i: int, decision: Decision) -> Decision:
        if not decision.chosen or (i not in self.uses and self.resources.is_all):
            return decision
        return replace(decision, chosen=self.taken(i, decision.chosen))

    def taken(self, i: int, resources: Sequence[int | None]) -> tuple[int | None, ...]:
        """The resource of each use of activity i, as the smaller problem numbers both."""
        kept = self.uses.get(i)
        taken = resources if kept is None else [resources[u] for u in kept]
        if self.resources.is_all:
            return tuple(taken)
        return tuple(None if r is None else self.resources.new.get(r) for r in taken)

    def spread(self, whole: Problem, placed: Sequence[Placed]) -> tuple[Placed, ...]:
        """Converts places in the smaller problem to places in the whole one; the rest is absent."""
        places = [ABSENT_PLACE] * len(whole.activities)
        for k, i in enumerate(self.activities.old):
            place = placed[k]
            if place.present and (i in self.uses or not self.resources.is_all):
                place = replace(place, resources=self._given_back(whole, i, place.resources))
            places[i] = place
        return tuple(places)

    def _given_back(
        self, whole: Problem, i: int, resources: Sequence[int | None]
    ) -> tuple[int | None, ...]:
        found: list[int | None] = [None] * len(whole.activities[i].uses)
        kept = self.uses.get(i, range(len(found)))
        for u, r in zip(kept, resources, strict=True):
            found[u] = None if r is None else self.resources.old[r]
        return tuple(found)


Projected = tuple[Problem, Projection]
"""A smaller problem, and the way back."""


def restricted(
    problem: Problem,
    *,
    activities: Iterable[int] | None = None,
    uses: Mapping[int, Sequence[int]] | None = None,
    arcs: Iterable[int] | None = None,
    groups: Iterable[int] | None = None,
    resources: Iterable[int] | None = None,
    pools: Iterable[int] | None = None,
    reservoirs: Iterable[int] | None = None,
    variables: Iterable[int] | None = None,
    numbers: Iterable[int] | None = None,
) -> Projected:
    """The problem with only these elements (indexes, in the order that they get), and the way back.

    None keeps all of a kind. An activity that is named several times is copied. `uses` gives, for
    some activities, the uses that stay. References to an element that goes, go as well: arcs,
    members of groups, conditions, places in the previous plan. So do groups without members, and
    pools and uses without resources.

    Bounds are kept. They hold for the smaller problem only if each of its schedules is one of the
    whole problem with something left out; a caller for whom this does not hold drops them.
    """
    own = Kept.of(len(problem.activities), activities)
    stations = Kept.of(len(problem.resources), resources)
    way = Projection(
        activities=own,
        arcs=_kept_arcs(problem, own, arcs),
        groups=_kept_with(own, [g.members for g in problem.groups], groups),
        resources=stations,
        pools=_kept_with(stations, [p.members for p in problem.contention.pools], pools),
        reservoirs=Kept.of(len(problem.reservoirs), reservoirs),
        variables=Kept.of(len(problem.variables), variables),
        numbers=Kept.of(len(problem.numbers), numbers),
        uses=_kept_uses(problem, own, stations, uses or {}),
    )
    return _project(problem, way), way


def _kept_arcs(problem: Problem, activities: Kept, arcs: Iterable[int] | None) -> Kept:
    if activities.is_all:
        return Kept.of(len(problem.arcs), arcs)
    new, found = activities.new, problem.arcs
    candidates = range(len(found)) if arcs is None else arcs
    kept = (k for k in candidates if found[k].before in new and found[k].after in new)
    return Kept.of(len(found), kept)


def _kept_with(
    members_kept: Kept, members: Sequence[Sequence[int]], kept: Iterable[int] | None
) -> Kept:
    """The sets (of all, or of those `kept`) that have a member which is kept."""
    if members_kept.is_all:
        return Kept.of(len(members), kept)
    candidates = range(len(members)) if kept is None else kept
    return Kept.of(
        len(members), (k for k in candidates if any(i in members_kept.new for i in members[k]))
    )


def _kept_uses(
    problem: Problem, activities: Kept, resources: Kept, uses: Mapping[int, Sequence[int]]
) -> dict[int, tuple[int, ...]]:
    """The uses that remain, for the activities that lose some."""
    found: dict[int, tuple[int, ...]] = {}
    for i in uses if resources.is_all else activities.old:
        entries = problem.activities[i].uses
        kept = uses.get(i, range(len(entries)))
        if not resources.is_all:
            kept = [u for u in kept if any(r in resources.new for r in entries[u].alternatives)]
        if i in activities.new and tuple(kept) != tuple(range(len(entries))):
            found[i] = tuple(kept)
    return found


def _project(problem: Problem, way: Projection) -> Problem:
    """The smaller problem of a projection. Each field that has indexes is renumbered here."""
    own = way.activities
    return replace(
        problem,
        activities=_activities(problem, way),
        resources=way.resources.of_each(problem.resources),
        reservoirs=way.reservoirs.of_each(problem.reservoirs),
        variables=way.variables.of_each(problem.variables),
        numbers=way.numbers.of_each(problem.numbers),
        arcs=_arcs(problem, way),
        groups=tuple(_group(g, own) for g in way.groups.of_each(problem.groups)),
        couplings=tuple(_couplings(problem, way)),
        selections=tuple(_selections(problem, own)),
        sequences=tuple(_sequences(problem, way)),
        goals=tuple(
            (way.variables.new[v], value) for v, value in problem.goals if v in way.variables.new
        ),
        number_goals=tuple(
            g._replace(number=way.numbers.new[g.number])
            for g in problem.number_goals
            if g.number in way.numbers.new
        ),
        required=own.moved(problem.required),
        state_precedences=_pairs(problem.state_precedences, own),
        contention=Contention(
            pools=tuple(
                _pool(p, way.resources) for p in way.pools.of_each(problem.contention.pools)
            ),
            fixed_choices=_fixed_choices(problem, way),
        ),
        bounds=Bounds(
            heads=own.of_each(problem.bounds.heads),
            tails=own.of_each(problem.bounds.tails),
            makespan=problem.bounds.makespan,
        ),
        previous=_previous(problem.previous, way),
    )


def _arcs(problem: Problem, way: Projection) -> tuple[Arc, ...]:
    arcs = way.arcs.of_each(problem.arcs)
    if way.activities.is_all:
        return arcs
    new = way.activities.new
    return tuple(arc._replace(before=new[arc.before], after=new[arc.after]) for arc in arcs)


def _pairs(pairs: Sequence[tuple[int, int]], activities: Kept) -> tuple[tuple[int, int], ...]:
    if activities.is_all:
        return tuple(pairs)
    new = activities.new
    return tuple((new[a], new[b]) for a, b in pairs if a in new and b in new)


def _group(group: Group, activities: Kept) -> Group:
    if activities.is_all:
        return group
    return replace(group, members=activities.moved(group.members))


def _couplings(problem: Problem, way: Projection) -> Iterator[Coupling]:
    """The couplings of the activities that stay; one without two of them says nothing."""
    activities, resources = way.activities.new, way.resources.new
    for coupling in problem.couplings:
        members = tuple(
            m._replace(
                activity=activities[m.activity],
                resource=None if m.resource is None else resources[m.resource],
            )
            for m in coupling.members
            if m.activity in activities and (m.resource is None or m.resource in resources)
        )
        if len(members) > 1:
            yield coupling._replace(members=members)


def _selections(problem: Problem, activities: Kept) -> Iterator[Selection]:
    """The selections of which everything stays: fewer items would be another demand."""
    for selection in problem.selections:
        named = {i for item in selection.items for i in item} | {*(selection.condition or ())}
        if not all(i in activities.new for i in named):
            continue
        condition = selection.condition
        yield selection._replace(
            items=tuple(activities.moved(item) for item in selection.items),
            condition=None if condition is None else activities.moved(condition),
        )


def _sequences(problem: Problem, way: Projection) -> Iterator[UseOrder]:
    """The orders of uses of the activities and resources that stay."""
    if way.activities.is_all and way.resources.is_all:
        yield from problem.sequences
        return
    activities, resources = way.activities.new, way.resources.new
    for order in problem.sequences:
        of = [k for k, r in enumerate(order.resources) if r in resources]
        columns = range(2) if order.kind == "consecutive" else of
        rows = [tuple(activities.get(row[k], NOBODY) for k in columns) for row in order.rows]
        kept = [k for k, row in enumerate(rows) if sum(i != NOBODY for i in row) > 1]
        if not (of and kept):
            continue
        place = {old: new for new, old in enumerate(kept)}
        yield order._replace(
            resources=tuple(resources[order.resources[k]] for k in of),
            rows=tuple(rows[k] for k in kept),
            waived=tuple(
                (place[a], place[b]) for a, b in order.waived if a in place and b in place
            ),
        )


def _pool(pool: ContendedPool, resources: Kept) -> ContendedPool:
    return pool if resources.is_all else replace(pool, members=resources.moved(pool.members))


def _activities(problem: Problem, way: Projection) -> tuple[Activity, ...]:
    own = way.activities.of_each(problem.activities)
    if (
        way.activities.is_all
        and way.resources.is_all
        and way.pools.is_all
        and way.keeps_the_world
        and not way.uses
    ):
        return own
    return tuple(_activity(a, i, way) for i, a in zip(way.activities.old, own, strict=True))


def _activity(activity: Activity, i: int, way: Projection) -> Activity:
    kept = way.uses.get(i)
    if kept is not None:
        activity = with_uses(activity, kept)
    if activity.uses and not way.resources.is_all:
        activity = replace(
            activity,
            uses=tuple(
                u._replace(alternatives=way.resources.moved(u.alternatives)) for u in activity.uses
            ),
        )
    if not way.pools.is_all:
        activity = with_demands_on(activity, way.pools.new)
    if activity.details is PLAIN:
        return activity
    details = _details(activity.details, way)
    return activity if details is activity.details else replace(activity, details=details)


def _details(details: Details, way: Projection) -> Details:
    changed = details
    if details.touches_world and not way.keeps_the_world:
        changed = replace(
            changed,
            stock=_stock(details.stock, way.reservoirs),
            conditions=_conditions(details.conditions, way.variables),
            effects=_effects(details.effects, way.variables),
            number_conditions=_of_numbers(details.number_conditions, way.numbers),
            number_effects=_of_numbers(details.number_effects, way.numbers),
            modes=tuple(
                m._replace(
                    stock=_stock(m.stock, way.reservoirs),
                    conditions=_conditions(m.conditions, way.variables),
                    effects=_effects(m.effects, way.variables),
                    number_conditions=_of_numbers(m.number_conditions, way.numbers),
                    number_effects=_of_numbers(m.number_effects, way.numbers),
                )
                for m in details.modes
            ),
        )
    if details.protects and not (way.activities.is_all and way.variables.is_all):
        changed = replace(changed, protects=tuple(_protected(details, way)))
    if details.protects_limits and not (way.activities.is_all and way.numbers.is_all):
        limits = tuple(_protected_limits(details, way))
        changed = replace(changed, protects_limits=limits)
    if details.previous_occurrence is not None and not way.activities.is_all:
        previous = way.activities.new.get(details.previous_occurrence)
        changed = replace(changed, previous_occurrence=previous)
    return PLAIN if changed == PLAIN else changed


def _stock(changes: tuple[StockChange, ...], reservoirs: Kept) -> tuple[StockChange, ...]:
    if reservoirs.is_all:
        return changes
    new = reservoirs.new
    return tuple(c._replace(reservoir=new[c.reservoir]) for c in changes if c.reservoir in new)


def _conditions(conditions: tuple[Condition, ...], variables: Kept) -> tuple[Condition, ...]:
    if variables.is_all:
        return conditions
    return tuple(c._replace(var=variables.new[c.var]) for c in conditions if c.var in variables.new)


def _effects(effects: tuple[Effect, ...], variables: Kept) -> tuple[Effect, ...]:
    if variables.is_all:
        return effects
    return tuple(e._replace(var=variables.new[e.var]) for e in effects if e.var in variables.new)


_OfNumber = TypeVar("_OfNumber", NumberCondition, NumberEffect)


def _of_numbers(parts: tuple[_OfNumber, ...], numbers: Kept) -> tuple[_OfNumber, ...]:
    if numbers.is_all:
        return parts
    new = numbers.new
    return tuple(part._replace(number=new[part.number]) for part in parts if part.number in new)


def _protected(details: Details, way: Projection) -> Iterator[Protected]:
    activities, variables = way.activities.new, way.variables.new
    for activity, var, value in details.protects:
        if activity in activities and var in variables:
            yield Protected(activities[activity], variables[var], value)


def _protected_limits(details: Details, way: Projection) -> Iterator[ProtectedLimits]:
    for protected in details.protects_limits:
        kept = _of_numbers((protected.condition,), way.numbers)
        activity = way.activities.new.get(protected.activity, protected.activity)
        if kept and (protected.activity < 0 or protected.activity in way.activities.new):
            yield ProtectedLimits(activity, *kept)


def with_uses(activity: Activity, kept: Sequence[int]) -> Activity:
    """The activity with only some of its uses (indexes), and the open demands for them."""
    new = {u: k for k, u in enumerate(kept)}
    details = activity.details
    if details.use_modes:
        details = replace(details, use_modes=tuple(details.use_modes[u] for u in kept))
    return replace(
        activity,
        uses=tuple(activity.uses[u] for u in kept),
        open_demands=tuple(
            d._replace(use=new[d.use]) for d in activity.open_demands if d.use in new
        ),
        details=PLAIN if details == PLAIN else details,
    )


def in_one_mode(activity: Activity, mode: int) -> Activity:
    """The activity with one of its modes alone, and the uses of that mode."""
    details = activity.details
    chosen = details.modes[mode]
    kept = activity.uses_in(mode)
    return replace(
        with_uses(activity, kept),
        duration_min=chosen.duration_min,
        duration_max=chosen.duration_max,
        details=replace(
            details.in_mode(mode),
            modes=(chosen.bare,),
            use_modes=tuple(None for _ in kept),
            work=details.work[mode : mode + 1],
        ),
    )


def with_demands_on(activity: Activity, pools: Mapping[int, int]) -> Activity:
    """The activity with demands on other pools: `pools` has the new index of each that is left.

    Several pools may have become one.
    """
    if not activity.open_demands:
        return activity
    moved = (
        d._replace(
            alternatives=tuple(dict.fromkeys(pools[r] for r in d.alternatives if r in pools))
        )
        for d in activity.open_demands
    )
    return replace(activity, open_demands=tuple(d for d in moved if d.alternatives))


def _fixed_choices(problem: Problem, way: Projection) -> Mapping[tuple[int, int], int]:
    fixed = problem.contention.fixed_choices
    if not fixed or (way.activities.is_all and way.resources.is_all and not way.uses):
        return fixed
    copies: dict[int, list[int]] = {}
    for k, i in enumerate(way.activities.old):
        copies.setdefault(i, []).append(k)
    new_uses = {i: {u: n for n, u in enumerate(kept)} for i, kept in way.uses.items()}
    found: dict[tuple[int, int], int] = {}
    for (i, u), r in fixed.items():
        use = new_uses[i].get(u) if i in new_uses else u
        if use is not None and r in way.resources.new:
            found |= {(k, use): way.resources.new[r] for k in copies.get(i, ())}
    return found


def _previous(plan: PreviousPlan, way: Projection) -> PreviousPlan:
    own = way.activities
    if own.is_all and way.resources.is_all and not way.uses:
        return plan
    places = own.of_each(plan.places)
    warm_start = own.of_each(plan.warm_start)
    return replace(
        plan,
        places=tuple(
            None if place is None else _place(place, i, way)
            for i, place in zip(own.old, places, strict=False)
        ),
        recurring={
            own.new[i]: found
            for i, more in plan.recurring.items()
            if i in own.new and (found := _places(more, i, way)) is not None
        },
        warm_start=tuple(
            replace(place, resources=way.taken(i, place.resources)) if place.present else place
            for i, place in zip(own.old, warm_start, strict=False)
        ),
    )


def _place(place: PreviousPlace, i: int, way: Projection) -> PreviousPlace | None:
    """A previous place; None where it holds a resource that has gone."""
    kept = way.uses.get(i, range(len(place.resources)))
    new = way.resources.new
    if not way.resources.is_all and any(
        (r := place.resources[u]) is not None and r not in new for u in kept
    ):
        return None
    return place._replace(resources=way.taken(i, place.resources))


def _places(
    places: Sequence[PreviousPlace], i: int, way: Projection
) -> tuple[PreviousPlace, ...] | None:
    found = [_place(place, i, way) for place in places]
    kept = tuple(place for place in found if place is not None)
    return kept if len(kept) == len(places) else None
