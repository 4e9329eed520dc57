"""Coupled choices and selections in a CP-SAT model: clauses over the literals of choices."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, pairwise
from typing import Any

from irc.problem import CoupledChoice, Coupling
from irc_cpsat.encoding.builder import Builder, DemandLiterals

Truth = Any
"""A literal, or True or False."""


def add_couplings(builder: Builder, literals: DemandLiterals) -> None:
    """Adds all couplings; `literals` are those of the open demands."""
    encoder = _CouplingEncoder(builder, literals)
    for coupling in builder.problem.couplings:
        encoder.add(coupling)


def add_selections(builder: Builder) -> None:
    """Adds how many items of each selection are present."""
    for selection in builder.problem.selections:
        items = [_all_of(builder, item) for item in selection.items]
        there = sum(item is True for item in items)
        free = [item for item in items if item is not True]
        condition = True if selection.condition is None else _all_of(builder, selection.condition)
        when = [] if condition is True else [condition]
        if selection.all_or_none:
            _add_all_or_none(builder, free, when, there=there > 0)
            continue
        _enforced(builder.model.add(sum(free) >= selection.least - there), when)
        if selection.most is not None:
            _enforced(builder.model.add(sum(free) <= selection.most - there), when)


def _add_all_or_none(builder: Builder, free: list[Any], when: list[Any], *, there: bool) -> None:
    """All of some items are present or none is; all, where one certainly is `there`."""
    if there:
        for item in free:
            builder.model.add_bool_or([item, *(~literal for literal in when)])
        return
    for one, other in pairwise([*free, *free[:1]]):
        builder.model.add_bool_or([~one, other, *(~literal for literal in when)])


def _enforced(constraint: Any, when: list[Any]) -> None:
    if when:
        constraint.only_enforce_if(*when)


def _all_of(builder: Builder, activities: tuple[int, ...]) -> Truth:
    """Whether activities that are present together are."""
    present = [p for i in activities if (p := builder.present[i]) is not None]
    return present[0] if present else True


class _CouplingEncoder:
    """Adds couplings; the truths of what an activity holds are made once."""

    def __init__(self, builder: Builder, literals: DemandLiterals) -> None:
        self.builder, self.literals = builder, literals
        self._held: dict[tuple[int, int | None], Mapping[int, Truth]] = {}

    def add(self, coupling: Coupling) -> None:
        """Adds one coupling, between each two of its members."""
        if coupling.kind == "if":
            one, other = coupling.members
            self._clause(one, other, _not(self._made(one)), self._made(other))
            return
        for one, other in combinations(coupling.members, 2):
            a, b = self._choices(coupling, one), self._choices(coupling, other)
            for key in {**a, **b}:
                x, y = a.get(key, False), b.get(key, False)
                if coupling.kind == "different":
                    self._clause(one, other, _not(x), _not(y))
                    continue
                self._clause(one, other, _not(x), y)
                self._clause(one, other, x, _not(y))

    def _clause(self, one: CoupledChoice, other: CoupledChoice, *truths: Truth) -> None:
        """One of these holds, where both activities are present."""
        if any(truth is True for truth in truths):
            return
        present = [self.builder.present[m.activity] for m in (one, other)]
        absent = [~literal for literal in present if literal is not None]
        said = [truth for truth in truths if truth is not False]
        self.builder.model.add_bool_or([*said, *absent])

    def _choices(self, coupling: Coupling, member: CoupledChoice) -> Mapping[Any, Truth]:
        if coupling.what == "mode":
            return self._modes(member.activity)
        return self._holds(member.activity, member.use)

    def _made(self, member: CoupledChoice) -> Truth:
        if member.modes:
            chosen = self._modes(member.activity)
            return self._any_of([chosen[name] for name in member.modes if name in chosen])
        return self._holds(member.activity, member.use).get(member.resource or 0, False)

    def _modes(self, i: int) -> Mapping[str | None, Truth]:
        modes = self.builder.problem.activities[i].details.modes
        if not modes:
            return {None: True}
        return {m.id: lit for m, lit in zip(modes, self.builder.modes[i], strict=True)}

    def _holds(self, i: int, use: int | None) -> Mapping[int, Truth]:
        """For each resource whether the activity holds it, in one of its own uses or in any."""
        if (i, use) not in self._held:
            found: dict[int, list[Truth]] = {}
            for r, truth in self._uses(i, use):
                found.setdefault(r, []).append(truth)
            self._held[i, use] = {r: self._any_of(truths) for r, truths in found.items()}
        return self._held[i, use]

    def _uses(self, i: int, use: int | None) -> Iterator[tuple[int, Truth]]:
        problem, activity = self.builder.problem, self.builder.problem.activities[i]
        open_uses = {d.use: c for c, d in enumerate(activity.open_demands)}
        for u, requirement in enumerate(activity.uses):
            mode = activity.details.use_mode(u)
            if use is not None and (mode is not None or requirement.origin != use):
                continue
            held: Truth = True if mode is None else self.builder.modes[i][mode]
            literals = self.literals[i][open_uses[u]] if u in open_uses else []
            if len(requirement.alternatives) == 1:
                yield requirement.alternatives[0], held
            elif literals:
                for pool, literal in literals:
                    yield problem.contention.pools[pool].members[0], literal
            elif (i, u) in problem.contention.fixed_choices:
                yield problem.contention.fixed_choices[i, u], held
            if use is not None:
                return

    def _any_of(self, truths: list[Truth]) -> Truth:
        if any(truth is True for truth in truths):
            return True
        if len(truths) < 2:
            return truths[0] if truths else False
        found = self.builder.model.new_bool_var("")
        self.builder.model.add_max_equality(found, truths)
        return found


def _not(truth: Truth) -> Truth:
    return not truth if isinstance(truth, bool) else ~truth
